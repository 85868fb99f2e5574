// silt - BSD-3-Clause, see LICENSE
//
// A fluid that starts or changes suddenly gives a particle the inviscid impulse, whatever the
// steps.

#include <cmath>
#include <optional>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace impulsive_start_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Particles;
using silt::Sphere;

namespace {

constexpr double width = 0.1, height = 0.2;

/// A grain of 3 mm in water of no viscosity, in cells so large that it does not move the water.
auto grain_in_water(double density, double inflow, std::optional<int> steps, double time_step) {
  FlowSolver flow(Grid({{0, 0, 0}, {width, width, height}}, {5, 5, 10}, {true, true, false}),
                  {1000, 0}, {.tolerance = 1e-9});
  flow.set_side(2, 0, silt::Inflow{{0, 0, inflow}});
  flow.set_side(2, 1, silt::Outflow{});
  Particles<Sphere> grain;
  grain.add({.position = {width / 2, width / 2, height / 2}, .radius = 1.5e-3, .density = density});
  silt::CoupledFlow water{silt::Stokes{}, silt::Kernel{}, std::move(flow), silt::VirtualMass{}};
  water.steps = steps;
  silt::Simulation sim{std::move(grain), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.5, 0.3}},
                       std::move(water)};
  sim.time_step = time_step, sim.threads = 1;
  sim.guard.max_time_step = 1e9;  // it meets nobody
  return sim;
}

/// [m/s] of pressure and virtual mass together, for water that jumps by U.
double impulse(double density, double U) { return U * 3 * 1000 / (2 * density + 1000); }

}  // namespace

TEST_CASE("water that starts suddenly gives a grain its impulse, in any steps") {
  // (rho_p + rho/2) dv/dt = 3/2 rho du/dt. The grain takes 7e-6 of the water's place.
  const double U = 0.1;
  for (const double density : {1e-3, 100.0, 2650.0, 7800.0})
    for (const int steps : {0, 1, 2, 5, 20})  // 0: chosen, the first one and then up to 50
      for (const double dt : {1e-5, 1e-4}) {
        CAPTURE(density);
        CAPTURE(steps);
        CAPTURE(dt);
        auto sim = grain_in_water(density, U, steps > 0 ? std::optional(steps) : std::nullopt, dt);
        sim.run(100 * dt);
        CHECK(sim.velocity(0).z == near(impulse(density, U)).epsilon(2e-3));
      }
}

TEST_CASE("an inflow that jumps, and steps that change their length") {
  const double U = 0.1, density = 2650;
  for (const int steps : {1, 7, 20}) {
    CAPTURE(steps);
    auto sim = grain_in_water(density, U, steps, 2e-5);
    sim.run(1e-3);
    sim.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, 3 * U}});
    sim.run(1e-3);
    CHECK(sim.velocity(0).z == near(impulse(density, 3 * U)).epsilon(2e-3));
    sim.time_step = 3e-5, sim.fluid().steps = 2;
    sim.run(1e-3);
    CHECK(sim.velocity(0).z == near(impulse(density, 3 * U)).epsilon(2e-3));
    sim.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, -U}});
    sim.time_step = 1e-5, sim.fluid().steps = 50;
    sim.run(2e-3);
    CHECK(sim.velocity(0).z == near(impulse(density, -U)).epsilon(2e-3));
  }
}

}  // namespace impulsive_start_test
