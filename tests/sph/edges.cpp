// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>
#include <silt/sph/edge_image.hpp>

#include "near.hpp"

namespace sph_edges_test {

using namespace silt;

namespace {

constexpr double g = 9.81;

/// Signed distance of a cube [-1, 1]^3, negative inside, right where faces are nearest.
double cube(const Vec3d& x) { return std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) - 1; }

std::vector<Vec3d> corners_of(double a, double b) {
  std::vector<Vec3d> corners;
  for (const double x : {-a / 2, a / 2})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-b / 2, b / 2}) corners.push_back({x, y, z});
  return corners;
}

}  // namespace

TEST_CASE("SPH: mirror images at an edge are on its bisector, elsewhere at the nearest face") {
  const auto out = [](const Vec3d& x, double h) {
    return detail::way_out_at_edge(x, -cube(x), h, false, cube);
  };
  // On the bisector of two faces and of three.
  for (const double depth : {0.02, 0.1, 0.3}) {
    const auto edge = out({1 - depth, 0, 1 - depth}, 0.1),
               corner = out({1 - depth, 1 - depth, depth - 1}, 0.1);
    REQUIRE(edge);
    REQUIRE(corner);
    CHECK(norm(*edge - Vec3d{depth, 0, depth}) < 1e-6);
    CHECK(norm(*corner - Vec3d{depth, depth, -depth}) < 1e-6);
  }
  CHECK_FALSE(out({0.95, 0, 0.8}, 0.1));  // 0.15 = 1.5 h from the bisector
  CHECK(out({0.95, 0, 0.85}, 0.1));
  // Where a surface is curved the direction is as good as the nearest; a room is concave.
  const auto ball = [](const Vec3d& x) { return norm(x) - 0.3; };
  const Vec3d in_ball{0.15, 0.1, 0.16};
  const auto radial = detail::way_out_at_edge(in_ball, -ball(in_ball), 0.1, false, ball);
  REQUIRE(radial);
  CHECK(dot(normalised(*radial), normalised(in_ball)) > 0.9995);  // 0.6 degrees
  const auto room = [](const Vec3d& x) { return -cube(x); };
  CHECK_FALSE(detail::way_out_at_edge({1.05, 0, 1.05}, 0.05, 0.1, false, room));
}

// With images at the nearest face liquid gained energy at each edge: 3 cm/s (rms) after 6 s and the
// level 8 % up, around a body and around a wall. With sound in the gap below it the body hopped:
// 2 cm/s, and 4 cm/s of the liquid.
TEST_CASE("SPH: water around a block on the floor stays calm and keeps its level") {
  const double a = 0.08, b = 0.06, s = 0.01, L = 0.3, H = 0.15;
  const auto water = [&] {
    return Sph{
        Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(2 * g * H)},
        {.spacing = s, .region = {{0, 0, 0}, {L, 0, 0.4}}, .dimensions = 2, .gravity = {0, 0, -g}},
        ArtificialViscosity{.alpha = 0.1}};
  };
  const auto check = [&](const auto& liquid, double before) {
    double square = 0, height = 0;
    liquid.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
      square += dot(v, v), height += x.z;
    });
    const auto n = static_cast<double>(liquid.size());
    CHECK(liquid.left() == 0);
    CHECK(std::sqrt(square / n) < 0.005);  // 3e-4
    CHECK(height / n == near(before).epsilon(0.01));
  };
  const double level = (0.5 * L * H * H - a * b * b / 2) / (L * H - a * b);
  SUBCASE("a body") {
    auto liquid = water();
    liquid.fill([&](const Vec3d& x) { return x.z < H; });
    Particles<Polyhedron> bodies;
    const auto form = bodies.add_form(Polyhedron::from_points(corners_of(a, b)));
    bodies.add({.form = form, .position = {L / 2, 0, b / 2}, .density = 1100});
    const HertzMindlin::Material steel{
        .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3};
    Simulation sim{std::move(bodies), Contacts<HertzMindlin>{steel}, std::move(liquid)};
    sim.gravity = {0, 0, -g};
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, steel);
    sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, steel);
    sim.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}}, steel);
    sim.run(6);
    check(sim.fluid(), level);
    CHECK(norm(sim.velocity(0)) < 1e-3);
    CHECK(std::abs(sim.position(0).z - b / 2) < 5e-4);  // the floor is soft
  }
  SUBCASE("a wall") {
    auto liquid = water();
    liquid.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    liquid.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
    liquid.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
    liquid.add_wall(box_mesh({(L - a) / 2, -0.5, -0.1}, {(L + a) / 2, 0.5, b}));
    liquid.fill([&](const Vec3d& x) { return x.z < H; });
    liquid.run(6);
    check(liquid, level);
  }
}

