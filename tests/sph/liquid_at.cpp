// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace liquid_at_test {

using namespace silt;

namespace {
constexpr double g = 9.81, depth = 0.2, s = 0.01;

/// Water in a tank, 3D or 2D, periodic in x on request.
Sph<> tank(int dimensions, bool round = false, double scatter = 0.2) {
  Sph<> water{Liquid{.density = 1000, .sound_speed = 30},
              {.spacing = s,
               .region = {{0, 0, 0}, {0.2, dimensions == 3 ? 0.1 : 0.0, 0.4}},
               .dimensions = dimensions,
               .periodic = {round, false, false},
               .gravity = {0, 0, -g},
               .scatter = scatter}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  if (!round) water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  return water;
}
Vec3d shear(const Vec3d& x) { return {0.5 + 3 * x.z, 0, 1 - 2 * x.x}; }
}  // namespace

// Catches sums that are not normalised (half of everything at a wall), means in place of fits (off
// by the slope times 0.4 h there), a y in 2D, and images that are missing across a periodic side.
TEST_CASE("liquid_at: a linear velocity and pressure are exact inside, at walls and in corners") {
  const auto pressure = [](const Vec3d& x) { return 2000 - 3000 * x.z + 1000 * x.x; };
  for (const int dimensions : {2, 3}) {
    auto water = tank(dimensions);
    water.fill([](const Vec3d& x) { return x.z < depth; }, shear, pressure);
    const double y = dimensions == 3 ? 0.043 : 0;
    for (const Vec3d& x : {Vec3d{0.1, y, 0.1}, Vec3d{0, y, 0.1}, Vec3d{0.07, y, 0}, Vec3d{0, y, 0},
                           Vec3d{0.05, y, depth - 0.3 * s}}) {
      const LiquidValues at = liquid_at(water, x);
      CHECK(norm(at.velocity - shear(x)) < 1e-6);
      CHECK(at.pressure == near(pressure(x)).epsilon(1e-6));
      CHECK(at.density == near(water.liquid().density_at(pressure(x))).epsilon(1e-6));
    }
    CHECK(liquid_at(water, {0.1, y, 0.1}).filled == near(1).epsilon(0.05));
    CHECK(liquid_at(water, {0.1, y, 0}).filled == near(0.5).epsilon(0.15));
    CHECK(liquid_at(water, {0, y, 0}).filled == near(0.25).epsilon(0.15));
    const LiquidValues edge = liquid_at(water, {0.1, y, depth + 1.7 * water.setup().h()});
    CHECK(edge.filled > 0);  // too little for a fit
    CHECK(norm(edge.velocity) + edge.pressure + edge.density == 0);
    const LiquidValues air = liquid_at(water, {0.1, y, 0.3});
    CHECK(air.filled == 0);
    CHECK(norm(air.velocity) + air.pressure + air.density == 0);
  }
  auto water = tank(2, true);
  const auto wave = [](const Vec3d& x) { return std::cos(10 * std::numbers::pi * x.x); };
  water.fill([](const Vec3d& x) { return x.z < depth; },
             [&](const Vec3d& x) {
               return Vec3d{wave(x), 0, 0};
             },
             [](const Vec3d&) { return 0.0; });
  // A period of 0.2 m, the extreme at the seam. Smoothing takes 5/36 of (k h)^2 = 0.28: 4 %.
  CHECK(liquid_at(water, {0, 0, 0.1}).velocity.x == near(0.96).epsilon(0.01));
  CHECK(liquid_at(water, {0.2, 0, 0.1}).velocity.x ==
        near(liquid_at(water, {0, 0, 0.1}).velocity.x).epsilon(1e-9));
}

// Catches a level that is half of a full kernel (none at walls), the highest particle (half a
// spacing low, or a drop), z in place of the direction of gravity.
TEST_CASE("liquid_level: flat and sloping surfaces, at walls, below drops, with oblique gravity") {
  for (const int dimensions : {2, 3}) {
    auto water = tank(dimensions, false, 0);
    water.fill([](const Vec3d& x) {
      return x.x < 0.15 && (x.z < depth || (std::abs(x.z - 0.255) < 0.4 * s && x.x < s));
    });
    const double y = dimensions == 3 ? 0.05 : 0;
    for (const double x : {0.005, 0.0, 0.05, 0.1})  // above the first two a row of drops
      CHECK(std::abs(liquid_level(water, {x, y, 0.1}) - depth) < 0.1 * s);
    CHECK(std::isnan(liquid_level(water, {0.195, y, 0.1})));
  }
  auto slope = tank(2, false, 0);
  slope.fill([](const Vec3d& x) { return x.z < 0.1 + 0.5 * x.x; });
  for (const double x : {0.05, 0.1, 0.15})
    CHECK(std::abs(liquid_level(slope, {x, 0, 0}) - (0.1 + 0.5 * x)) < 0.5 * s);
  slope.gravity = {3, 0, -4};
  // Up is (-0.6, 0, 0.8): from (0.1, 0, 0.1) the surface is where 0.1 + 0.8 t = 0.15 - 0.3 t.
  CHECK(std::abs(liquid_level(slope, {0.1, 0, 0.1}) - (0.02 + 0.05 / 1.1)) < 0.5 * s);
}

TEST_CASE("liquid_probes and liquid_levels write what liquid_at and liquid_level return") {
  const std::string folder = std::filesystem::temp_directory_path() / "silt_liquid_probes";
  auto water = tank(3, false, 0);
  water.fill([](const Vec3d& x) { return x.z < depth; });
  Particles<Sphere> balls;
  balls.add({.position = {0.1, 0.05, 0.15}, .radius = 0.02, .density = 2000});
  const HertzMindlin::Material plastic{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  Simulation sim{std::move(balls), Contacts<HertzMindlin>{plastic}, std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 2e-5;
  const Vec3d low{0.15, 0.05, 0.05}, high{0.05, 0.05, 0.1};
  sim.run(4e-3, liquid_probes(folder + "/probes.csv", {{"low", low}, {"high", high}}, every(1e-3)),
          liquid_levels(folder + "/levels.csv", {{"left", high}, {"dry", {0.5, 0.05, 0}}},
                        every(1e-3)));
  const auto last = [&](const char* name) {
    const std::string all = detail::read_file(folder + name);
    CHECK(std::count(all.begin(), all.end(), '\n') == 6);  // a title and five times
    const std::size_t end = all.rfind('\n'), from = all.rfind('\n', end - 1) + 1;
    return all.substr(from, end - from);
  };
  std::string expected = text(sim.time());
  for (const Vec3d& x : {low, high}) {
    const LiquidValues v = liquid_at(sim.fluid(), x);
    for (const double value : {v.velocity.x, v.velocity.y, v.velocity.z, v.pressure, v.filled})
      expected += ',' + text(value);
  }
  CHECK(last("/probes.csv") == expected);
  CHECK(last("/levels.csv") == text(sim.time(), ',', liquid_level(sim.fluid(), high), ",nan"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("liquid_at and its observers: what is refused") {
  auto water = tank(2);
  water.fill([](const Vec3d& x) { return x.z < depth; });
  const double inf = std::numeric_limits<double>::infinity();
  const auto says = [](const auto& call, const char* words) {
    CHECK_THROWS_AS(call(), InputError);
    silt_test::has(silt_test::refusal(call), words);
  };
  says([&] { return liquid_at(water, {inf, 0, 0}); }, "liquid_at: the point (inf, 0, 0) [m]");
  says([&] { return liquid_level(water, {0, 0, inf}); }, "must be finite");
  says([] { return liquid_probes("a.csv", {}, every(1)); }, "'a.csv': there are no places");
  says(
      [&] {
        return liquid_levels("a.csv", {{"left", {inf, 0, 0}}}, every(1));
      },
      "the place of 'left', (inf, 0, 0) [m], must be finite");
  says(
      [] {
        return liquid_levels("a.csv", {{"", {0.1, 0, 0}}}, every(1));
      },
      "the name of the place (0.1, 0, 0) m is empty");
}

}  // namespace liquid_at_test
