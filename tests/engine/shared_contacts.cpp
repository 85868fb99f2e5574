// silt - BSD-3-Clause, see LICENSE
#include <cmath>

#include <silt/shape/multi_sphere.hpp>
#include <silt/silt.hpp>

#include "engine/support.hpp"

namespace {

using namespace engine_test;
using silt::MultiSphere;
using Shares = silt::detail::SharedContacts<double>;

constexpr HertzMindlin::Material smooth{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0};

/// A square plate of n x n balls, flat, with the mass of a given cuboid.
MultiSphere plate(int n) {
  const double side = 4e-3, r = 0.5e-3;
  MultiSphere form;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      form.balls.push_back({{side * (i / (n - 1.0) - 0.5), side * (j / (n - 1.0) - 0.5), 0}, r});
  const double v = 5e-3 * 5e-3 * 1e-3;
  form.mass = silt::MassProperties{v, {0, 0, 0}, v * Vec3d{2.2e-6, 2.2e-6, 4.2e-6}, {}};
  return form;
}

struct Impact {
  double restitution, overlap;
};
/// A plate falls flat onto the floor at 0.5 m/s.
Impact flat_impact(int n, bool share) {
  silt::Particles<MultiSphere> one;
  one.add_form(plate(n));
  one.add({.position = {0, 0, 0.6e-3}, .density = 2500, .velocity = {0, 0, -0.5}});
  silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{smooth}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  sim.share_contacts(share);
  sim.time_step = 2e-7;
  sim.run(2e-3);
  return {sim.velocity(0).z / 0.5, sim.peak_overlap()};
}

}  // namespace

TEST_CASE(
    "n contacts side by side count n, those across each other do not, a new one counts nothing") {
  const Vec3d up{0, 0, 1}, right{1, 0, 0};
  const std::vector<Shares::Touch> same{{1e-6, up}, {1e-6, up}, {1e-6, up}};
  CHECK(Shares::count(same[0], same) == doctest::Approx(3).epsilon(1e-12));
  const std::vector<Shares::Touch> corner{{1e-6, up}, {1e-6, right}, {1e-6, -up}};
  CHECK(Shares::count(corner[0], corner) == 1);
  const std::vector<Shares::Touch> begun{{1e-6, up}, {1e-12, up}};
  CHECK(Shares::count(begun[0], begun) == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("A plate is as stiff and as damped with 4 as with 100 balls that touch") {
  const Impact few = flat_impact(2, true), many = flat_impact(10, true);
  // One contact of the whole mass: e as set, up to the corrections of its form (leapfrog: 1e-3).
  CHECK(std::abs(few.restitution - 0.6) < 2e-3);
  CHECK(std::abs(many.restitution - few.restitution) < 1e-9);
  CHECK(std::abs(many.overlap - few.overlap) < 1e-9 * few.overlap);
  // Left out, 25 times as many springs are 25 times as stiff: overlaps go by n^(-2/5), and the
  // dashpots, each made for the whole mass, take too much.
  const Impact alone_few = flat_impact(2, false), alone_many = flat_impact(10, false);
  CHECK(alone_few.overlap / few.overlap < std::pow(4, -0.4) * 1.02);
  CHECK(alone_many.overlap / alone_few.overlap < std::pow(25, -0.4) * 1.1);
  CHECK(alone_few.restitution < 0.5);
  CHECK(alone_many.restitution < 0.2);
}

TEST_CASE("Two plates share the contacts between them") {
  const auto run = [](int n, bool share) {
    silt::Particles<MultiSphere> two;
    two.add_form(plate(n));
    two.add({.position = {0, 0, 0.55e-3}, .density = 2500, .velocity = {0, 0, -0.3}});
    two.add({.position = {0, 0, -0.55e-3}, .density = 2500, .velocity = {0, 0, 0.3}});
    silt::Simulation sim{std::move(two), silt::Contacts<HertzMindlin>{smooth}};
    sim.share_contacts(share);
    sim.time_step = 2e-7;
    sim.run(2e-3);
    return Impact{(sim.velocity(sim.find(0)).z - sim.velocity(sim.find(1)).z) / 0.6,
                  sim.peak_overlap()};
  };
  const Impact few = run(2, true), many = run(8, true);
  CHECK(std::abs(few.restitution - 0.6) < 2e-3);
  CHECK(std::abs(many.restitution - few.restitution) < 1e-8);
  CHECK(run(8, false).restitution < 0.2);
}

// The shared forces have no potential. How much energy an elastic plate gains or loses that falls
// onto an edge, rocks and flies off: against the same plate whose balls do not share, which keeps
// it.
TEST_CASE("What sharing costs or gives in energy, when a plate rocks") {
  const auto error = [](double tilt, bool share) {
    auto elastic = smooth;
    elastic.restitution = 1;
    silt::Particles<MultiSphere> one;
    one.add_form(plate(5));
    one.add({.position = {0, 0, 2.5e-3},
             .orientation = silt::rotation_about({0.8, 0.6, 0}, tilt),
             .density = 2500,
             .velocity = {0, 0, -0.5}});
    silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{elastic}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic);
    sim.share_contacts(share);
    sim.time_step = 1e-7;
    const auto energy = [&] {
      const Vec3d v = sim.velocity(0),
                  w = rotate(conjugate(sim.orientation(0)), sim.angular_velocity(0));
      return 0.5 * sim.mass(0) *
             (dot(v, v) + 2.2e-6 * (w.x * w.x + w.y * w.y) + 4.2e-6 * w.z * w.z);
    };
    sim.run(0);
    const double before = energy();
    sim.run(0.01);
    return energy() / before - 1;
  };
  for (const double tilt : {0.02, 0.1, 0.3}) {
    CHECK(std::abs(error(tilt, false)) < 1e-4);
    MESSAGE("tilt ", tilt, ": ", error(tilt, true));
    CHECK(std::abs(error(tilt, true)) < 0.05);
  }
}
