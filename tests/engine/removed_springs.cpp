// silt - BSD-3-Clause, see LICENSE
// What the contacts of spheres store as one is removed, or their wall, in the ledger.
#include <cmath>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace removed_springs_test {

using silt::Vec3d;

constexpr double R = 1e-3, density = 2500, v = 2;  // [m], [kg/m3], [m/s]

/// Three spheres: 0 hits a wall, and 1 hits 2 from aside, at the same time.
auto impacts(double step, double restitution) {
  const silt::HertzMindlin::Material glass{.youngs_modulus = 1e9,
                                           .poisson_ratio = 0.25,
                                           .restitution = restitution,
                                           .friction = restitution < 1 ? 0.4 : 0};
  silt::Particles<silt::Sphere> grains;
  const auto add = [&](const Vec3d& at, const Vec3d& velocity) {
    grains.add({.position = at, .radius = R, .density = density, .velocity = velocity});
  };
  add({0, 0, R + 1e-6}, {0.5, 0, -v});
  add({0.1, 0, 0.1}, {v, 0.5, 0});
  add({0.1 + 2 * R + 1e-6, 0, 0.1}, {0, 0, 0});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, silt::WallSetup{.name = "plate"});
  sim.time_step = step;
  sim.run(1.2e-5);
  return sim;
}

TEST_CASE("remove, remove_wall: what contacts of spheres store leaves with them, in the ledger") {
  // Catches springs that stay in residual(): a fifth of the energy.
  for (const double restitution : {1.0, 0.5})
    for (const bool fine : {false, true}) {
      const double step = fine ? 1e-8 : 2e-8;
      for (const int what : {0, 1, 2}) {
        auto sim = impacts(step, restitution);
        const auto before = sim.energy();
        CHECK(before.normal > 0.1 * before.initial);
        const double openings = before.openings;
        if (what == 0)
          sim.remove(0);
        else if (what == 1)
          sim.remove(1);
        else
          sim.remove_wall("plate");
        // At once: half a step of the work of the springs.
        CHECK(std::abs(sim.energy().residual()) < 0.02 * before.initial);
        sim.run(2e-6);
        const auto e = sim.energy();
        CHECK(e.openings < openings - 0.05 * e.initial);
        // What the last forces would still have done to the sphere itself: first order, 4.5e-4 and
        // 2.3e-4 (computed); of a wall nothing.
        CHECK(std::abs(e.residual()) < (what == 2 ? 1e-6 : 3e4 * step) * e.initial);
      }
    }
}

TEST_CASE("remove_wall: a sphere that is removed after its wall takes no spring of it") {
  // Catches candidates of the wall that is gone.
  auto sim = impacts(2e-8, 1);
  sim.remove_wall("plate");
  const double openings = sim.energy().openings;
  const double own = 0.5 * sim.mass(0) * dot(sim.velocity(0), sim.velocity(0));
  sim.remove(0);
  CHECK(sim.energy().openings == near(openings - own).epsilon(1e-12));
}

}  // namespace removed_springs_test
