// silt - BSD-3-Clause, see LICENSE
// A run that goes on with something changed: each change of docs/restart.md works, and what comes
// after it is what it should be.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <engine/support.hpp>

#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>

#include "near.hpp"

namespace restart_changes_test {

namespace {

using namespace engine_test;
using silt::AcceptedChanges;
using silt::InputError;
using silt::load_checkpoint;
namespace fs = std::filesystem;

const std::string path = (fs::temp_directory_path() / "silt_restart_changes.silt").string();

/// What restarts differ in.
struct Scene {
  HertzMindlin::Material grain = rubber;
  silt::Motion motion{};
  std::vector<silt::Surfaces> more_walls{};
  std::vector<silt::Box> outlets{};
  double rate = 0;  // [1/s] of an inlet; 0: none
  double g = 9.81;
  silt::Box box{{0, 0, 0}, {8e-3, 8e-3, 1}};
};
/// 64 grains of 1 mm radius that settle in a box.
auto built(const Scene& scene) {
  silt::Particles<Sphere> p;
  for (int k = 0; k < 64; ++k)
    p.add(
        {.position = {1e-3 + 2e-3 * (k % 4), 1e-3 + 2e-3 * (k / 4 % 4), 1e-3 + 2.01e-3 * (k / 16)},
         .radius = 0.99e-3,
         .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{scene.grain},
                       silt::VerletList<>{}, silt::EnergyLedger{}};
  sim.gravity = {0, 0, -scene.g};
  sim.threads = 1, sim.time_step = 1e-5;
  sim.add_wall(silt::box(scene.box.min, scene.box.max), scene.grain, scene.motion);
  for (const auto& wall : scene.more_walls) sim.add_wall(wall, rubber);
  for (const auto& outlet : scene.outlets) sim.add_outlet(outlet);
  if (scene.rate > 0)
    sim.add_inlet(silt::Box{{0, 0, 0.02}, {8e-3, 8e-3, 0.03}},
                  {.radius = 1e-3, .density = 2500, .rate = scene.rate, .velocity = {0, 0, -1}});
  return sim;
}
using Sim = decltype(built({}));

/// The bed, settled for 0.3 s, as a file.
const Sim& settled(const Scene& scene = {}) {
  static Sim sim = [&] {
    Sim made = built(scene);
    made.run(0.3);
    silt::save_checkpoint(made, path);
    return made;
  }();
  silt::save_checkpoint(sim, path);
  return sim;
}
Sim restarted(const Scene& scene = {}, const AcceptedChanges& accepted = {}) {
  Sim sim = built(scene);
  load_checkpoint(sim, path, accepted);
  return sim;
}
double weight(const Sim& sim) {
  double all = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) all += sim.mass(k);
  return 9.81 * all;
}
/// The mean force [N] of a wall on the particles upwards over the next 0.1 s: what is left of
/// swings of the bed, m v/0.1 s with 1 mm/s at most, is 0.1 % of its weight.
double mean_lift(Sim& sim, std::size_t wall = 0) {
  const double before = sim.wall(wall).impulse.z;
  sim.run(0.1);
  return (before - sim.wall(wall).impulse.z) / 0.1;
}
double kinetic(const Sim& sim) { return sim.energy().translation + sim.energy().rotation; }
double top(const Sim& sim) {
  double most = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) most = std::max(most, sim.position(k).z);
  return most;
}
Vec3d mean_velocity(const Sim& sim) {
  Vec3d sum{0, 0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += (1.0 / 64) * sim.velocity(k);
  return sum;
}

}  // namespace

TEST_CASE("restart: another gravity bears on the walls, and its change is in the books") {
  settled();
  Sim moon = restarted({.g = 1.62});
  const double before = restarted().energy().residual();
  moon.run(0.1);  // it swells by microns, and swings
  CHECK(mean_lift(moon) == near(weight(moon) * 1.62 / 9.81).epsilon(0.01));
  CHECK(std::abs(moon.energy().changed_gravity) > 0);
  CHECK(std::abs(moon.energy().residual() - before) <
        0.02 * std::abs(moon.energy().changed_gravity));
  Sim none = restarted({.g = 0});
  none.run(0.1);
  CHECK(std::abs(mean_lift(none)) < 0.01 * weight(none));
}

TEST_CASE("restart: another friction, where it is accepted: the bed slides on a tilted floor") {
  settled();
  auto smooth = rubber;
  smooth.friction = 0.02;
  CHECK(
      has_words(refusal<InputError>([&] { restarted({.grain = smooth}); }), {".materials = true"}));
  const auto slid = [](Sim sim) {
    sim.gravity = {9.81 * std::sin(0.3), 0, -9.81 * std::cos(0.3)};
    sim.remove_wall(0);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, sim.contacts().material(0));
    sim.run(0.05);
    return mean_velocity(sim).x;
  };
  // Free of side walls the block slides with little friction, and rolls with much, at 5/7 of it and
  // more, as it falls apart as well. Catches a friction that stays what it was.
  const double rough = slid(restarted()),
               slippery = slid(restarted({.grain = smooth}, {.materials = true}));
  const double frictionless = 9.81 * std::sin(0.3) * 0.05;
  CHECK(slippery > 0.9 * frictionless);
  CHECK(rough < 0.83 * frictionless);
}

