// silt - BSD-3-Clause, see LICENSE
// Each warning fires on the slip that it is for, in a sentence that says what to change, and stays
// silent on near misses and on legitimate scenes; observers pass them on once, or not at all.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <stdexcept>

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/cohesion/dmt.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/fluid.hpp>
#include <silt/io/observers.hpp>
#include <silt/shape/multi_sphere.hpp>

namespace scene_warnings_test {

namespace {

using namespace engine_test;
using silt::inlet_warnings;
using silt::overlap_warnings;
using silt::Particles;
using silt::Plane;
using silt::scene_warnings;
using silt::Side;
using Sentences = std::vector<std::string>;

constexpr double width = 0.02;  // [m] of the box that beds lie in
const Vec3d earth{0, 0, -9.81};

struct Grains {
  double radius = 1e-3, density = 2500;  // [m], [kg/m3]
  int count = 64;
  bool fixed = false;
  Vec3d velocity{0, 0, 0};
};

Particles<Sphere> block(const Grains& g) {
  Particles<Sphere> p;
  for (int k = 0; k < g.count; ++k)
    p.add({.position = (g.radius / 1e-3) * Vec3d{2e-3 + 4e-3 * (k % 4), 2e-3 + 4e-3 * (k / 4 % 4),
                                                 2e-3 + 4e-3 * (k / 16)},
           .radius = g.radius,
           .density = g.density,
           .velocity = g.velocity,
           .fixed = g.fixed});
  return p;
}

template <class... Policies>
auto loose(const Grains& grains, Policies... policies) {
  silt::Simulation sim{block(grains), silt::Contacts<HertzMindlin>{rubber}, policies...};
  sim.gravity = earth;
  sim.time_step = 1e-5;
  sim.threads = 1;
  return sim;
}
/// In a closed box.
template <class... Policies>
auto boxed(const Grains& grains, Policies... policies) {
  auto sim = loose(grains, policies...);
  const double s = grains.radius / 1e-3;
  sim.add_wall(silt::box({0, 0, 0}, {s * width, s * width, s * width}), rubber);
  return sim;
}

auto water() {
  return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{},
                           silt::FlowSolver(silt::Grid({{0, 0, 0}, {width, width, width}},
                                                       {4, 4, 4}, {false, false, false}),
                                            {1000, 1e-3})};
}

/// Whether there is one warning alone, which has these words.
bool is_one(const Sentences& all, std::initializer_list<std::string> words) {
  if (all.size() != 1) {
    for (const auto& sentence : all) MESSAGE("there is: " << sentence);
    return false;
  }
  return has_words(all[0], words);
}
/// Whether there is none.
bool is_silent(const Sentences& all) {
  for (const auto& sentence : all) MESSAGE("a false alarm: " << sentence);
  return all.empty();
}

}  // namespace

// --- outlets --------------------------------------------------------------------------------

TEST_CASE("scene_warnings: particles outside of the flow's grid, but not along where it repeats") {
  const auto grains = [](const silt::Vec3d& shift, std::array<bool, 3> repeats) {
    silt::Particles<silt::Sphere> p;
    for (int k = 0; k < 4; ++k)
      p.add({.position = silt::Vec3d{0.01, 0.01, 0.002 + 0.004 * k} + shift,
             .radius = 1e-3,
             .density = 2500});
    silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {0.02, 0.02, 0.01}}, {4, 4, 4}, repeats),
                          {1000, 1e-3});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.5, 0.4}},
                         silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, std::move(flow)}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, sim.contacts().material(0));
    return sim;
  };
  CHECK(is_one(silt::scene_warnings(grains({0, 0, 0}, {})),
               {"1 of 4 particles lie outside of the flow's grid", "enlarge or move the grid"}));
  CHECK(is_one(silt::scene_warnings(grains({1, 0, 0}, {})), {"4 of 4 particles"}));
  CHECK(is_silent(silt::scene_warnings(grains({0, 0, -2e-3 * 2}, {true, true, true}))));
  CHECK(is_silent(silt::scene_warnings(grains({1, 0, 0}, {true, false, true}))));
}

