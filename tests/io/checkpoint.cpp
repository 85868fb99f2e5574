// silt - BSD-3-Clause, see LICENSE
// A run continued from a checkpoint gives the same bits as one that never stopped; a file that does
// not fit is refused, and leaves the simulation as it was.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <engine/mixed_scene.hpp>

#include <silt/contact/linear_spring.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/module/body_force.hpp>
#include <silt/module/field.hpp>

namespace checkpoint_test {

namespace {

using namespace engine_test;
namespace fs = std::filesystem;
using silt::FileError;
using silt::InputError;
using silt::load_checkpoint;
using silt::save_checkpoint;

constexpr double step = 4e-6;        // [s] of mixed_scene
constexpr std::int64_t last = 9000;  // steps of a whole run

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_restart_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

template <class Sim>
void run_to(Sim& sim, std::int64_t end) {
  sim.run(static_cast<double>(end - sim.step()) * step);
  REQUIRE(sim.step() == end);
}

/// Everything that a user can read of a simulation.
struct Seen {
  std::vector<ParticleBits> particles;
  std::vector<double> numbers;
  bool operator==(const Seen&) const = default;
};
template <class Sim>
Seen seen(const Sim& sim) {
  Seen s{bits(sim), {sim.time(), sim.step_length(), sim.peak_overlap(), sim.largest_overlap()}};
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const auto& wall = sim.wall(w);
    s.numbers.push_back(static_cast<double>(wall.surfaces.size()));
    for (const Vec3d& v : {wall.force, wall.torque, wall.impulse, wall.pose.translation})
      s.numbers.insert(s.numbers.end(), {v.x, v.y, v.z});
  }
  for (const std::uint64_t n : {sim.inlet(0).placed, sim.inlet(0).insertions, sim.outlet(0).count})
    s.numbers.push_back(static_cast<double>(n));
  s.numbers.push_back(sim.outlet(0).mass);
  return s;
}

/// The run that neither stopped nor wrote anything.
const Seen& uninterrupted() {
  static const Seen whole = [] {
    auto sim = mixed_scene();
    run_to(sim, last);
    return seen(sim);
  }();
  return whole;
}

std::string content_of(const std::string& path) { return silt::detail::read_file(path); }
void write_bytes(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace

TEST_CASE(
    "checkpoint: a run continued from any of its checkpoints gives the bits of one that never "
    "stopped, with any number of threads") {
  const Folder folder;
  const auto name = [&](std::int64_t at) { return folder / silt::text("at_", at); };
  auto writer = mixed_scene(2);
  std::size_t touching = 0;
  writer.run(last * step, [&](const auto& sim) {
    if (sim.step() % 2249 != 0) return;
    save_checkpoint(sim, name(sim.step()));
    touching += sim.touching_pairs();
  });
  CHECK(seen(writer) == uninterrupted());  // writing changes nothing
  CHECK(touching > 20);                    // they were saved in the middle of collisions
  for (const std::int64_t at : {0, 2249, 4498, 6747, 8996}) {
    CAPTURE(at);
    auto sim = mixed_scene(at % 2 + 1);
    load_checkpoint(sim, name(at));
    CHECK(sim.step() == at);
    run_to(sim, last);
    CHECK(seen(sim) == uninterrupted());
  }
}

TEST_CASE("checkpoint: one loaded into a simulation that has run replaces its state") {
  const Folder folder;
  auto sim = mixed_scene();
  run_to(sim, 1000);
  save_checkpoint(sim, folder / "c");
  const auto then = seen(sim);
  run_to(sim, 2500);
  CHECK(seen(sim) != then);
  load_checkpoint(sim, folder / "c");
  CHECK(seen(sim) == then);
  run_to(sim, last);
  CHECK(seen(sim) == uninterrupted());
}

TEST_CASE("checkpoint: a run of several shares goes on with the same bits, sorted or not") {
  const Folder folder;
  for (const bool sort : {true, false}) {
    CAPTURE(sort);
    auto whole = many_spheres(2, sort);
    whole.run(0.01);
    auto first = many_spheres(1, sort);
    first.run(0.0063);
    save_checkpoint(first, folder / "c");
    auto second = many_spheres(3, sort);
    load_checkpoint(second, folder / "c");
    CHECK(second.engine().lists.pairs.groups().phases() == 8);
    second.run(0.0037);
    REQUIRE(second.step() == whole.step());
    CHECK(bits(second) == bits(whole));
  }
}

TEST_CASE("checkpoint: restarts of restarts give the same bits, and so does a second save") {
  const Folder folder;
  for (std::int64_t at = 0; at <= last; at += 1125) {
    auto sim = mixed_scene();
    if (at > 0) load_checkpoint(sim, folder / "c");
    if (at > 0) {
      save_checkpoint(sim, folder / "again");
      CHECK(content_of(folder / "again") == content_of(folder / "c"));
    }
    run_to(sim, at);
    save_checkpoint(sim, folder / "c");
    if (at == last) CHECK(seen(sim) == uninterrupted());
  }
}

TEST_CASE(
    "checkpoint: one of before the first run can be loaded between runs, not in an observer") {
  const Folder folder;
  auto sim = mixed_scene();
  sim.time_step = std::nullopt;
  save_checkpoint(sim, folder / "c");
  const auto load = [&](auto& s) { load_checkpoint(s, folder / "c"); };
  std::string words;
  try {
    sim.run(1e-3, silt::at(silt::every(5e-4), [&](auto& s) {
              if (s.time() > 0) load(s);
            }));
  } catch (const silt::InputError& e) {
    words = e.what();
  }
  CHECK(words.find("was saved before the first run") != words.npos);
  CHECK(words.find("load it between runs") != words.npos);
  CHECK(sim.time() > 0);  // nothing was loaded
  load(sim);
  CHECK(sim.time() == 0);
  sim.run(1e-4);
  CHECK(sim.step() > 0);
}

TEST_CASE("checkpoint: saving makes the folder, unless a file has its name") {
  const Folder folder;
  auto sim = mixed_scene();
  save_checkpoint(sim, folder / "runs/first/c");
  auto again = mixed_scene();
  load_checkpoint(again, folder / "runs/first/c");
  CHECK(again.step() == sim.step());
  CHECK_THROWS_WITH_AS(save_checkpoint(sim, folder / "runs/first/c/under/c"),
                       doctest::Contains("is a file"), silt::FileError);
}

TEST_CASE(
    "checkpoint: saved between a change of the scene and the next step it continues as well") {
  const Folder folder;
  const auto change = [](auto& sim) {
    sim.remove_wall(0);
    silt::Particles<Sphere> more;
    more.add({.position = {8e-3, 15.7e-3, 14.5e-3}, .radius = 0.2e-3, .density = 2500});
    sim.add(more);
  };
  auto whole = mixed_scene();
  run_to(whole, 2500);
  CHECK(whole.wall(0).impulse.z < 0);  // the wall is taken away from under the spheres
  change(whole);
  save_checkpoint(whole, folder / "c");
  run_to(whole, 4000);

  auto sim = mixed_scene();
  load_checkpoint(sim, folder / "c");
  CHECK(sim.wall(0).surfaces.empty());
  run_to(sim, 4000);
  CHECK(seen(sim) == seen(whole));
}

TEST_CASE("checkpoint: of several shares, saved after particles were added, it continues as well") {
  const Folder folder;
  const auto grown = [] {
    auto sim = many_spheres(2, true);
    sim.run(0.005);
    silt::Particles<Sphere> more;  // so many that the shares of pairs have other ends
    more.fill({.min = {0, 0, 0.13}, .max = {0.04, 0.04, 0.17}},
              {.radius = 1e-3, .density = 2500, .count = 3000});
    sim.add(more);
    return sim;
  };
  auto whole = grown();
  save_checkpoint(whole, folder / "c");
  whole.run(1e-4);
  auto second = many_spheres(3, true);
  load_checkpoint(second, folder / "c");
  second.run(1e-4);
  CHECK(bits(second) == bits(whole));
}

TEST_CASE(
    "checkpoint: files that do not fit are refused with a sentence, the simulation unchanged") {
  const Folder folder;
  const std::string good = folder / "good", bad = folder / "bad";
  auto saved = mixed_scene();
  run_to(saved, 500);
  save_checkpoint(saved, good);
  const std::string content = content_of(good);

  auto sim = mixed_scene();
  run_to(sim, 1000);
  const auto before = seen(sim);
  const auto damaged = [&](const std::string& bytes) {
    write_bytes(bad, bytes);
    const auto sentence = refusal<FileError>([&] { load_checkpoint(sim, bad); });
    CHECK(seen(sim) == before);
    return sentence;
  };

  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(sim, folder / "none"); }),
                  {"none", "cannot be opened for reading", "No such file"}));
  CHECK(has_words(damaged(""), {bad, "is empty"}));
  CHECK(has_words(damaged("x,y,z\n1,2,3\n"), {bad, "is not a checkpoint of silt"}));
  for (const std::size_t keep : {std::size_t{9}, content.size() / 3, content.size() - 1})
    CHECK(has_words(damaged(content.substr(0, keep)), {bad, "is truncated"}));
  CHECK(has_words(damaged(content + "x"), {bad, "is damaged"}));

  auto newer = content;
  newer[12] = 3;  // the format version follows magic and byte-order mark
  CHECK(has_words(damaged(newer), {bad, "format version 3", "reads version 2", "newer silt"}));

  silt::Random random(3);
  for (int k = 0; k < 60; ++k) {
    auto flipped = content;
    const auto at = random.index(content.size());
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << random.index(8)));
    CAPTURE(at);
    CHECK(has_words(damaged(flipped), {bad}));
  }

  run_to(sim, last);
  CHECK(seen(sim) == uninterrupted());
}