// The pressure below a body follows its id. By its place among the bodies, the block that is left
// would get that of the deeper basin, 700 Pa more: the floor had 0.8 of its force after 4 ms. A
// simulation that has run with two bodies takes a state of one.
TEST_CASE("SPH: a block on a floor keeps the pressure below it when another body is removed") {
  const double a = 0.06, b = 0.04, s = 0.01;
  const auto basins = [&] {
    Sph water{Liquid{.density = 1000, .sound_speed = 18},
              {.spacing = s,
               .region = {{0, 0, 0}, {0.5, 0, 0.4}},
               .dimensions = 2,
               .gravity = {0, 0, -g}},
              ArtificialViscosity{.alpha = 0.1}};
    water.fill([](const Vec3d& x) {
      return x.z < (x.x < 0.25 ? 0.15 : 0.08) && std::abs(x.x - 0.25) > 0.04;
    });
    Particles<Polyhedron> bodies;
    const auto form = bodies.add_form(Polyhedron::from_points(corners_of(a, b)));
    bodies.add({.form = form, .position = {0.11, 0, b / 2}, .density = 2700});
    bodies.add({.form = form, .position = {0.39, 0, b / 2}, .density = 2700});
    const HertzMindlin::Material stone{
        .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3};
    Simulation sim{std::move(bodies), Contacts<HertzMindlin>{stone}, std::move(water)};
    sim.gravity = {0, 0, -g};
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, stone);
    sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, stone);
    sim.add_wall(Plane{{0.5, 0, 0}, {-1, 0, 0}}, stone);
    sim.add_wall(box_mesh({0.21, -0.5, -0.1}, {0.29, 0.5, 0.4}), stone);
    return sim;
  };
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_basins.silt").string();
  auto sim = basins();
  sim.run(0.4);
  const double both = -sim.wall(0).force.z, apparent = 1700 * a * b * g;
  CHECK(both == near(2 * apparent).epsilon(0.05));
  sim.remove(sim.id(0));
  sim.run(0.004);
  CHECK(-sim.wall(0).force.z == near(apparent).epsilon(0.05));
  save_checkpoint(sim, path);
  sim.run(0.004);
  auto again = basins();
  again.run(0.002);
  load_checkpoint(again, path);
  again.run(0.004);
  CHECK(again.position(0) == sim.position(0));
  CHECK(again.wall(0).force.z == sim.wall(0).force.z);
  std::filesystem::remove(path);
}

// Legs 10 particles wide around a block of 10. The period is that of a straight column of 0.8113 m
// by potential flow (utube_length.py). With images at the nearest face the walls gave 1.3 J/m in
// half a period, of 1.57 J/m, and the level rose by 2.4 mm.
TEST_CASE("SPH: water in a U-tube with sharp bends gets no energy from its walls") {
  const double w = 0.1, s = 0.01, L = 0.3, energy = 1000 * g * w * 0.04 * 0.04;
  Sph water{
      Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(2 * g * 0.45)},
      {.spacing = s, .region = {{0, 0, 0}, {L, 0, 0.9}}, .dimensions = 2, .gravity = {0, 0, -g}},
      EnergyLedger{}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
  water.add_wall(box_mesh({w, -0.5, w}, {L - w, 0.5, 1.5}));
  water.fill([&](const Vec3d& x) { return x.z < (x.x < L / 2 ? 0.44 : 0.36); });
  const auto levels = [&] {
    double left = 0, right = 0;
    water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
      double& top = x.x < L / 2 ? left : right;
      top = std::max(top, x.z + s / 2);
    });
    return std::pair{left, right};
  };
  const double quarter = std::numbers::pi / 2 * std::sqrt(0.8113 / (2 * g));
  water.run(quarter);
  CHECK(std::abs(levels().first - levels().second) < 0.006);  // 5 % of the time
  water.run(quarter);
  const auto [left, right] = levels();
  CHECK(right - left > 0.05);
  CHECK(std::abs((left + right) / 2 - 0.4) < 0.001);
  CHECK(std::abs(water.energy().at_walls) < 0.1 * energy);
}

}  // namespace sph_edges_test