TEST_CASE("scene_warnings: an outlet thinner than the way between two looks at it") {
  const auto with_outlet = [](double thick, auto... policies) {
    auto sim = loose({}, policies...);
    sim.add_outlet({{-1, -1, -0.01 - thick}, {1, 1, -0.01}});
    return scene_warnings(sim);
  };
  // Diameters are 2 mm: a quarter of that.
  CHECK(is_one(with_outlet(0.499e-3),
               {"outlet 0 from (-1, -1, -0.010499) to (1, 1, -0.01) m", "0.000499 m thick along z",
                "may move by 0.0005 m", "make it thicker"}));
  CHECK(is_silent(with_outlet(0.501e-3)));
  // A tenth of the skin that is set; none without lists, which look every step.
  CHECK(is_one(with_outlet(0.029e-3, silt::VerletList<>{.skin = 0.3e-3}), {"thick along z"}));
  CHECK(is_silent(with_outlet(0.031e-3, silt::VerletList<>{.skin = 0.3e-3})));
  CHECK(is_silent(with_outlet(1e-6, silt::BruteForce{})));
  // A flat scene: its outlets may be as flat.
  Particles<Sphere> flat;
  for (int k = 0; k < 20; ++k)
    flat.add({.position = {3e-3 * k, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(flat), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = earth;
  sim.add_outlet({{-1, -1e-6, -1}, {1, 1e-6, -0.5}});
  CHECK(is_silent(scene_warnings(sim)));
}

TEST_CASE("scene_warnings: particles pass through outlets that are warned of, and no others") {
  const auto passed = [](double thick) {
    Particles<Sphere> p;
    for (int k = 0; k < 100; ++k)
      p.add({.position = {3e-3 * (k % 10), 3e-3 * (k / 10), 1e-3 + 1e-5 * k},
             .radius = 1e-3,
             .density = 2500,
             .velocity = {0, 0, -0.02 * (1 + k)}});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
    sim.time_step = 1e-5;
    sim.threads = 1;
    sim.add_outlet({{-1, -1, -0.01 - thick}, {1, 1, -0.01}});
    const bool warned = !scene_warnings(sim).empty();
    sim.run(0.7);
    CHECK(sim.size() + sim.outlet(0).count == 100);
    return std::pair{warned, sim.size()};
  };
  const auto thin = passed(1e-5);
  CHECK(thin.first);
  CHECK(thin.second > 10);
  const auto thick = passed(0.53e-3);  // a quarter of a diameter, and a step of the fastest
  CHECK_FALSE(thick.first);
  CHECK(thick.second == 0);
}

TEST_CASE("scene_warnings: an outlet behind walls, but for what may be a lid") {
  const Box below{{-1, -1, -1}, {1, 1, -0.01}}, aside{{0.03, 0, 0}, {0.04, 0.02, 0.02}};
  const Plane floor{{0, 0, 0}, {0, 0, 1}};
  for (const Box& outlet : {below, aside}) {
    auto sim = boxed({});
    sim.add_outlet({{0, 0, 0.01}, {1, 1, 1}});  // half of it is inside
    CHECK(is_silent(scene_warnings(sim)));
    sim.add_outlet(outlet);
    CHECK(is_one(scene_warnings(sim), {"outlet 1 from", "is behind wall 0,",
                                       "no particle can reach it", "move it to the side"}));
    sim.remove_wall(0);
    CHECK(is_silent(scene_warnings(sim)));
  }
  // The floor alone.
  auto on_floor = loose({});
  on_floor.add_outlet(below);
  CHECK(is_silent(scene_warnings(on_floor)));
  on_floor.add_wall(floor, rubber);
  CHECK(is_one(scene_warnings(on_floor), {"is behind wall 0,"}));
  // A tube with a lid, which is there to be removed: the outlet waits below.
  on_floor.add_wall(silt::Cylinder{{0.01, 0.01, 0}, {0.01, 0.01, 1}, 0.02, Side::Inside}, rubber);
  CHECK(is_silent(scene_warnings(on_floor)));
  // Behind a lid and a floor: with either gone, the other is still there.
  on_floor.add_wall(Plane{{0, 0, -5e-3}, {0, 0, 1}}, rubber);
  CHECK(is_one(scene_warnings(on_floor), {"is behind wall 0 and wall 2,"}));
  // A mould on a table that is no plane, with an outlet for what rolls off.
  auto mould = boxed({});
  mould.add_wall(silt::TriangleMesh(boundary_test::box_soup({-0.1, -0.1, -0.02}, {0.1, 0.1, 0})),
                 rubber);
  mould.add_outlet({{-1, -1, -2}, {1, 1, -1}});
  CHECK(is_silent(scene_warnings(mould)));
  // The lid of a column between faces that repeat.
  const silt::PeriodicBox column{{{0, 0, -1}, {width, width, 1}}, {true, true, false}};
  auto lid = loose({}, column);
  lid.add_wall(floor, rubber);
  lid.add_outlet({{0, 0, -1}, {width, width, -0.01}});
  CHECK(is_silent(scene_warnings(lid)));
  // What moves may move away.
  auto shaken = loose({});
  shaken.add_wall(floor, rubber, silt::translation({0, 0, -1}));
  shaken.add_outlet(below);
  CHECK(is_silent(scene_warnings(shaken)));
  // Without bounds in some directions.
  constexpr double far = std::numeric_limits<double>::infinity();
  auto endless = boxed({});
  endless.add_outlet({{-far, -far, -far}, {far, far, -0.01}});
  CHECK(is_one(scene_warnings(endless), {"is behind wall 0,"}));
  auto free = boxed({});
  free.add_outlet({{-far, -far, 0.01}, {far, far, far}});
  CHECK(is_silent(scene_warnings(free)));
}

TEST_CASE("scene_warnings: an outlet outside of a box that repeats, and of guard.domain") {
  const silt::PeriodicBox box{{{0, 0, 0}, {width, width, width}}, {true, false, false}};
  const auto at = [&box](const Box& region) {
    auto sim = loose({}, box);
    sim.add_outlet(region);
    return scene_warnings(sim);
  };
  CHECK(is_one(at({{width + 2.1e-3, 0, 0}, {1, 1, 1}}),
               {"outlet 0", "outside the periodic box", "along x from 0 to 0.02 m"}));
  CHECK(is_one(at({{-1, 0, 0}, {-2.1e-3, 1, 1}}), {"outside the periodic box"}));
  CHECK(is_silent(at({{width, 0, 0}, {1, 1, 1}})));  // reached before the next search
  CHECK(is_silent(at({{0, 0, -1}, {1, 1, -0.5}})));  // z does not repeat

  const auto guarded = [](double top) {
    auto sim = loose({});
    sim.guard.domain = Box{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
    sim.add_outlet({{-1, -1, -1}, {1, 1, top}});
    return scene_warnings(sim);
  };
  CHECK(is_one(guarded(-0.103), {"outlet 0", "outside guard.domain", "enlarge guard.domain"}));
  CHECK(is_silent(guarded(-0.1)));
  CHECK(is_silent(guarded(0)));
}

TEST_CASE("scene_warnings: an outlet far away from everything, where nothing falls to") {
  const auto at = [](const Box& region, double speed = 0, int count = 64) {
    auto sim = loose({.count = count, .velocity = {speed, 0, 0}});
    sim.add_wall(silt::Cylinder{{0.01, 0.01, 0}, {0.01, 0.01, 0.02}, 0.02, Side::Inside}, rubber);
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    sim.add_outlet(region);
    return scene_warnings(sim);
  };
  // 40 x 40 x 20 mm: a size of 60 mm.
  CHECK(is_one(at({{10, 0, 10}, {11, 1, 11}}),
               {"outlet 0", "14.1 m away", "size is 0.06 m", "positions in m"}));
  CHECK(is_silent(at({{4, 0, 4}, {11, 1, 11}})));
  CHECK(is_silent(at({{10, 0, 10}, {11, 1, 11}}, 1)));  // it may be thrown by some 0.1 m
  CHECK(is_silent(at({{10, 0, -1}, {11, 1, 0}})));      // it may roll off and fall
  CHECK(is_silent(at({{10, 0, 10}, {11, 1, 11}}, 0, 9)));
}

// --- gravity --------------------------------------------------------------------------------

TEST_CASE("scene_warnings: gravity without walls") {
  CHECK(
      is_one(scene_warnings(loose({})), {"no walls: 64 particles fall freely",
                                         "gravity = (0, 0, -9.81) [m/s2]", "add_wall", "outlet"}));
  CHECK(is_one(scene_warnings(loose({.count = 10})), {"10 particles fall freely"}));
  CHECK(is_silent(scene_warnings(loose({.count = 9}))));
  CHECK(is_silent(scene_warnings(loose({.fixed = true}))));
  CHECK(is_silent(scene_warnings(loose({}, water()))));
  auto still = loose({});
  still.gravity = {0, 0, 0};
  CHECK(is_silent(scene_warnings(still)));
  auto drained = loose({});
  drained.add_outlet({{-1, -1, -1}, {1, 1, -0.5}});
  CHECK(is_silent(scene_warnings(drained)));
  auto opened = boxed({});
  opened.remove_wall(0);
  CHECK(is_silent(scene_warnings(opened)));
  auto stream = loose({.count = 0});
  stream.add_inlet(Box{{0, 0, 0}, {0.01, 0.01, 0.01}},
                   {.radius = 1e-3, .density = 2500, .rate = 1000, .velocity = {0, 0, -1}});
  CHECK(is_silent(scene_warnings(stream)));
  const auto repeating = [](std::array<bool, 3> where) {
    return scene_warnings(loose({}, silt::PeriodicBox{{{0, 0, 0}, {width, width, width}}, where}));
  };
  CHECK(is_silent(repeating({true, true, true})));
  CHECK(is_one(repeating({true, true, false}), {"no walls"}));
}

TEST_CASE("scene_warnings: gravity that has no wall in its way") {
  const silt::Cylinder tube{{0.01, 0.01, 0}, {0.01, 0.01, 0.05}, 0.02, Side::Inside};
  const silt::Plane floor{{0, 0, 0}, {0, 0, 1}};
  const auto in_tube = [&](const Vec3d& gravity, int count = 64) {
    auto sim = loose({.count = count});
    sim.gravity = gravity;
    sim.add_wall(tube, rubber), sim.add_wall(floor, rubber);
    return scene_warnings(sim);
  };
  CHECK(is_one(in_tube({0, 0, 9.81}), {"gravity = (0, 0, 9.81) [m/s2] has no wall in its way",
                                       "64 particles", "reverse its sign"}));
  CHECK(is_one(in_tube({0, 0, 1.62}), {"has no wall in its way"}));
  CHECK(is_silent(in_tube({0, 0, 9.81}, 9)));
  CHECK(is_silent(in_tube({0, 0, -9.81})));
  CHECK(is_silent(in_tube({3, 0, 9})));  // onto the tube, which it may not leave
  CHECK(is_silent(in_tube({0, 0, 0})));

  // A floor above which particles hang by their adhesion.
  const auto hangs = [&](auto law, const auto& material) {
    silt::Simulation sim{block({}), silt::Contacts<decltype(law)>{material}};
    sim.gravity = {0, 0, 9.81};
    sim.add_wall(floor, material);
    return scene_warnings(sim);
  };
  CHECK(is_silent(hangs(silt::Jkr{}, silt::Jkr::Material{1e6, 0.3, 0.5, 0.5, 1.0})));
  using Sticky = silt::Cohesive<HertzMindlin, silt::Dmt>;
  CHECK(is_silent(hangs(Sticky{}, Sticky::Material{rubber, {1.0}})));
  CHECK(is_one(hangs(HertzMindlin{}, rubber), {"has no wall in its way"}));

  auto pipe = loose({}, silt::PeriodicBox{{{0, 0, 0}, {1, 1, 0.05}}, {false, false, true}});
  pipe.add_wall(tube, rubber);
  CHECK(is_silent(scene_warnings(pipe)));
  auto turned = loose({});
  turned.gravity = {0, 0, 9.81};
  turned.add_wall(floor, rubber, silt::rotation({0, 0, 0}, {1, 0, 0}, 10));
  CHECK(is_silent(scene_warnings(turned)));
}

TEST_CASE("scene_warnings: what may hold particles against gravity") {
  const auto holds = [](const silt::Surfaces& surfaces, const Vec3d& gravity = earth) {
    auto sim = loose({});
    sim.gravity = gravity;
    sim.add_wall(surfaces, rubber);
    return scene_warnings(sim).empty();
  };
  const Vec3d low{0.01, 0.01, -0.01}, high{0.01, 0.01, 0.05}, up{0, 0, 9.81};
  CHECK(holds(Plane{low, {0, 0, 1}}));
  CHECK(holds(Plane{low, {1, 0, 0.1}}));
  CHECK_FALSE(holds(Plane{{0, 0, 0}, {1, 0, 0}}));
  CHECK_FALSE(holds(Plane{high, {0, 0, -1}}));
  CHECK_FALSE(holds(silt::Cylinder{low, high, 0.02, Side::Inside}));
  CHECK(holds(silt::Cylinder{{0, 0.01, 0}, {0.02, 0.01, 0}, 0.02, Side::Inside}));
  CHECK(holds(silt::Cylinder{low, high + Vec3d{1e-3, 0, 0}, 0.02, Side::Inside}));
  // A hopper narrows downwards; what is outside of a cone lies on it if its tip is above.
  CHECK(holds(silt::Cone{low, high, 5e-3, 0.03, Side::Inside}));
  CHECK(holds(silt::Cone{high, low, 0.03, 5e-3, Side::Inside}));
  CHECK_FALSE(holds(silt::Cone{low, high, 0.03, 5e-3, Side::Inside}));
  CHECK_FALSE(holds(silt::Cone{low, high, 5e-3, 0.03, Side::Inside}, up));
  const Vec3d deep{0.01, 0.01, -0.05};
  CHECK(holds(silt::Cone{deep, low, 5e-3, 0, Side::Outside}));
  CHECK_FALSE(holds(silt::Cone{deep, low, 0, 5e-3, Side::Outside}));
  CHECK_FALSE(holds(silt::Cone{{0.01, 0.01, 0.03}, high, 0.03, 5e-3, Side::Outside}));  // above
  const silt::Surfaces plate =
      silt::TriangleMesh(boundary_test::box_soup({-0.1, -0.1, -0.02}, {0.1, 0.1, -0.01}));
  CHECK(holds(plate));
  CHECK_FALSE(holds(plate, up));
}

TEST_CASE("scene_warnings: gravity upwards in a closed box") {
  auto sim = boxed({});
  CHECK(is_silent(scene_warnings(sim)));
  const auto under = [&sim](const Vec3d& gravity) {
    sim.gravity = gravity;
    return scene_warnings(sim);
  };
  CHECK(is_one(under({0, 0, 9.81}), {"gravity = (0, 0, 9.81) [m/s2] pulls particles up",
                                     "the floor at z = 0 m (wall 0)", "a negative z"}));
  CHECK(is_silent(under({0, 0, 1})));     // of no scale
  CHECK(is_silent(under({9.81, 0, 0})));  // along a duct
  CHECK(is_silent(under({0, 9.81, 0})));
  CHECK(is_silent(under({0, 6.9, 6.9})));
  // z points down in a scene that has its floor there, and no other.
  auto down = loose({});
  down.gravity = {0, 0, 9.81};
  down.add_wall(Plane{{0, 0, 0.05}, {0, 0, -1}}, rubber);
  CHECK(is_silent(scene_warnings(down)));
  // A box that is turned over after a while.
  sim.gravity = earth;
  sim.run(1e-4);
  CHECK(is_silent(under({0, 0, 9.81})));
}

TEST_CASE("scene_warnings: gravity in mm/s2, but not that of centrifuges") {
  auto sim = boxed({});
  const auto under = [&sim](double g) {
    sim.gravity = {0, 0, -g};
    return scene_warnings(sim);
  };
  for (const double g : {9810.0, 9800.0, 9806.65, 10000.0})
    CHECK(is_one(under(g), {"gravity = (0, 0, -", "the earth's in mm/s2", "9.81"}));
  for (const double g : {0.0, 1e-3, 1.62, 3.71, 9.81, 24.8, 274.0, 981.0, 4905.0, 9600.0, 10200.0})
    CHECK(is_silent(under(g)));
}

// --- units ----------------------------------------------------------------------------------

TEST_CASE("scene_warnings: densities in g/cm3") {
  const auto of = [](double density, const Vec3d& gravity = earth) {
    auto sim = boxed({.density = density});
    sim.gravity = gravity;
    return scene_warnings(sim);
  };
  for (const double density : {2.5e-9, 2.5e-6, 1.0, 2.5, 7.85, 9.99})
    CHECK(is_one(of(density), {"the densest particle has ", "less than any solid", "in kg/m3",
                               "1 g/cm3 is 1000 kg/m3"}));
  CHECK(is_one(of(2.5), {"has 2.5 kg/m3"}));
  for (const double density : {10.1, 15.0, 100.0, 2500.0, 7850.0, 19300.0, 2.5e6})
    CHECK(is_silent(of(density)));  // the last to stretch time steps
  CHECK(is_silent(of(1, {0, 0, 0})));
  CHECK(is_silent(of(1, {0, 0, -1})));  // reduced units
  CHECK(is_silent(of(2.5, {0, 0, -1.62})));
  // Among heavier ones it may be meant.
  auto mixed = boxed({.density = 2.5});
  Particles<Sphere> steel;
  steel.add({.position = {0.018, 0.018, 0.018}, .radius = 1e-3, .density = 7850});
  mixed.add(steel);
  CHECK(is_silent(scene_warnings(mixed)));
  // Bubbles.
  const auto in_water = [](double density) {
    auto sim = loose({.radius = 0.5e-3, .density = density}, water());
    return scene_warnings(sim);
  };
  CHECK(is_silent(in_water(1)));
  CHECK(is_silent(in_water(0.08)));
  CHECK(is_one(in_water(2.5e-6), {"less than any gas"}));
  // What inlets will bring, and bodies.
  auto stream = boxed({.count = 0});
  CHECK(is_silent(scene_warnings(stream)));
  stream.add_inlet(Box{{0, 0, 0}, {0.01, 0.01, 0.01}},
                   {.radius = 1e-3, .density = 2.5, .rate = 1000});
  CHECK(is_one(scene_warnings(stream), {"has 2.5 kg/m3"}));
  const auto stones = [](double density) {
    Particles<silt::MultiSphere> pairs;
    pairs.add_form(silt::MultiSphere{{{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}});
    for (int k = 0; k < 12; ++k)
      pairs.add(
          {.position = {0.005, 0.005 + 6e-3 * k, 0.005}, .radius = 2.5e-3, .density = density});
    silt::Simulation sim{pairs, silt::Contacts<HertzMindlin>{rubber}};
    sim.gravity = earth;
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    return scene_warnings(sim);
  };
  CHECK(is_one(stones(2.5), {"has 2.5 kg/m3"}));
  CHECK(is_silent(stones(2500)));
}

TEST_CASE("scene_warnings: lengths in mm") {
  const auto of = [](const Grains& grains, const Vec3d& gravity = earth) {
    auto sim = boxed(grains);
    sim.gravity = gravity;
    return scene_warnings(sim);
  };
  CHECK(is_one(of({.radius = 1}), {"the smallest particle is 2 m across", "1 mm is 0.001 m"}));
  CHECK(is_one(of({.radius = 2.5}), {"is 5 m across"}));
  for (const double radius : {5e-7, 5e-6, 1e-3, 0.5, 0.9}) CHECK(is_silent(of({.radius = radius})));
  CHECK(is_silent(of({.radius = 1, .count = 9})));  // single boulders
  CHECK(is_silent(of({.radius = 1}, {0, 0, 0})));   // asteroids
  CHECK(is_silent(of({.radius = 1}, {0, 0, -1})));  // reduced units
  auto sizes = boxed({.radius = 1});
  Particles<Sphere> small;
  small.add({.position = {18, 18, 18}, .radius = 0.9, .density = 2500});
  sizes.add(small);
  CHECK(is_silent(scene_warnings(sizes)));
}

// --- inlets ---------------------------------------------------------------------------------

TEST_CASE("scene_warnings: temperatures in degrees Celsius, of particles and walls") {
  const auto of = [](double particles, double floor, const Vec3d& gravity = earth) {
    auto sim = boxed({}, silt::HeatConduction{.conductivity = 1,
                                              .heat_capacity = 800,
                                              .start_temperature = particles,
                                              .walls = {{0, silt::held_at(floor)}}});
    sim.gravity = gravity;
    return scene_warnings(sim);
  };
  CHECK(is_one(of(20, 300), {"the coldest particle has 20 K", "in K: 20 C is 293.15 K"}));
  CHECK(is_one(of(300, 80), {"wall 0", "has 80 K", "80 C is 353.15 K"}));
  CHECK(of(20, 80).size() == 2);
  CHECK(is_silent(of(293.15, 100)));
  CHECK(is_silent(of(110, 2000)));
  CHECK(is_silent(of(1, 2, {0, 0, -1})));  // reduced units
  CHECK(is_silent(of(1, 2, {0, 0, 0})));
}

TEST_CASE("inlet_warnings: what an inlet could not place, unless it catches up") {
  const auto after = [](double rate, double speed, double duration) {
    auto sim = loose({.count = 0});
    sim.add_inlet(Box{{0, 0, 0}, {0.01, 0.01, 5e-3}}, {.radius = 1e-3,
                                                       .density = 2500,
                                                       .rate = rate,
                                                       .velocity = {0, 0, -speed},
                                                       .interval = 2e-3});
    CHECK(is_silent(inlet_warnings(sim)));
    sim.run(duration);
    return std::pair{inlet_warnings(sim), sim.inlet(0)};
  };
  const auto [crowd, crowded] = after(1e5, 0, 0.01);
  CHECK(crowded.placed < 50);
  CHECK(is_one(crowd, {silt::text("inlet 0 has placed ", crowded.placed, " of the ",
                                  crowded.placed + crowded.waiting, " particles that were due"),
                       "200 random places in a row were occupied", "the box from (0, 0, 0)",
                       "lower the rate, enlarge the region"}));
  CHECK(crowded.placed + crowded.waiting > 900);
  CHECK(is_silent(after(1000, 2, 0.1).first));
  // Late, but by less than comes at one insertion.
  const auto [late, inlet] = after(8000, 1, 0.011);
  CHECK(static_cast<double>(inlet.waiting) <= 1 + 8000 * 2e-3);
  CHECK(inlet.waiting > 0.15 * static_cast<double>(inlet.placed));
  CHECK(is_silent(late));
  // Behind a wall nothing finds a place: that is said in place of the crowd.
  auto behind = loose({.count = 0});
  behind.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), rubber, {.name = "box"});
  behind.add_inlet(Box{{5e-3, 5e-3, 0.06}, {0.015, 0.015, 0.07}},
                   {.radius = 1e-3, .density = 2500, .rate = 1000, .velocity = {0, 0, -1}});
  behind.run(0.05);
  CHECK(is_one(inlet_warnings(behind),
               {"inlet 0 has placed none of the", "is behind wall 0 'box'", "move it"}));
}

// An inlet that is far too fast for its region, in a run of two insertions. Catches a delay of "one
// insertion" that cannot be made up.
TEST_CASE("inlet_warnings: an inlet far beyond what its region takes, in a short run") {
  auto sim = loose({.count = 0});
  sim.add_inlet(Box{{0, 0, 0.08}, {0.02, 0.02, 0.09}},
                {.radius = 1e-3, .density = 2500, .rate = 1e6});
  sim.run(0.02);
  CHECK(sim.inlet(0).insertions == 2);
  CHECK(is_one(inlet_warnings(sim), {"inlet 0 has placed", "particles that were due"}));
}

// --- single settings ------------------------------------------------------------------------

// Catches moduli in GPa, and ones with too many zeros.
TEST_CASE("scene_warnings: a material softer than gels or stiffer than diamond") {
  const auto of = [](double modulus) {
    auto m = rubber;
    m.youngs_modulus = modulus;
    silt::Simulation sim{block({}), silt::Contacts<HertzMindlin>{m}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::box({0, 0, 0}, {width, width, width}), m);
    return scene_warnings(sim);
  };
  CHECK(is_one(of(210), {"youngs_modulus = 210 Pa of material 0", "of a gel", "1 GPa is 1e9 Pa"}));
  CHECK(is_one(of(7e19), {"more than that of diamond"}));
  for (const double usual : {1e3, 1e5, 2.1e11, 1.2e12}) CHECK(of(usual).empty());
}

// Catches a friction in per cent, which every law accepts.
TEST_CASE("scene_warnings: friction in per cent, of a material, of a pair, and below a cohesion") {
  const auto rough = [](double friction) {
    HertzMindlin::Material m = rubber;
    m.friction = friction;
    return m;
  };
  const auto of = [&](double friction) {
    silt::Simulation sim{block({}), silt::Contacts<HertzMindlin>{rough(friction)}};
    sim.gravity = earth, sim.threads = 1;
    sim.add_wall(silt::box({0, 0, 0}, {width, width, width}), rough(friction));
    return scene_warnings(sim);
  };
  CHECK(is_one(of(40), {"friction = 40 [-] between material 0 and itself", "per cent", "0.4"}));
  CHECK(is_silent(of(2.5)));
  auto pairs = boxed({});
  pairs.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, rough(0.1));
  pairs.set_pair(0, 1, {.restitution = 0.5, .friction = 30});
  CHECK(is_one(scene_warnings(pairs), {"friction = 30 [-] between material 0 and material 1"}));
  using Wet = silt::Cohesive<HertzMindlin, silt::Dmt>;
  silt::Simulation sticky{block({}), silt::Contacts<Wet>{{rough(40), {}}}};
  sticky.gravity = earth;
  sticky.add_wall(silt::box({0, 0, 0}, {width, width, width}), sticky.contacts().material(0));
  CHECK(is_one(scene_warnings(sticky), {"friction = 40"}));
}

// Catches rolling friction in per cent: with 30 the run stops, with advice about its step.
TEST_CASE("scene_warnings: rolling friction in per cent, alone and with twisting") {
  const auto of = [](auto contacts) {
    silt::Simulation sim{block({}), contacts};
    sim.gravity = earth, sim.threads = 1;
    sim.add_wall(silt::box({0, 0, 0}, {width, width, width}), rubber);
    return scene_warnings(sim);
  };
  using Rolls = silt::Contacts<HertzMindlin, silt::RollingEpsd>;
  CHECK(is_one(of(Rolls{rubber, {.rolling_friction = 30}}),
               {"rolling_friction = 30 [-] between material 0 and itself", "give 0.3"}));
  CHECK(is_silent(of(Rolls{rubber, {.rolling_friction = 1}})));
  using Twists = silt::Both<silt::RollingDirectional, silt::Twisting>;
  CHECK(is_one(of(silt::Contacts<HertzMindlin, Twists>{
                   rubber, {{.rolling_friction = 5}, {.twisting_friction = 0.4}}}),
               {"rolling_friction = 5"}));
}

// Catches a surface velocity along the normal, which does nothing.
TEST_CASE("scene_warnings: a surface velocity along the normal of a plane") {
  const auto with_belt = [](const Vec3d& velocity, const Vec3d& rate) {
    auto sim = boxed({});
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 2}}, rubber,
                 {.name = "belt", .surface_velocity = {.velocity = velocity, .rate = rate}});
    return scene_warnings(sim);
  };
  CHECK(is_one(with_belt({0, 0, 0.5}, {0, 0, 0}), {"surface_velocity = (0, 0, 0.5) [m/s] of wall",
                                                   "'belt'", "translation(velocity)"}));
  CHECK(is_silent(with_belt({0.1, 0, 0.5}, {0, 0, 0})));
  CHECK(is_silent(with_belt({0, 0, 0.5}, {0, 0, 1})));  // a turntable
  CHECK(is_silent(with_belt({0, 0, 0}, {0, 0, 0})));
}