TEST_CASE("restart: another motion of a wall, where it is accepted: the floor shakes the bed") {
  const Sim& sim = settled();
  const silt::Motion shaking = silt::vibration({0, 0, 0.5e-3}, 40);
  CHECK_THROWS_AS(restarted({.motion = shaking}), InputError);
  Sim shaken = restarted({.motion = shaking}, {.motions = true});
  CHECK(shaken.time() == sim.time());
  shaken.run(0.05);
  CHECK(shaken.wall(0).pose == shaken.wall(0).motion(shaken.time()));
  CHECK(kinetic(shaken) > 100 * kinetic(sim));
}

TEST_CASE("restart: further walls, of the scene or added after it: their contacts are found") {
  const Sim& sim = settled();
  const double z = top(sim) + 0.99e-3;
  // A lid that presses the top grains by 1 % of a radius.
  const silt::Surfaces lid = silt::Plane{{0, 0, z - 1e-5}, {0, 0, -1}};
  CHECK(has_words(refusal<InputError>([&] { restarted({.more_walls = {lid}}); }),
                  {"walls is 1 in the file and 2 in the scene", ".walls = true"}));
  Sim in_scene = restarted({.more_walls = {lid}}, {.walls = true}), after = restarted();
  CHECK(after.add_wall(lid, rubber) == 1);
  CHECK(in_scene.walls() == 2);
  for (Sim* pressed : {&in_scene, &after}) {
    pressed->run(0.02);
    const double lid_before = pressed->wall(1).impulse.z, floor = mean_lift(*pressed);
    const double on_lid = (pressed->wall(1).impulse.z - lid_before) / 0.1;
    CHECK(on_lid > 0.05 * weight(sim));
    CHECK(floor == near(weight(sim) + on_lid).epsilon(0.01));  // the floor bears both
  }
  CHECK(bits(in_scene) == bits(after));
  // Contacts with the walls of the file keep what they remember: nothing jumps at the sides.
  Sim far = restarted({.more_walls = {silt::Plane{{0, 0, 0.5}, {0, 0, -1}}}}, {.walls = true});
  Sim same = restarted();
  far.run(1e-3), same.run(1e-3);
  CHECK(norm(far.wall(0).force - same.wall(0).force) < 1e-3 * weight(far));
  CHECK(far.wall(1).force.z == 0);
  // The next restart has both, and is exact.
  silt::save_checkpoint(in_scene, path);
  Sim next = built({.more_walls = {lid}});
  load_checkpoint(next, path);
  next.run(1e-3), in_scene.run(1e-3);
  CHECK(bits(next) == bits(in_scene));
  // Other walls in their place, or fewer, are still refused.
  CHECK(has_words(refusal<InputError>([&] {
                    Sim fewer = built({});
                    load_checkpoint(fewer, path, {.walls = true});
                  }),
                  {"walls is 2 in the file and 1 in the scene"}));
  CHECK_THROWS_AS(
      {
        Sim other = built({.more_walls = {lid, lid}, .box = {{0, 0, 0}, {9e-3, 8e-3, 1}}});
        load_checkpoint(other, path, {.walls = true});
      },
      InputError);
}

