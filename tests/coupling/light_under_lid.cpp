// silt - BSD-3-Clause, see LICENSE
//
// Light grains that rise in water, gather under a lid, and come to rest there: with contacts, in
// fluid steps that silt chooses.

#include <algorithm>
#include <cmath>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace light_under_lid_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Particles;
using silt::Sphere;

namespace {

constexpr double water = 1000, mu = 1e-3, g = 9.81, d = 0.66e-3;  // [kg/m3], [Pa s], [m/s2], [m]

struct Bed {
  double law = 0;                      // [m/s] of the drag law
  double slowest = 1e30, fastest = 0;  // [-] mean velocity over that, while they rise freely
  double left = 0;                     // [-] the largest velocity at the end over it
  double load = 0;                     // [-] on the lid, over the buoyancy
  double close = 0;                    // [-] of momentum
};

/// 15 % of solids, 3 x 3 x 8 grains in the lower two thirds of a closed box.
template <class... Forces>
Bed bed(double density, double restitution, double duration, const Forces&... forces) {
  const int n = 3, layers = 8;
  const double pitch = d * std::cbrt(std::acos(-1.0) / 6 / 0.15), W = n * pitch,
               H = 1.5 * layers * pitch;
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {2, 2, 8}, {true, true, false}), {water, mu});
  Particles<Sphere> grains;
  silt::Random random(1);
  for (int k = 0; k < n * n * layers; ++k) {
    const auto place = [&](int i) { return (i + 0.5 + 0.05 * random.uniform(-1, 1)) * pitch; };
    grains.add({.position = {place(k % n), place(k / n % n), place(k / (n * n))},
                .radius = d / 2,
                .density = density});
  }
  const double count = n * n * layers;
  const silt::HertzMindlin::Material soft{1e5, 0.3, restitution, 0.3};
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{soft},
      silt::PeriodicBox{{{0, 0, 0}, {W, W, H}}, {true, true, false}},
      silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, std::move(flow), forces...}};
  sim.gravity = {0, 0, -g}, sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  const auto lid = sim.add_wall(silt::Plane{{0, 0, H}, {0, 0, -1}}, soft);
  Bed b;
  b.law = silt::minimum_fluidisation_velocity(silt::Gidaspow{}, 0.85, d, density, water, mu);
  // The highest have a third of the height to rise: 0.7 of that time, after the start.
  const double free = 0.7 * (H - layers * pitch) / b.law;
  while (sim.time() < free) {
    sim.run(free / 20);
    double mean = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) mean += sim.velocity(k).z / b.law / count;
    if (sim.time() > 0.15 * free) b.slowest = std::min(b.slowest, mean);
    b.fastest = std::max(b.fastest, mean);
  }
  sim.run(duration - sim.time());
  for (std::size_t k = 0; k < sim.rows(); ++k)
    b.left = std::max(b.left, norm(sim.velocity(k)) / b.law);
  b.load = sim.wall(lid).force.z / (count * (water - density) * Sphere::volume(d / 2) * g);
  b.close = sim.fluid().closure().momentum;
  return b;
}

void check(const Bed& b) {
  // Both ends of the crowd are looser than its middle.
  CHECK(b.slowest > 0.9);
  CHECK(b.fastest < 1.25);
  CHECK(b.left < 1e-3);
  CHECK(b.load == near(1).epsilon(0.01));
  CHECK(b.close < 1e-12);
}

}  // namespace

TEST_CASE("a bed of light grains rises without a swing and rests under the lid") {
  // Fluid steps of 50 particle steps made grains of 20 kg/m3 tremble there with 0.3 of the law's
  // velocity for ever.
  for (const auto& of : {std::pair(100.0, 0.9), {20.0, 0.5}, {20.0, 0.9}}) {
    const double density = of.first, restitution = of.second;
    CAPTURE(density);
    CAPTURE(restitution);
    check(bed(density, restitution, 0.3));
  }
}

TEST_CASE("the same with virtual mass, and with drag that follows") {
  check(bed(20, 0.9, 0.3, silt::VirtualMass{}));
  check(bed(20, 0.9, 0.3, silt::FollowedDrag{}));
}

}  // namespace light_under_lid_test