// Catches an inlet whose particles are removed at once, and a centre of mass that was left out.
TEST_CASE("scene_warnings: an inlet in an outlet, a free wall far from its centre of mass") {
  const auto with = [](double top) {
    auto sim = loose({.count = 0});
    sim.add_inlet(Box{{0.001, 0.001, 0.03}, {0.019, 0.019, 0.035}},
                  {.radius = 1e-3, .density = 2500, .rate = 100, .velocity = {0, 0, -0.1}});
    sim.add_outlet({{-1, -1, 0.025}, {1, 1, top}});
    return scene_warnings(sim);
  };
  CHECK(is_one(with(0.04), {"inlet 0 from", "lies in outlet 0", "move one of them"}));
  CHECK(is_silent(with(0.033)));
  const auto free_wall = [](const Vec3d& at) {
    auto sim = boxed({});
    const auto mesh = silt::box_mesh({0.5, 0.5, 0.5}, {0.52, 0.52, 0.52});
    silt::FreeBody body = silt::free_body(mesh, 2000);
    body.centre = at;
    sim.add_wall(mesh, rubber, {.name = "box", .drive = body});
    return scene_warnings(sim);
  };
  CHECK(is_one(free_wall({0, 0, 0}),
               {"FreeBody.centre = (0, 0, 0) [m] of wall", "'box'", "outside of its surfaces"}));
  CHECK(is_silent(free_wall({0.5, 0.5, 0.55})));
}

