// silt - BSD-3-Clause, see LICENSE
// A run that fails leaves what is needed to see why, and its error still says what it was.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <engine/support.hpp>

#include <silt/io/failure.hpp>
#include <silt/module/body_force.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace failure_test {

namespace {

using namespace engine_test;
using silt::every;
using silt::SimulationError;
namespace fs = std::filesystem;

struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_failure_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};
std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
/// The numbers of a table's row (1: the first below the names).
std::vector<double> row(const std::string& path, int number) {
  std::ifstream in(path);
  std::string line, word;
  for (int n = 0; n <= number; ++n) std::getline(in, line);
  std::vector<double> all;
  for (std::istringstream s(line); std::getline(s, word, ',');) all.push_back(std::stod(word));
  return all;
}

using Force = std::function<Vec3d(const silt::Seen&)>;

/// 27 grains on a floor, at rest but for what `force` does, from 5 ms on.
auto scene(Force force, double density = 2500, double step = 1e-5) {
  silt::Particles<Sphere> p;
  for (int k = 0; k < 27; ++k)
    p.add({.position = {2.2e-3 * (k % 3), 2.2e-3 * (k / 3 % 3), 1e-3 + 2.2e-3 * (k / 9)},
           .radius = 1e-3,
           .density = density});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber},
                       silt::BodyForce{std::move(force)}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.threads = 1, sim.time_step = step;
  sim.gravity = {0, 0, -9.81};
  return sim;
}
using Sim = decltype(scene(Force()));

template <class Run>
SimulationError failure(const Run& run) {
  std::optional<SimulationError> caught;
  try {
    run();
  } catch (const SimulationError& error) {
    caught = error;
  }
  REQUIRE(caught.has_value());
  return *caught;
}
/// What is said without the observer.
SimulationError plain(const Force& force, const std::function<void(Sim&)>& change = {}) {
  Sim sim = scene(force);
  if (change) change(sim);
  return failure([&] { sim.run(0.05); });
}
/// Presses the particle with this id down from 5 ms on.
Force pressing(silt::ParticleId id, double force) {
  return [=](const silt::Seen& p) {
    return p.id == id && p.time > 5e-3 ? Vec3d{0, 0, -force} : Vec3d{0, 0, 0};
  };
}

}  // namespace

TEST_CASE("an overlap: the same error, with the particles, contacts and states that belong to it") {
  Folder out;
  const Force force = pressing(18, 0.05);
  const SimulationError alone = plain(force);
  Sim sim = scene(force);
  const SimulationError error =
      failure([&] { sim.run(0.05, silt::on_failure(out.path, every(2e-3))); });
  const std::string said = error.what(), was = alone.what();
  CHECK(said.starts_with(was));
  CHECK(error.step == alone.step);
  CHECK(error.particles == alone.particles);
  CHECK(error.position.z == alone.position.z);
  CHECK(has_words(
      said,
      {out.path, "failure.txt, particles.csv, contacts.csv, touching.vtp, around.vtp, walls.vtp",
       "last_good.silt is the state at step ", "before the failure",
       "at_failure.silt is the state at the failure"}));
  CHECK(content(out / "failure.txt").starts_with(was));

  // The deepest contact is the one that the error names.
  REQUIRE(!error.particles.empty());
  const auto deepest = row(out / "contacts.csv", 1);
  REQUIRE(deepest.size() == 8);
  for (const auto id : error.particles)
    CHECK((deepest[0] == static_cast<double>(id) || deepest[1] == static_cast<double>(id)));
  CHECK(deepest[3] > 0.3);
  const auto named = row(out / "particles.csv", 1);
  CHECK(named[0] == static_cast<double>(error.particles[0]));
  CHECK(named[1] == 1);
  const std::string around = content(out / "around.vtp");
  CHECK(around.find("Name=\"role\"") != std::string::npos);
  CHECK(around.find("NumberOfPoints=\"27\"") != std::string::npos);
  CHECK(content(out / "touching.vtp").find("NumberOfPoints=\"27\"") == std::string::npos);

  // The last good state leads to the same failure; that in which it failed can be looked at.
  Sim again = scene(force);
  silt::load_checkpoint(again, out / "last_good.silt");
  CHECK(again.time() > 1e-3);
  CHECK(again.step() < error.step);
  CHECK(failure([&] { again.run(0.05); }).what() == was);
  Sim seen = scene(force);
  silt::load_checkpoint(seen, out / "at_failure.silt");
  CHECK(seen.step() == error.step);
  CHECK(seen.size() == 27);
}

TEST_CASE("numbers that are none: no checkpoint of them, but of the state before") {
  Folder out;
  const Force force = [](const silt::Seen& p) {
    return p.id == 4 && p.time > 5e-3 ? Vec3d{1e308, 0, 0} : Vec3d{0, 0, 0};
  };
  const double light = 25, step = 2e-6;  // 1e308 N make it infinitely fast in one step
  Sim sim = scene(force, light, step), bare = scene(force, light, step);
  const std::string was = failure([&] { bare.run(0.05); }).what();
  const SimulationError error = failure([&] { sim.run(0.05, silt::on_failure(out.path)); });
  CHECK(std::string(error.what()).starts_with(was));
  CHECK(has_words(error.what(), {"last_good.silt is the state at step 0, t = 0 s",
                                 "not finite, and was not written"}));
  CHECK(!fs::exists(out / "at_failure.silt"));
  CHECK(row(out / "particles.csv", 1)[0] == 4);
  Sim again = scene(force, light, step);
  silt::load_checkpoint(again, out / "last_good.silt");
  CHECK(again.step() == 0);
  CHECK(failure([&] { again.run(0.05); }).what() == was);
}

