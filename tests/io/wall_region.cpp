// silt - BSD-3-Clause, see LICENSE
// Pictures of walls: the region in which planes are drawn, planes cut by others of their wall, and
// series that are continued.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <set>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/io/observers.hpp>

#include "near.hpp"

namespace wall_region_test {

namespace {

using namespace engine_test;
namespace fs = std::filesystem;

constexpr double R = 1e-3;  // [m]

auto scene(std::initializer_list<Vec3d> places) {
  silt::Particles<Sphere> p;
  for (const Vec3d& x : places) p.add({.position = x, .radius = R, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;
  sim.threads = 1;
  return sim;
}

/// Bounds of wall w as it is drawn, and its area [m2].
struct Drawn {
  Box bounds;
  double area = 0;
};
template <class Sim>
Drawn drawn(const Sim& sim, std::size_t w) {
  const auto all = silt::wall_triangles(sim, silt::detail::wall_region(sim));
  Drawn out;
  for (const auto& t : all.triangles) {
    if (all.wall[t[0]] != w) continue;
    const Vec3d &a = all.points[t[0]], &b = all.points[t[1]], &c = all.points[t[2]];
    out.bounds.include(a), out.bounds.include(b), out.bounds.include(c);
    out.area += 0.5 * norm(cross(b - a, c - a));
  }
  return out;
}
/// Planes are drawn a millionth of the region larger, so that those at its sides are in it.
bool is(const Box& a, const Box& b) {
  const double most = 1e-5 * norm(b.extent());
  const bool same = norm(a.min - b.min) < most && norm(a.max - b.max) < most;
  if (!same) MESSAGE("from " << silt::text(a.min, " to ", a.max));
  return same;
}

struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_wall_region_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
};

}  // namespace

// Catches a region of the particles alone, sides that stick out over each other by what particles
// overlap, and a far wall across that makes the picture tiny.
TEST_CASE("walls drawn: a box of planes is drawn whole, wherever its one particle is") {
  for (const Vec3d& x : {Vec3d{R, R, R - 1e-5}, Vec3d{0.01, 0.02, 0.1}}) {
    auto sim = scene({x});
    sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.03, 0.11}), rubber);
    const Drawn box = drawn(sim, 0);
    CHECK(is(box.bounds, {{0, 0, 0}, {0.02, 0.03, 0.11}}));
    CHECK(box.area == near(2 * (0.02 * 0.03 + 0.02 * 0.11 + 0.03 * 0.11)).epsilon(1e-4));
  }
  // A direction in which a box has no end for its particles.
  auto slot = scene({{0.01, 0, 0.005}});
  slot.add_wall(silt::box({0, -1, 0}, {0.02, 1, 0.02}), rubber);
  CHECK(is(drawn(slot, 0).bounds, {{0, -5 * R, 0}, {0.02, 5 * R, 0.02}}));
}

// Catches planes that go on behind others of their wall, and boxes that are only whole while they
// are upright.
TEST_CASE("walls drawn: a box that tumbles is drawn whole at each angle") {
  auto sim = scene({{0.01, 0.01, 0.01}});
  sim.add_wall(
      silt::box({0, 0, 0}, {0.02, 0.03, 0.06}), rubber,
      {.motion = silt::Rotation{
           .centre = {0.01, 0.015, 0.03}, .axis = normalised(Vec3d{1, 2, 3}), .rate = 50}});
  sim.guard.max_overlap = 100;
  for (int k = 0; k < 3; ++k) {
    const Drawn box = drawn(sim, 0);
    CHECK(box.area == near(2 * (0.02 * 0.03 + 0.02 * 0.06 + 0.03 * 0.06)).epsilon(1e-4));
    sim.run(5e-3);
  }
}

// Catches ends that are squares, which are seen to turn with the drum, and planes cut that only
// stand beside a cylinder.
TEST_CASE("walls drawn: planes that close a drum and turn with it are circles") {
  constexpr double radius = 0.02, depth = 0.03;  // [m]
  const silt::Motion turns = silt::rotation({0.1, 0, 0}, {0, 1, 0}, 50);
  auto sim = scene({{0.1, 0.01, 0}});
  const silt::Cylinder mantle{{0.1, 0, 0}, {0.1, depth, 0}, radius, silt::Side::Inside};
  sim.add_wall(mantle, rubber, {.motion = turns});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, rubber, {.motion = turns});
  sim.add_wall(silt::Plane{{0, depth, 0}, {0, -1, 0}}, rubber);  // stands still
  sim.add_wall(silt::Plane{{0, -depth, 0}, {0, 1, 0}}, rubber,
               {.motion = turns});  // before its end
  sim.add_wall(silt::Plane{{0.1 - radius, 0, 0}, {1, 0, 0}}, rubber,
               {.motion = turns});  // along it
  // A polygon of 64 corners has 0.9984 of the circle's area.
  const double circle = std::numbers::pi * radius * radius * 0.9984;
  for (int k = 0; k < 3; ++k) {
    CHECK(drawn(sim, 1).area == near(circle).epsilon(1e-4));
    CHECK(is(drawn(sim, 1).bounds,
             {drawn(sim, 0).bounds.min, drawn(sim, 0).bounds.max - Vec3d{0, depth, 0}}));
    CHECK(drawn(sim, 2).area > 1.2 * circle);
    CHECK(drawn(sim, 3).area > 1.2 * circle);
    sim.run(5e-3);
  }
  CHECK(drawn(sim, 4).area > 1.2 * 2 * radius * depth);
}