// Catches a mesh in mm that is read as if it were in m: a floor 1000 times as wide as the bed.
TEST_CASE("scene_warnings: a mesh a thousand times as large as all particles") {
  const auto on_floor = [](double side, int count) {
    auto sim = loose({.count = count});
    sim.add_wall(silt::rectangle({0, 0, 0}, {side, 0, 0}, {0, side, 0}), rubber, {.name = "floor"});
    return scene_warnings(sim);
  };
  CHECK(is_one(on_floor(20, 64), {"the mesh of wall 0 'floor' measures 28.3 m", "times the 0.02",
                                  "mesh_wall(file, 1e-3)"}));
  CHECK(is_silent(on_floor(2, 64)));
  CHECK(is_silent(on_floor(20, 1)));  // a single ball on a wide floor
}

// Catches an outlet that is put around the bed in place of beside it.
TEST_CASE("scene_warnings: an outlet around the particles that are there") {
  const auto with_outlet = [](double low, bool later) {
    auto sim = boxed({});
    if (later) sim.run(1e-4);
    sim.add_outlet({{-1, -1, low}, {1, 1, 1}});
    auto told = scene_warnings(sim);
    sim.run(1e-4);
    CHECK(is_silent(scene_warnings(sim)));  // what has left is no longer there
    return told;
  };
  CHECK(is_one(with_outlet(-1, false), {"outlet 0", "contains 64 of 64 particles", "first step"}));
  CHECK(is_one(with_outlet(0.005, false), {"contains 48 of 64 particles"}));
  CHECK(is_silent(with_outlet(0.012, false)));  // the uppermost layer alone
  CHECK(is_silent(with_outlet(0.005, true)));   // a bed that is cut off
  CHECK(is_one(with_outlet(-1, true), {"contains 64 of 64"}));
}

