// silt - BSD-3-Clause, see LICENSE

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace own_coupling_test {

using silt::FluidCoupling;
using silt::HertzMindlin;
using silt::Particles;
using silt::Simulation;
using silt::Sphere;
using silt::Team;
using silt::Vec3d;

namespace {

const HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};

/// No more than FluidCoupling asks for: a force of its own, 3 particle steps at a time.
struct Lift {
  static constexpr bool active = true;
  silt::FluidClock clock;
  double asked = 0, told = 0;  // [-] steps begun, [s] their lengths

  void prepare(const silt::FluidScene& scene) {
    silt::require(!scene.periodic[0], "Lift: not in a box that repeats in x");
  }
  int steps_wanted(const silt::FluidPace& pace, const Team&) const {
    return pace.speed < 1e3 ? 3 : 1;
  }
  void advance(const silt::CoupledParticles& of, double dt, std::span<Vec3d> force, const Team&,
               std::span<Vec3d>) {
    for (std::size_t p = 0; p < force.size(); ++p) force[p] = {0, 0, 2 * of.mass[p]};
    ++asked, told += dt, clock.count(dt);
  }
  template <class Visit>
  void for_each_state(const Visit& visit) {
    clock.for_each_state(visit);
  }
};
static_assert(FluidCoupling<Lift> && FluidCoupling<silt::NoFluid>);
struct ActiveAlone {
  static constexpr bool active = true;
};
struct NoWords {
  static constexpr bool active = false;
};
static_assert(!FluidCoupling<ActiveAlone> && FluidCoupling<NoWords> && !FluidCoupling<Sphere>);
using Air = silt::CoupledFlow<silt::Gidaspow, silt::Kernel>;
using Followed = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag>;
static_assert(FluidCoupling<Air> && !silt::FollowingFluid<Air> && silt::FollowingFluid<Followed>);

auto scene() {
  Particles<Sphere> all;
  all.add({.position = {0.01, 0.01, 0.01}, .radius = 5e-4, .density = 2500});
  return all;
}

/// A flow that adds nothing to FlowSolver but a count.
struct CountedFlow : silt::FlowSolver {
  using FlowSolver::FlowSolver;
  int counted = 0;
  silt::FlowStep step(double dt, const Team& team = {}) {
    ++counted;
    return FlowSolver::step(dt, team);
  }
};
static_assert(silt::FlowOnGrid<silt::FlowSolver> && silt::FlowOnGrid<CountedFlow>);
static_assert(!silt::FlowOnGrid<silt::Gidaspow> && !silt::FlowOnGrid<silt::Grid>);

}  // namespace

TEST_CASE("FluidCoupling: a fluid of one's own is asked every third step and its force is held") {
  // Catches a fluid that is asked in each step, steps that do not add up to the time, and a force
  // that acts for one step of three.
  Simulation sim{scene(), silt::Contacts<HertzMindlin>{glass}, Lift{}};
  sim.time_step = 2e-5;
  sim.run(0.06);
  CHECK(near_relative(sim.velocity(0).z, 2 * sim.time(), 1e-9));
  CHECK(sim.fluid().asked == doctest::Approx(1001).epsilon(2e-3));
  CHECK(std::abs(sim.fluid().told - sim.time()) < 6.1e-5);
  CHECK(near_relative(sim.fluid().clock.time, sim.fluid().told, 1e-9));
}

TEST_CASE("FluidCoupling: prepare() knows the box that repeats") {
  const silt::Box box{{0, 0, 0}, {0.02, 0.02, 0.02}};
  Simulation fits{scene(), silt::Contacts<HertzMindlin>{glass}, Lift{},
                  silt::PeriodicBox{box, {false, true, false}}};
  fits.time_step = 2e-5;
  CHECK_NOTHROW(fits.run(1e-3));
  Simulation sim{scene(), silt::Contacts<HertzMindlin>{glass}, Lift{},
                 silt::PeriodicBox{box, {true, false, false}}};
  CHECK_THROWS_WITH_AS(sim.run(1e-3), "Lift: not in a box that repeats in x", silt::InputError);
}

TEST_CASE("CoupledFlow: a flow of one's own is used, and one that changes nothing changes no bit") {
  // Catches a coupling that copies the FlowSolver out of a type derived from it.
  const auto force = [](auto flow) {
    flow.set_side(2, 0, silt::Inflow{.velocity = {0, 0, 0.5}});
    flow.set_side(2, 1, silt::Outflow{.pressure = 0});
    Simulation sim{scene(), silt::Contacts<HertzMindlin>{glass},
                   silt::CoupledFlow{flow, silt::VirtualMass{}, silt::Kernel{}, silt::Gidaspow{}}};
    sim.time_step = 2e-5;
    sim.run(0.02);
    if constexpr (requires { flow.counted; })
      CHECK(sim.fluid().flow().counted == sim.fluid().fluid_steps());
    return sim.velocity(0).z;
  };
  const silt::Grid grid({{0, 0, 0}, {0.02, 0.02, 0.03}}, {6, 6, 9});
  const silt::FluidProperties air{1.2, 1.8e-5};
  const double usual = force(silt::FlowSolver(grid, air));
  CHECK(usual > 0);
  CHECK(force(CountedFlow(grid, air)) == usual);
}

}  // namespace own_coupling_test