TEST_CASE("restart: more particles, whose ids continue") {
  const Sim& sim = settled();
  Sim more = restarted();
  silt::Particles<Sphere> extra;
  const double z = top(sim) + 3e-3;
  for (int k = 0; k < 3; ++k)
    extra.add({.position = {1.5e-3 + 2.5e-3 * k, 4e-3, z}, .radius = 1e-3, .density = 2500});
  more.add(extra);
  CHECK(more.size() == 67);
  for (const silt::ParticleId id : {64, 65, 66}) CHECK(more.find(id) < more.rows());
  more.run(0.1);
  more.run(0.1);
  // They have fallen on the bed and lie there: the floor bears them too.
  CHECK(more.position(more.find(65)).z < z);
  CHECK(more.position(more.find(65)).z > top(sim));
  CHECK(mean_lift(more) == near(weight(more)).epsilon(0.01));
  CHECK(weight(more) > 1.04 * weight(sim));
}

TEST_CASE("restart: another step, other threads, limits and observers") {
  const Sim& sim = settled();
  Sim same = restarted();
  same.run(0.01);
  Sim threads = restarted();
  threads.threads = 3;
  threads.run(0.01);
  CHECK(bits(threads) == bits(same));
  int seen = 0;
  Sim observed = restarted();
  observed.run(0.01, silt::at(silt::every(1e-3), [&](const auto&) { ++seen; }));
  CHECK(seen == 11);  // nobody has looked at the start
  CHECK(bits(observed) == bits(same));

  Sim finer = restarted();
  finer.time_step = 4e-6;
  finer.run(0.01);
  CHECK(finer.step_length() == 4e-6);
  CHECK(finer.time() == near(sim.time() + 0.01));
  CHECK(mean_lift(finer) == near(weight(finer)).epsilon(0.01));

  Sim limited = restarted();
  limited.guard.max_overlap = 1e-9;
  CHECK(has_words(refusal<silt::SimulationError>([&] { limited.run(0.01); }),
                  {"guard.max_overlap = 1e-09"}));
  Sim fenced = restarted();
  fenced.guard.domain = silt::Box{{0, 0, 0}, {8e-3, 8e-3, 2e-3}};
  CHECK_THROWS_AS(fenced.run(0.01), silt::SimulationError);
}

// A program in two phases, killed in the second: its first run after the restart is one of 0 s
// without output, and the tables of the second began anew.
TEST_CASE("restart: tables and series go on, even behind runs without them") {
  const fs::path folder = fs::temp_directory_path() / "silt_restart_tables";
  const std::string file = (folder / "heights.csv").string(), frames = (folder / "vtk").string();
  settled();
  const auto lines = [](const std::string& of) {
    std::ifstream in(of);
    return std::count(std::istreambuf_iterator<char>(in), {}, '\n');
  };
  for (const double between : {-1.0, 0.0, 2e-5}) {  // [s]; -1: no such run
    fs::remove_all(folder), fs::create_directory(folder);
    const auto measure = [&](Sim& sim, double duration) {
      sim.run(duration,
              silt::table(file, {"t [s]", "top [m]"}, silt::every(1e-3),
                          [](const Sim& s) {
                            return std::array{s.time(), top(s)};
                          }),
              silt::vtk_series(frames, silt::every(2e-3)));
    };
    Sim first = restarted();
    measure(first, 4e-3);
    CHECK(lines(file) == 1 + 4);
    silt::save_checkpoint(first, path);
    Sim second = restarted();
    if (between >= 0) second.run(between);
    measure(second, 4e-3);
    CHECK(lines(file) == 1 + 8);
    const std::string list = silt::detail::read_file(frames + "/particles.pvd");
    std::size_t steps = 0;
    for (auto at = list.find("<DataSet"); at != std::string::npos;
         at = list.find("<DataSet", at + 1))
      ++steps;
    CHECK(steps == 4);
  }
  fs::remove_all(folder);
}