// Catches the jump of a wall that is added late, with a motion that counts from time 0.
TEST_CASE("scene_warnings: a wall added in a later run, which its motion has already moved") {
  const auto late = [](double after, auto motion) {
    auto sim = boxed({});
    if (after > 0) sim.run(after);
    sim.add_wall(Plane{{0, 0, 0.019}, {0, 0, -1}}, rubber,
                 {.name = "press", .motion = motion(sim.time())});
    auto told = scene_warnings(sim);
    sim.run(1e-4);
    CHECK(is_silent(scene_warnings(sim)));
    return told;
  };
  const auto down = silt::translation({0, 0, -0.05});
  CHECK(is_one(late(1e-3, [&](double) { return down; }),
               {"'press' was added at 0.001", "already moved it by", "from(sim.time(), motion)"}));
  CHECK(is_silent(late(0, [&](double) { return down; })));
  CHECK(is_silent(late(1e-3, [&](double now) { return silt::from(now, down); })));
  CHECK(is_silent(late(1e-3, [](double) {
    return silt::Motion(silt::rotation({0, 0, 0}, {0, 0, 1}, 5));
  })));
  CHECK(is_silent(late(1e-3, [](double) { return silt::Motion(); })));
}

// --- observers ------------------------------------------------------------------------------

namespace {

/// What progress writes to a file.
template <class Run>
std::string written(const Run& run) {
  std::FILE* file = std::tmpfile();
  REQUIRE(file != nullptr);
  run(file);
  std::string all(static_cast<std::size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  CHECK(std::fread(all.data(), 1, all.size(), file) == all.size());
  std::fclose(file);
  return all;
}
std::size_t count_of(const std::string& word, const std::string& content) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = content.find(word, at)) != std::string::npos; ++at) ++count;
  return count;
}
/// Without walls, and with an inlet that falls short.
auto slips() {
  auto sim = loose({});
  sim.add_inlet(Box{{0, 0, 0.1}, {0.01, 0.01, 0.105}},
                {.radius = 1e-3, .density = 2500, .rate = 1e5, .interval = 1e-3});
  return sim;
}

}  // namespace