TEST_CASE("checkpoint: the policies' names do not depend on the compile flags") {
  using Sim = decltype(mixed_scene());
  const std::string names = silt::Checkpoint<Sim>::signature();
  CAPTURE(names);
  CHECK(names.find("particles silt::Sphere;") != names.npos);
  CHECK(names.find("contacts silt::Contacts<silt::Basic") != names.npos);
  CHECK(names.find(SILT_TEXT(SILT_TARGET)) == names.npos);
}

// Catches names that end at the bracket of a unit, and functions that are named by their lines.
TEST_CASE("checkpoint: modules are compared by their fields, all of them, and not by functions") {
  const Folder folder;
  const std::string path = folder / "c";
  const auto with = [](auto... modules) {
    silt::Particles<Sphere> one;
    one.add({.position = {8e-3, 0, 0}, .radius = 1e-3, .density = 2500});
    return silt::Simulation{std::move(one), silt::Contacts<silt::LinearSpring>{{.stiffness = 10}},
                            modules...};
  };
  const silt::Field<"age [s]"> age{};
  const silt::Field<"way [m]"> way{};
  auto sim = with(age, way);
  save_checkpoint(sim, path);
  CHECK_NOTHROW(load_checkpoint(sim, path));
  auto other = with(age, silt::Field<"heat [J]">{});
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(other, path); }),
                  {"another program", "Field 'age [s]', Field 'way [m]'", "'heat [J]'"}));
