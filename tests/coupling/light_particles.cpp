// silt - BSD-3-Clause, see LICENSE
//
// Particles of any density in a fluid: the exchange of a step is right and stable for ratios of
// densities from 1e-6 to 1e6, whatever the step.

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace light_particles_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Particles;
using silt::Sphere;
using silt::Vec3d;

namespace {

constexpr double water = 1000, mu = 1e-3, g = 9.81;

/// Particles that cannot touch: spheres of no stiffness.
template <class... Forces>
auto in_water(Particles<Sphere> grains, FlowSolver flow, double time_step, int steps,
              const Forces&... forces) {
  const Grid& cells = flow.grid();
  const silt::PeriodicBox domain{cells.box(),
                                 {cells.periodic(0), cells.periodic(1), cells.periodic(2)}};
  silt::CoupledFlow fluid{silt::Gidaspow{}, silt::Kernel{}, std::move(flow), forces...};
  fluid.steps = steps;
  silt::Simulation sim{std::move(grains),
                       silt::Contacts<silt::HertzMindlin>{{1e-14, 0.3, 0.5, 0.3}}, domain,
                       std::move(fluid)};
  sim.gravity = {0, 0, -g};
  sim.time_step = time_step, sim.threads = 1;
  sim.guard.max_time_step = sim.guard.max_rate = sim.guard.max_overlap = 1e30;
  return sim;
}

struct Rise {
  double mean, fastest;  // [-] of the middle, over the drag law's velocity
  double closure;        // [-] of momentum
};

/// A lattice of n x n x layers spheres of 0.5 mm, its places disturbed, between a floor and a lid
/// of water: its mean velocity after `spans` relaxation times of X^-1 fluid steps each, over eps W
/// = Q, by the balance of drag, weight and pressure.
template <class... Forces>
Rise rise(double ratio, double voidage, double X, const Forces&... forces) {
  constexpr bool added = (false || ... || std::is_same_v<Forces, silt::VirtualMass>);
  const double d = 0.5e-3, density = ratio * water;
  const int n = 4, layers = 14, steps = 5;
  const double pitch = d * std::cbrt(std::acos(-1.0) / 6 / (1 - voidage)), W = n * pitch,
               H = (layers + 2) * pitch;
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 16}, {true, true, false}), {water, mu},
                  {.tolerance = 1e-8});
  Particles<Sphere> grains;
  silt::Random random(1);
  for (int k = 0; k < n * n * layers; ++k) {
    const auto shift = [&] { return 0.1 * (pitch - d) * random.uniform(-1, 1); };
    grains.add({.position = {(k % n + 0.5) * pitch + shift(), (k / n % n + 0.5) * pitch + shift(),
                             (k / (n * n) + 1.5) * pitch + shift()},
                .radius = d / 2,
                .density = density});
  }
  const double law =
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, voidage, d, density, water, mu);
  const double K = silt::drag_coefficient(silt::Gidaspow{}, voidage, law * water * d / mu, d, mu);
  // With the inertia of the water that makes way. So short that the lattice stays one.
  const double relaxation = voidage * voidage * (density + water) * Sphere::volume(d / 2) / K;
  const double longest = (added ? 0.9 : 0.3) * pitch / law;
  const double span = std::min({X * relaxation, 0.9 * flow.stable_step(), longest / 40});
  auto sim = in_water(std::move(grains), std::move(flow), span / steps, steps, forces...);
  sim.guard.max_travel = 3;
  sim.run(std::min(std::max((added ? 25 : 8) * relaxation, 40 * span), longest));
  Rise done{0, 0, sim.fluid().closure().momentum};
  // The law at the voidage that the grains see: at 0.48 it is 8 times as sensitive.
  double seen = 0;
  int count = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    // Weights blur the crowd's ends over some diameters.
    if (std::abs(sim.position(k).z / H - 0.5) > 0.08) continue;
    done.mean += sim.velocity(k).z, ++count;
    seen += sim.fluid().voidage_at_particles()[k];
    done.fastest = std::max(done.fastest, norm(sim.velocity(k)) / law);
  }
  CHECK(seen / count == near(voidage).epsilon(0.015));
  done.mean *=
      (ratio < 1 ? 1.0 : -1.0) / count /
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, seen / count, d, density, water, mu);
  return done;
}

}  // namespace

TEST_CASE("crowds of light particles rise in water as their law says, in steps long and short") {
  // Explicitly: no step is stable from (1 - eps)/eps rho/rho_p = 1 on. 0.15 of solids and 0.1 of
  // the density is the bed that swung between -0.65 and 0.33 m/s.
  for (const double ratio : {1e-6, 0.02, 0.1, 0.5})
    for (const double voidage : {0.48, 0.85, 0.99})
      for (const double X : {0.02, 0.5}) {
        if (X < 0.1 && voidage != 0.85) continue;
        CAPTURE(ratio);
        CAPTURE(voidage);
        CAPTURE(X);
        const Rise held = rise(ratio, voidage, X);
        // The lattice is not quite uniform; the relaxation has e^-8 to go.
        CHECK(held.mean == near(1).epsilon(0.02));
        CHECK(held.fastest < 1.3);
        CHECK(held.closure < 1e-12);
      }
}

TEST_CASE("the same with virtual mass") {
  for (const double ratio : {1e-6, 0.02}) {
    CAPTURE(ratio);
    const Rise added = rise(ratio, 0.85, 0.5, silt::VirtualMass{});
    CHECK(added.mean == near(1).epsilon(0.03));
    CHECK(added.fastest < 1.3);
    CHECK(added.closure < 1e-12);
  }
}

TEST_CASE("the same with drag that follows") {
  for (const double ratio : {1e-6, 0.02}) {
    CAPTURE(ratio);
    const Rise followed = rise(ratio, 0.85, 0.5, silt::FollowedDrag{});
    CHECK(followed.mean == near(1).epsilon(0.02));
    CHECK(followed.fastest < 1.3);
    CHECK(followed.closure < 1e-12);
  }
}

TEST_CASE("one grain comes to its terminal velocity for any ratio of densities and any step") {
  // Of 20 um: Stokes' regime, d^2/nu = 4e-4 s. In cells so large that it does not move the water.
  const double d = 20e-6, W = 0.02;
  const double V = Sphere::volume(d / 2);
  for (const double ratio : {1e-6, 1e-3, 0.5, 3.0, 1e3, 1e6})
    for (const double X : {1e-2, 1.0, 1e3}) {
      CAPTURE(ratio);
      CAPTURE(X);
      const double law = silt::terminal_velocity(silt::Gidaspow{}, d, ratio * water, water, mu);
      const double K = silt::drag_coefficient(silt::Gidaspow{}, 1.0, law * water * d / mu, d, mu);
      const double relaxation = ratio * water * V / K;
      FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {4, 4, 4}, {true, true, false}), {water, mu});
      // What a step must not be longer than for the flow, or for the grain to stay in the box.
      const double span = std::min(
          {X * relaxation, 0.9 * flow.stable_step(), W / 4 / law / std::max(30 / X, 60.0)});
      if (span < 0.5 * X * relaxation && ratio > 2) continue;
      Particles<Sphere> grain;
      grain.add({.position = {W / 2, W / 2, W / 2}, .radius = d / 2, .density = ratio * water});
      auto sim = in_water(std::move(grain), std::move(flow), span / 2, 2);
      sim.guard.max_travel = 1e30;
      sim.run(std::max(12 * relaxation, 60 * span));
      CHECK(sim.velocity(0).z == near((ratio < 1 ? 1 : -1) * law).epsilon(1e-3));
    }
}

}  // namespace light_particles_test