TEST_CASE("progress: a line for each warning, the scene's first and the inlets' last") {
  const auto all = written([](std::FILE* file) {
    auto sim = slips();
    sim.run(5e-3, silt::progress(file));
  });
  CHECK(all.starts_with("warning: no walls: 64 particles"));
  CHECK(count_of("\n", all) == 3);
  CHECK(count_of("\nwarning: inlet 0 has placed", all) == 1);
  CHECK(all.find("done in") < all.find("inlet 0"));
  CHECK(all.back() == '\n');
}

TEST_CASE("progress: warnings can be switched off, and a sound scene has none") {
  const auto off = written([](std::FILE* file) {
    auto sim = slips();
    sim.run(5e-3, silt::progress({.out = file, .warnings = false}));
  });
  CHECK(count_of("warning", off) == 0);
  CHECK(count_of("done in", off) == 1);
  const auto sound = written([](std::FILE* file) {
    auto sim = boxed({});
    sim.run(1e-3, silt::progress({.out = file}));
  });
  CHECK(count_of("warning", sound) == 0);
}

TEST_CASE("progress: one that watches several runs says the same once, and what is new") {
  const auto all = written([](std::FILE* file) {
    auto sim = loose({});
    auto shown = silt::progress(file);
    sim.run(1e-4, shown);
    sim.run(1e-4, shown);
    sim.add_outlet({{-1, -1, -1}, {1, 1, -1 + 1e-6}});
    sim.run(1e-4, shown);
  });
  CHECK(count_of("warning: no walls", all) == 1);
  CHECK(count_of("warning: outlet 0", all) == 1);
  CHECK(count_of("warning", all) == 2);
}

