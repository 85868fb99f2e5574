// silt - BSD-3-Clause, see LICENSE
// The contact bond, and a model of one's own: springs, strengths, free rolling.
//   couples where there are none; a shear that depends on how far the pair has rolled
#include <cmath>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/contact_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace contact_bond_test {

using silt::Vec3d;
constexpr double R = 1e-3, mass = 4.0 / 3 * 3.14159265358979323846 * R * R * R * 2000;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};

auto pair(const silt::ContactBond& model) {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{model}};
  add_bonded(sim, silt::fibre({0, 0, 0}, {2 * R, 0, 0}, 2, {.radius = R, .density = 2000}));
  sim.threads = 1;
  return sim;
}

TEST_CASE("contact bond: a pair swings at sqrt(k/m*), and decays by its damping ratio") {
  for (const double damping : {0.0, 0.1}) {
    auto sim = pair({.normal_stiffness = 1000, .shear_stiffness = 500, .damping = damping});
    sim.set_velocity(0, {-0.01, 0, 0}), sim.set_velocity(1, {0.01, 0, 0});
    const double w = std::sqrt(1000 / (mass / 2)), damped = w * std::sqrt(1 - damping * damping);
    const double quarter = std::acos(damping) / damped;  // until the velocity is 0
    sim.time_step = quarter / 1000;
    sim.run(quarter);
    const double stretch = sim.position(sim.find(1)).x - sim.position(sim.find(0)).x - 2 * R;
    // v0/w exp(-z w t) there, to first order in the step as the dashpot is half a step late.
    CHECK(stretch == near(0.02 / w * std::exp(-damping * w * quarter)).epsilon(1e-3));
  }
}

TEST_CASE("contact bond: it breaks at its strengths, in pull and in shear alone") {
  const silt::ContactBond model{.normal_stiffness = 1000,
                                .shear_stiffness = 1000,
                                .tensile_strength = 2e-3,
                                .shear_strength = 1e-3,
                                .damping = 0};
  // The largest force of a pair that flies apart at v: v sqrt(k m*); of one that is sheared v
  // sqrt(k/(1/m* + 2 R^2/I)), as it turns too: 2/m + 5/m.
  const double pull = 2e-3 / std::sqrt(1000 * mass / 2);
  const double shear = 1e-3 / std::sqrt(1000 / (7 / mass));
  struct Case {
    Vec3d velocity;  // [m/s] of 1, over that at which it breaks
    double speed;
    bool breaks;
  };
  for (const Case& c : {Case{{1, 0, 0}, 0.99 * pull, false}, Case{{1, 0, 0}, 1.01 * pull, true},
                        Case{{-1, 0, 0}, 3 * pull, false}, Case{{0, 1, 0}, 0.99 * shear, false},
                        Case{{0, 1, 0}, 1.01 * shear, true}}) {
    auto one = pair(model);
    one.set_velocity(1, c.speed * c.velocity);
    one.time_step = 1e-7;
    // To the force's first peak and a little on, in pull or push; in shear that is sooner.
    one.run(1.65 * std::sqrt(mass / 2 / 1000));
    CAPTURE(c.velocity.x);
    CAPTURE(c.speed);
    CHECK((one.broken_bonds() == 1) == c.breaks);
  }
}

TEST_CASE("contact bond: spheres roll and twist on each other without a couple") {
  auto sim = pair({.normal_stiffness = 1000, .shear_stiffness = 500});
  sim.set_angular_velocity(0, {7, 0, 5}), sim.set_angular_velocity(1, {0, 0, -5});
  sim.time_step = 1e-6;
  sim.run(1e-3);  // by 5e-3 rad, which draws the bond out by 2.5e-8 m
  for (const silt::ParticleId id : {0u, 1u})
    CHECK(std::abs(sim.angular_velocity(sim.find(id)).z) == near(5).epsilon(1e-4));
  CHECK(sim.angular_velocity(sim.find(0)).x == near(7).epsilon(1e-4));
  CHECK(sim.bond_energy() < 1e-4 * sim.kinetic_energy());
  sim.for_each_bond([](const silt::BondSeen& b) { CHECK(b.couple == Vec3d{0, 0, 0}); });
}

TEST_CASE("contact bond: what cannot be is refused") {
  const auto refused = [](const silt::ContactBond& bond, const char* words) {
    CHECK(silt_test::has(silt_test::refusal([&] { bond.check(); }), words));
  };
  refused({.normal_stiffness = 0, .shear_stiffness = 1}, "ContactBond.normal_stiffness = 0 [N/m]");
  refused({.normal_stiffness = 1, .shear_stiffness = -1}, "shear_stiffness = -1 [N/m]");
  refused({.normal_stiffness = 1, .shear_stiffness = 1, .tensile_strength = 0},
          "tensile_strength = 0 [N]");
  refused({.normal_stiffness = 1, .shear_stiffness = 1, .damping = -1}, "damping = -1 [-]");
}

}  // namespace contact_bond_test