TEST_CASE("restart: outlets and inlets, where they are accepted") {
  const Sim& sim = settled();
  const silt::Box floor{{-1, -1, -1}, {1, 1, 2.5e-3}};
  CHECK(has_words(refusal<InputError>([&] { restarted({.outlets = {floor}}); }),
                  {"outlets is 0 in the file and 1 in the scene", ".outlets = true"}));
  Sim emptied = restarted({.outlets = {floor}}, {.outlets = true});
  CHECK(emptied.outlet(0).count == 0);
  emptied.run(0.2);
  CHECK(emptied.outlet(0).count == 64);
  CHECK(emptied.outlet(0).mass == near(weight(sim) / 9.81).epsilon(1e-9));
  Sim added = restarted();  // the same by hand
  added.add_outlet(floor);
  added.run(0.2);
  CHECK(added.outlet(0).count == 64);
  // Without the outlet again: what it has counted is gone.
  silt::save_checkpoint(emptied, path);
  Sim without = built({});
  load_checkpoint(without, path, {.outlets = true});
  CHECK(without.outlets() == 0);
  CHECK(without.size() == 0);

  settled();
  CHECK_THROWS_AS(restarted({.rate = 500}), InputError);
  Sim filling = restarted({.rate = 500}, {.inlets = true});
  CHECK(filling.inlet(0).start == sim.time());
  filling.run(0.05);
  CHECK(filling.inlet(0).placed >= 23);  // 25, less those that wait for the next insertion
  CHECK(filling.find(64) < filling.rows());
}

TEST_CASE("restart: an inlet whose rate was changed goes on, bit for bit") {
  const auto started = [] {
    Sim sim = built({.rate = 500});
    sim.run(0.02);
    sim.set_inlet_rate(0, 1500);
    return sim;
  };
  Sim sim = started();
  sim.run(0.01);
  silt::save_checkpoint(sim, path);
  sim.run(0.02);
  Sim again = built({.rate = 500});
  CHECK(has_words(refusal<InputError>([&] { load_checkpoint(again, path); }),
                  {"inlet 0", "rate", "1500", "500"}));
  again.set_inlet_rate(0, 1500);
  load_checkpoint(again, path);
  again.run(0.02);
  CHECK(again.inlet(0).placed == sim.inlet(0).placed);
  CHECK(again.inlet(0).placed > 45);
  CHECK(bits(again) == bits(sim));

  Sim closed = started();  // a closed one stays closed
  closed.set_inlet_rate(0, 0);
  closed.run(0.01);
  silt::save_checkpoint(closed, path);
  Sim still = built({.rate = 500});
  still.set_inlet_rate(0, 0);
  load_checkpoint(still, path);
  still.run(0.02);
  CHECK(still.inlet(0).placed == closed.inlet(0).placed);
}

TEST_CASE("restart: what may not differ is refused by its name") {
  settled();
  CHECK(has_words(refusal<InputError>([&] {
                    restarted({.box = {{0, 0, 0}, {9e-3, 8e-3, 1}}});
                  }),
                  {"wall 0: surface 1", "is 0.008 in the file and 0.009 in the scene"}));
  // Policies: law, search, ledger.
  silt::Particles<Sphere> p;
  silt::Simulation law{p, silt::Contacts<silt::LinearSpring>{{.stiffness = 1e3}},
                       silt::VerletList<>{}, silt::EnergyLedger{}};
  CHECK(has_words(refusal<silt::FileError>([&] { load_checkpoint(law, path); }),
                  {"HertzMindlin", "LinearSpring"}));
}

}  // namespace restart_changes_test
