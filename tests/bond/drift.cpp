// silt - BSD-3-Clause, see LICENSE
// What bonds keep over many steps: energy, momentum, angular momentum.
//   energy drifts        couples that are no derivative of an energy; turns that are summed up
//   turns                from before the first bond; none
//   momentum             forces and couples that are not opposite
#include <cmath>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_drift_test {

using silt::Vec3d;
constexpr double R = 1e-3;

TEST_CASE(
    "bonds: a fibre that tumbles and bends for a million steps keeps its energy and momenta") {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
      silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e6, .radius_ratio = 0.5, .damping = 0}}};
  add_bonded(sim, silt::fibre({0, 0, 0}, {22 * R, 0, 0}, 11, {.radius = R, .density = 2000}));
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double s = static_cast<double>(sim.id(k)) / 10 - 0.5;
    sim.set_velocity(sim.id(k), {0, 4 * s * s - 0.3, 0.3 * s});
    sim.set_angular_velocity(sim.id(k), {20 * s, 0, 0});
  }
  sim.threads = 1;
  struct Kept {
    double energy;
    Vec3d momentum{0, 0, 0}, angular{0, 0, 0};
  };
  const auto look = [&] {
    Kept k{sim.kinetic_energy() + sim.bond_energy()};
    for (std::size_t i = 0; i < sim.rows(); ++i) {
      const double m = sim.mass(i), I = 0.4 * m * sim.radius(i) * sim.radius(i);
      k.momentum += m * sim.velocity(i);
      k.angular += m * cross(sim.position(i), sim.velocity(i)) + I * sim.angular_velocity(i);
    }
    return k;
  };
  sim.run(0);
  const Kept start = look();
  double most = 0, first = 0, last = 0, bent = 0;
  const int pieces = 200;
  for (int k = 0; k < pieces; ++k) {
    sim.run(5000 * sim.step_length());
    const Kept now = look();
    const double off = now.energy / start.energy - 1;
    most = std::max(most, std::abs(off));
    (k < pieces / 2 ? first : last) += off / (pieces / 2);
    bent = std::max(bent, sim.bond_energy() / start.energy);
  }
  const Kept end = look();
  CHECK(most < 1e-4);                    // of the time step, second order
  CHECK(std::abs(last - first) < 1e-6);  // ... which swings and does not drift
  CHECK(bent > 0.2);
  CHECK(norm(end.momentum - start.momentum) < 1e-11 * norm(start.momentum));
  CHECK(norm(end.angular - start.angular) < 1e-9 * norm(start.angular));
}

TEST_CASE("bonds: spheres are turned from the first bond on, which begins without strain") {
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{},
      silt::Contacts<silt::HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5}},
      silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e6, .damping = 0}}};
  silt::Particles<silt::Sphere> three;
  for (int k = 0; k < 3; ++k)
    three.add({.position = {3 * R * k, 0, 0}, .radius = R, .density = 2000});
  sim.add(three);
  sim.time_step = 1e-6, sim.threads = 1;
  const double spin = 100;  // [rad/s]
  for (silt::ParticleId id = 0; id < 3; ++id) sim.set_angular_velocity(id, {0, 0, spin});
  sim.run(1e-3);
  CHECK(sim.orientation(sim.find(2)) == silt::Quaternion{});
  sim.bond(0, 1);
  CHECK(sim.bond_energy() == 0);
  sim.run(2e-3);
  // By the series of sine and cosine and their rounding, 2000 times.
  const auto q = sim.orientation(sim.find(2));
  CHECK(2 * std::atan2(q.z, q.w) == near(spin * 2e-3).epsilon(1e-12));
  CHECK(sim.bond_energy() > 0);  // both ends turn: the bond is sheared
}

}  // namespace bond_drift_test