#ifdef SILT_LONG_TESTS
  auto less = with(age);
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(less, path); }), {"'way [m]'"}));
  auto vector = with(age, silt::Field<"way [m]", Vec3d>{});
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(vector, path); }),
                  {"'way [m]' (vector)"}));
  auto pushed = with(age, way, silt::BodyForce{[](const silt::Seen&) { return Vec3d{1, 0, 0}; }});
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(pushed, path); }), {"BodyForce"}));
  save_checkpoint(pushed, path);
  auto otherwise = with(age, way, silt::BodyForce{[](const silt::Seen&) {
                          return Vec3d{2, 0, 0};
                        }});
  CHECK_NOTHROW(load_checkpoint(otherwise, path));  // on another line
#endif
}

TEST_CASE(
    "checkpoint: one of other policies or of another scene is refused, the simulation unchanged") {
  const Folder folder;
  const std::string path = folder / "c";
  auto sim = mixed_scene();
  run_to(sim, 1000);
  const auto before = seen(sim);

  silt::Particles<Sphere> p;
  p.add({.position = {8e-3, 0, 0}, .radius = 1e-3, .density = 2500});
  const silt::Simulation springs{std::move(p),
                                 silt::Contacts<silt::LinearSpring>{{.stiffness = 10}}};
  save_checkpoint(springs, path);
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(sim, path); }),
                  {path, "belongs to another program", "BasicLinearSpring", "BasicHertzMindlin",
                   "Rolli"}));  // its end is cut off where the compiler names enumerators
  CHECK(seen(sim) == before);