TEST_CASE("a step over its limit names no particle: the fastest is shown") {
  Folder out;
  // Particle 26 is drawn up and away, ever faster, until contacts at its speed would be too short.
  const Force force = [](const silt::Seen& p) {
    return p.id == 26 ? Vec3d{0, 0, 0.05} : Vec3d{0, 0, 0};
  };
  const auto tight = [](Sim& sim) { sim.guard.max_travel = 10, sim.guard.max_time_step = 0.04; };
  const SimulationError alone = plain(force, tight);
  REQUIRE(std::string(alone.what()).find("above its limit") != std::string::npos);
  REQUIRE(alone.particles.empty());
  Sim sim = scene(force);
  tight(sim);
  const SimulationError error = failure([&] { sim.run(0.05, silt::on_failure(out.path)); });
  CHECK(std::string(error.what()).starts_with(alone.what()));
  CHECK(error.particles.empty());
  CHECK(row(out / "particles.csv", 1)[0] == 26);
}

TEST_CASE("a particle outside the domain, also at the start of a run") {
  Folder out;
  const Force force = pressing(0, 0);
  const auto narrow = [](Sim& sim) {
    sim.guard.domain = silt::Box{{-1, -1, -1}, {4.5e-3, 1, 1}};
    sim.set_velocity(8, {0.1, 0, 0});
  };
  const SimulationError alone = plain(force, narrow);
  Sim sim = scene(force);
  narrow(sim);
  const SimulationError error = failure([&] { sim.run(0.05, silt::on_failure(out.path)); });
  CHECK(std::string(error.what()).starts_with(alone.what()));
  REQUIRE(error.particles.size() == 1);
  CHECK(row(out / "particles.csv", 1)[0] == static_cast<double>(error.particles[0]));

  // Where it is outside before a run, no state has been kept.
  Folder none;
  Sim late = scene(force);
  late.run(1e-4);
  late.guard.domain = silt::Box{{-1, -1, -1}, {4e-3, 1, 1}};
  const SimulationError at_once = failure([&] { late.run(0.05, silt::on_failure(none.path)); });
  CHECK(has_words(at_once.what(), {"on_failure wrote to", "at_failure.silt"}));
  CHECK(std::string(at_once.what()).find("last_good") == std::string::npos);
}

TEST_CASE("what cannot be written hides nothing") {
  const Force force = pressing(18, 0.05);
  const std::string was = plain(force).what();
  {
    Folder out;  // one file has no place
    REQUIRE(::mkdir((out / "contacts.csv").c_str(), 0755) == 0);
    Sim sim = scene(force);
    const SimulationError error = failure([&] { sim.run(0.05, silt::on_failure(out.path)); });
    CHECK(std::string(error.what()).starts_with(was));
    CHECK(has_words(error.what(), {"contacts.csv could not be written", "around.vtp"}));
    CHECK(fs::exists(out / "particles.csv"));
    CHECK(!fs::exists(out / "contacts.csv.partial"));
  }
  {
    Folder out;  // the folder has become a file
    const std::string folder = out / "failed";
    Sim sim = scene(force);
    const SimulationError error = failure([&] {
      sim.run(0.05, silt::on_failure(folder), silt::at(every(5e-3), [&](const auto&) {
                fs::remove_all(folder);
                std::ofstream(folder) << "in the way";
              }));
    });
    CHECK(std::string(error.what()).starts_with(was));
    CHECK(has_words(error.what(), {"on_failure could not write"}));
  }
  Folder out;  // where nothing can be kept, it says so before the first step
  std::ofstream(out / "file") << "in the way";
  Sim sim = scene(force);
  CHECK_THROWS_AS(sim.run(0.05, silt::on_failure(out / "file")), silt::FileError);
}

#ifdef SILT_LONG_TESTS
TEST_CASE("bodies are shown by their surfaces") {
  Folder out;
  silt::Particles<silt::SuperEllipsoid> p;
  p.add_form({.a = 1e-3, .b = 1e-3, .c = 2e-3});
  p.add({.position = {0, 0, 0}, .radius = 2e-3, .density = 2500, .velocity = {1, 0, 0}});
  p.add({.position = {2.5e-3, 0, 0}, .radius = 2e-3, .density = 2500, .fixed = true});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.guard.max_overlap = 0.01;
  const SimulationError error = failure([&] { sim.run(0.05, silt::on_failure(out.path)); });
  CHECK(error.particles.size() == 2);
  CHECK(content(out / "around.vtp").find("Name=\"role\"") != std::string::npos);
  CHECK(row(out / "contacts.csv", 1)[3] > 0);
}
#endif

TEST_CASE("a run that does not fail leaves its last good state, and the same bits") {
  Folder out;
  const Force force = pressing(0, 0);
  Sim sim = scene(force), watched = scene(force);
  sim.run(0.01);
  watched.run(0.01, silt::on_failure(out.path, every(3e-3)));
  CHECK(bits(sim) == bits(watched));
  CHECK(!fs::exists(out / "failure.txt"));
  CHECK(fs::exists(out / "last_good.silt"));
}

}  // namespace failure_test
