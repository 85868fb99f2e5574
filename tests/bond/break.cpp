// silt - BSD-3-Clause, see LICENSE
// Bonds that break, and what is left.
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_break_test {

using silt::Vec3d;
constexpr double R = 1e-3;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};

TEST_CASE(
    "bonds: an agglomerate that flies against a plane loses bonds, the same for any threads") {
  const auto impact = [](double speed, int threads) {
    silt::Simulation sim{
        silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
        silt::Bonds{silt::ParallelBond{
            .youngs_modulus = 1e7, .tensile_strength = 1e4, .shear_strength = 1e4}}};
    silt::Particles<silt::Sphere> ball;
    for (int x = -4; x <= 4; ++x)
      for (int y = -4; y <= 4; ++y)
        for (int z = -4; z <= 4; ++z)
          if (x * x + y * y + z * z <= 16)
            ball.add({.position = {2 * R * x, 2 * R * y, 2 * R * z + 9.5 * R},
                      .radius = R,
                      .density = 2000,
                      .velocity = {0, 0, -speed}});
    sim.add(ball);
    const std::size_t made = bond_near(sim, 0.01 * R);
    CHECK(made > 500);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.threads = threads;
    sim.run(0.02);
    CHECK(sim.bonds() + sim.broken_bonds() == made);
    const auto parts = silt::fragments(sim);
    double mass = 0;
    for (const double m : parts.mass) mass += m;
    CHECK(mass == near(sim.total_mass()).epsilon(1e-12));
    std::vector<double> state{static_cast<double>(sim.broken_bonds()) / static_cast<double>(made)};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      for (const double q : {sim.position(sim.find(k)).x, sim.position(sim.find(k)).z})
        state.push_back(q);
    return state;
  };
  double last = -1;
  for (const double speed : {0.02, 0.2, 0.5, 1.0, 2.0}) {
    const auto one = impact(speed, 1);
    CHECK(one[0] >= last);
    last = one[0];
    if (speed == 1) CHECK(one == impact(speed, 3));
    // A sigmoid: none below a speed, most above ten times as much.
    if (speed == 0.02) CHECK(last == 0);
    if (speed == 0.2) CHECK(last < 0.2);
    if (speed == 0.5) CHECK(last > 0.4);
  }
  CHECK(last > 0.8);
}

}  // namespace bond_break_test