#ifdef SILT_LONG_TESTS
  // One policy more or less is named, whatever stands behind it.
  const auto lone = [](auto... policies) {
    silt::Particles<Sphere> one;
    one.add({.position = {8e-3, 0, 0}, .radius = 1e-3, .density = 2500});
    return silt::Simulation{std::move(one), silt::Contacts<silt::LinearSpring>{{.stiffness = 10}},
                            policies...};
  };
  auto plain = lone();
  auto booked = lone(silt::EnergyLedger{});
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(booked, path); }),
                  {"another program: this program has 'ledger', which the file lacks"}));
  save_checkpoint(booked, path);
  CHECK(has_words(refusal<FileError>([&] { load_checkpoint(plain, path); }),
                  {"another program: the file has 'ledger', which this program lacks"}));
#endif

  const auto refused = [&](auto change) {
    auto other = mixed_scene();
    change(other);
    save_checkpoint(other, path);
    const auto sentence = refusal<InputError>([&] { load_checkpoint(sim, path); });
    CHECK(seen(sim) == before);
    return sentence;
  };
  CHECK(has_words(
      refused([](auto& s) {
        s.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
      }),
      {path, "walls is 5 in the file and 4 in the scene", "build the scene that wrote it"}));
  CHECK(has_words(
      refused([](auto& s) {
        s.add_outlet({{0, 0, -2}, {1, 1, -1}});
      }),
      {path, "outlets is 2 in the file and 1 in the scene", "build the scene that wrote it"}));
  const auto with_fifth_wall = [](const silt::Surfaces& surfaces) {
    auto s = mixed_scene();
    s.add_wall(surfaces, rubber);
    return s;
  };
  save_checkpoint(with_fifth_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}), path);
  auto boxed = with_fifth_wall(silt::box({-1, -1, -1}, {2, 2, 2}));
  CHECK(has_words(refusal<InputError>([&] { load_checkpoint(boxed, path); }),
                  {path, "wall 4: surfaces is 1 in the file and 6 in the scene"}));
  CHECK(boxed.step() == 0);

  run_to(sim, last);
  CHECK(seen(sim) == uninterrupted());
}

TEST_CASE("checkpoint: a writer killed at least 100 times at random moments loses nothing") {
  const Folder folder;
  const std::string path = folder / "c";
  auto first = mixed_scene();
  save_checkpoint(first, path);
  silt::Random random(17);
  std::int64_t reached = 0;
  // Enough kills that many hit a write, also where a child needs long for the first one.
  for (int kill = 0; kill < 100 || reached <= 500; ++kill) {
    const pid_t child = ::fork();
    if (child == 0) {
      auto sim = mixed_scene();
      load_checkpoint(sim, path);
      for (;;) {
        if (sim.step() < last) sim.run(10 * step);
        save_checkpoint(sim, path);
      }
    }
    std::this_thread::sleep_for(
        std::chrono::microseconds((2000 + random.index(40000)) * (1 + kill / 100)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WIFSIGNALED(status));  // else it found the last kill's file unfit
    auto sim = mixed_scene();
    load_checkpoint(sim, path);
    CHECK(sim.step() >= reached);
    reached = sim.step();
  }
  auto sim = mixed_scene();
  load_checkpoint(sim, path);
  run_to(sim, last);
  CHECK(seen(sim) == uninterrupted());
}

}  // namespace checkpoint_test