TEST_CASE(
    "walls drawn: a floor is as wide as the hopper over it, and near planes are in the region") {
  auto sim = scene({{0, 0, 0.01}});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  CHECK(is(drawn(sim, 0).bounds, {{-5 * R, -5 * R, 0}, {5 * R, 5 * R, 0}}));
  sim.add_wall(silt::Cone{.from = {0, 0, 0.02},
                          .to = {0, 0, 0.05},
                          .radius_from = 0.01,
                          .radius_to = 0.04,
                          .side = silt::Side::Inside},
               rubber);
  CHECK(is(drawn(sim, 0).bounds, {{-0.04, -0.04, 0}, {0.04, 0.04, 0}}));
  // Within two of the scene's 0.08 m a wall is drawn, beyond that it is not.
  sim.add_wall(silt::Plane{{0.199, 0, 0}, {-1, 0, 0}}, rubber);
  sim.add_wall(silt::Plane{{0, -0.201, 0}, {0, 1, 0}}, rubber);
  CHECK(is(drawn(sim, 2).bounds, {{0.199, -0.04, 0}, {0.199, 0.04, 0.05}}));
  CHECK(drawn(sim, 3).area == 0);
  CHECK(is(drawn(sim, 0).bounds, {{-0.04, -0.04, 0}, {0.199, 0.04, 0}}));
  // A chute: a plane aslant within all of that.
  sim.add_wall(silt::Plane{{0, 0, 0.02}, {1, 0, 1}}, rubber);
  CHECK(drawn(sim, 4).area > 0.08 * 0.05);
}

TEST_CASE("walls drawn: periodic directions are whole, and inlets belong to the scene") {
  silt::Particles<Sphere> p;
  p.add({.position = {0.01, 0.01, 0.01}, .radius = R, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber},
                       silt::PeriodicBox{{{0, 0, 0}, {0.05, 0.04, 1}}, {true, true, false}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  CHECK(is(drawn(sim, 0).bounds, {{0, 0, 0}, {0.05, 0.04, 0}}));

  auto empty = scene({});
  empty.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  CHECK(has_words(refusal<silt::InputError>([&] { silt::write_walls("none.vtp", empty); }),
                  {"no particles and no finite walls", "third argument"}));
  empty.add_inlet({{0, 0, 0.05}, {0.03, 0.02, 0.07}}, {.radius = R, .density = 2500, .rate = 10});
  CHECK(is(drawn(empty, 0).bounds, {{0, 0, 0}, {0.03, 0.02, 0}}));
}

// Catches a continued series with files of its own, and walls that stay as they were.
TEST_CASE("vtk_series: continued, it writes the walls' files of a run that was not interrupted") {
  const auto files = [](bool interrupted) {
    const Folder folder;
    const auto make = [] {
      auto sim = scene({{0.01, 0.01, 0.03}});
      sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.04}), rubber);
      // It moves from 4 ms to 8 ms.
      sim.add_wall(silt::rectangle({0.05, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}), rubber,
                   {.motion = [](double t) {
                     return silt::Pose{{}, {std::clamp(t, 4e-3, 8e-3), 0, 0}};
                   }});
      return sim;
    };
    const auto series = [&] { return silt::vtk_series(folder.path, silt::every(1e-3)); };
    const std::string file = folder.path + "/c";
    if (interrupted)
      for (const double until : {2e-3, 6e-3, 11e-3}) {
        auto sim = make();
        if (until > 2e-3) silt::load_checkpoint(sim, file);
        sim.run(until - sim.time(), series());
        silt::save_checkpoint(sim, file);
      }
    else
      make().run(11e-3, series());
    fs::remove(file);
    std::set<std::string> names{silt::detail::read_file(folder.path + "/walls.pvd")};
    for (const auto& one : fs::directory_iterator(folder.path))
      names.insert(one.path().filename().string());
    return names;
  };
  const auto whole = files(false);
  CHECK(whole.contains("walls_000000000.vtp"));
  CHECK_FALSE(whole.contains("walls_000000100.vtp"));
  CHECK(whole.contains("walls_000000600.vtp"));
  CHECK(files(true) == whole);
}

}  // namespace wall_region_test
