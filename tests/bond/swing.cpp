// silt - BSD-3-Clause, see LICENSE
// Damped bonds that are swung around: their springs bear m w^2 r, and their dashpots nothing. Bonds
// without dashpots.
#include <cmath>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/contact_bond.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/core/random.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_swing_test {

using silt::Vec3d;
constexpr double R = 1e-3, E = 1e6, w = 400;  // [m], [Pa], [rad/s]
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};

/// A chain of beads 2.2 R apart that turns about its middle. Returns the largest deviation of the
/// force in a bond from what keeps the beads beyond it on their circles, over that.
template <class Model>
double error_of(const Model& model, int beads, double dt) {
  silt::Particles<silt::Sphere> p;
  for (int k = 0; k < beads; ++k) {
    const double r = 2.2 * R * (k - 0.5 * (beads - 1));
    p.add({.position = {r, 0, 0},
           .radius = R,
           .density = 2000,
           .velocity = {0, w * r, 0},
           .angular_velocity = {0, 0, w}});
  }
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass}, silt::Bonds{model}};
  sim.threads = 1;
  sim.time_step = dt;
  for (int k = 0; k + 1 < beads; ++k) sim.bond(k, k + 1);
  sim.run(0.05);
  const auto at = [&](int k) { return sim.position(sim.find(static_cast<silt::ParticleId>(k))); };
  const Vec3d middle = 0.5 * (at(0) + at(beads - 1));
  const double rate = norm(sim.velocity(sim.find(0))) / norm(at(0) - middle);
  double worst = 0;
  Vec3d needed{0, 0, 0};  // by the beads before the bond
  int bond = 0;
  sim.for_each_bond([&](const silt::BondSeen& b) {
    needed += sim.mass(sim.find(0)) * rate * rate * (at(bond) - middle);
    worst = std::max(worst, std::abs(norm(b.force) / norm(needed) - 1));
    ++bond;
  });
  return worst;
}

// Catches dashpots that see bonds stretch as they are swung, since velocities are half a step older
// than positions: springs then bear damping w_0 dt less, 2 % here, of first order.
TEST_CASE("bonds that are swung: forces of chains are m w^2 r, of second order in the step") {
  const silt::ParallelBond rod{.youngs_modulus = E, .damping = 0.3};
  const silt::ContactBond glue{.normal_stiffness = 1500, .shear_stiffness = 500, .damping = 0.3};
  for (const int beads : {2, 5}) {
    CAPTURE(beads);
    const double coarse = error_of(rod, beads, 4e-6), fine = error_of(rod, beads, 2e-6);
    CHECK(coarse < 1e-5);
    CHECK(fine < 0.3 * coarse);
  }
  CHECK(error_of(glue, 2, 4e-6) < 1e-5);
}

TEST_CASE("bonds that are swung: likewise at a wall that turns") {
  silt::Particles<silt::Sphere> p;
  const double r = 4 * R;
  p.add({.position = {r, 0, 0},
         .radius = R,
         .density = 2000,
         .velocity = {0, w * r, 0},
         .angular_velocity = {0, 0, w}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = E, .damping = 0.3}}};
  sim.threads = 1, sim.time_step = 1e-6;
  sim.add_wall(
      silt::Plane{{0, 0, -0.1}, {0, 0, 1}}, glass,
      {.name = "hub", .motion = silt::Rotation{.centre = {0, 0, 0}, .axis = {0, 0, 1}, .rate = w}});
  sim.bond_to_wall(0, "hub", {2 * R, 0, 0});
  sim.run(0.05);
  const double needed = sim.mass(0) * w * w * std::hypot(sim.position(0).x, sim.position(0).y);
  double force = 0;
  sim.for_each_bond([&](const silt::BondSeen& b) { force = norm(b.force); });
  CHECK(force == near(needed).epsilon(1e-5));
  CHECK(norm(sim.wall("hub").force) == near(needed).epsilon(1e-5));
}

/// As ParallelBond, but computed with dashpots even where these are 0.
struct WithDashpots : silt::ParallelBond {
  bool has_dashpots() const { return true; }
};

// Without dashpots no velocities are read. Catches ends that take another column for it.
TEST_CASE("bonds without dashpots: the same bits as with dashpots of 0") {
  const auto last = [](const auto& model) {
    silt::Particles<silt::Sphere> p;
    silt::Random random(7);
    for (int k = 0; k < 27; ++k)
      p.add({.position = {2.1 * R * (k % 3), 2.1 * R * (k / 3 % 3), 2.1 * R * (k / 9)},
             .radius = R * random.uniform(0.8, 1),
             .density = 2000,
             .velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0},
             .angular_velocity = {random.uniform(-50, 50), 0, random.uniform(-50, 50)}});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::Bonds{model}};
    sim.threads = 1, sim.time_step = 2e-6;
    silt::bond_near(sim, 0.6 * R);
    const Vec3d start = sim.position(sim.find(13));
    sim.run(500 * 2e-6);
    std::vector<Vec3d> all;
    for (silt::ParticleId id = 0; id < 27; ++id)
      all.push_back(sim.position(sim.find(id))), all.push_back(sim.angular_velocity(sim.find(id)));
    CHECK(norm(all[26] - start) > 0.01 * R);
    return all;
  };
  const silt::ParallelBond rod{.youngs_modulus = E, .tensile_strength = 1e6, .damping = 0};
  CHECK(last(rod) == last(WithDashpots{rod}));
}

}  // namespace bond_swing_test