TEST_CASE("on_warnings: gets every sentence, and may end the run before its first step") {
  Sentences got;
  auto sim = slips();
  sim.run(5e-3,
          silt::on_warnings([&got](const std::string& sentence) { got.push_back(sentence); }));
  REQUIRE(got.size() == 2);
  CHECK(has_words(got[0], {"no walls"}));
  CHECK(has_words(got[1], {"inlet 0"}));

  auto strict = slips();
  CHECK_THROWS_AS(strict.run(1, silt::on_warnings([](const std::string& sentence) {
                               throw std::runtime_error(sentence);
                             })),
                  std::runtime_error);
  CHECK(strict.step() == 0);
  auto sound = boxed({});
  sound.run(1e-3, silt::on_warnings([](const std::string& sentence) { FAIL(sentence); }));
  CHECK(sound.step() == 100);
}

TEST_CASE("on_warnings: a run that is watched has the bits of one that is not") {
  auto watched = slips(), alone = slips();
  watched.run(2e-3, silt::on_warnings([](const std::string&) {}));
  alone.run(2e-3);
  CHECK(bits(watched) == bits(alone));
}

namespace {

/// Two spheres of 1 mm, numbers 1 and 2, whose overlap is `share` of the radius, and one apart.
template <class... Policies>
auto overlapping(double share, Policies... policies) {
  Particles<Sphere> p;
  p.add({.position = {0, 0, 0.02}, .radius = 1e-3, .density = 2500});
  p.add({.position = {0, 0, 5e-3}, .radius = 1e-3, .density = 2500});
  p.add({.position = {2e-3 - share * 1e-3, 0, 5e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, policies...};
  sim.time_step = 1e-6;
  sim.threads = 1;
  return sim;
}
template <class Sim>
Sentences warned_in(Sim& sim, double duration) {
  Sentences got;
  sim.run(duration,
          silt::on_warnings([&](const std::string& sentence) { got.push_back(sentence); }));
  return got;
}

}  // namespace

TEST_CASE("overlap_warnings: particles that start deep in each other or in a wall") {
  auto deep = overlapping(0.2);
  CHECK(overlap_warnings(deep).empty());  // before its first step
  CHECK(is_one(warned_in(deep, 1e-4),
               {"1 contact overlaps by more than 5 % of the smaller radius at the start, at most "
                "by 20 % (particles 1 and 2); they will be pushed apart"}));
  CHECK(is_silent(warned_in(deep, 1e-5)));
  auto in_wall = overlapping(0.049);
  in_wall.add_wall(Plane{{0, 0, 4.1e-3}, {0, 0, 1}}, rubber, {.name = "floor"});
  CHECK(is_one(warned_in(in_wall, 0), {"2 contacts overlap by more than 5 %",
                                       "at most by 10 % (particle 1 and wall 0 "
                                       "'floor')"}));
}

TEST_CASE("overlap_warnings: silent on slight overlaps, bonds, edits and restarts") {
  auto slight = overlapping(0.049);
  CHECK(is_silent(warned_in(slight, 1e-5)));
  // What is added later, and a run that continues.
  Particles<Sphere> more;
  more.add({.position = {0.2e-3, 0, 0.0217}, .radius = 1e-3, .density = 2500});
  slight.add(more);
  CHECK(is_silent(warned_in(slight, 1e-5)));
  const auto file = std::filesystem::temp_directory_path() / "silt_overlap_warnings.silt";
  auto deep = overlapping(0.2), again = overlapping(0.2);
  deep.run(1e-6);
  silt::save_checkpoint(deep, file.string());
  silt::load_checkpoint(again, file.string());
  std::filesystem::remove(file);
  CHECK(is_silent(warned_in(again, 1e-5)));
  CHECK(again.peak_overlap() > 0.19);
  // A bonded pair has no contact.
  auto bonded = overlapping(0.2, silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e7}});
  bonded.bond(1, 2);
  CHECK(is_silent(warned_in(bonded, 1e-5)));
}

}  // namespace scene_warnings_test
