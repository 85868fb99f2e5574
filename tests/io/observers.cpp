// silt - BSD-3-Clause, see LICENSE
// Observers fire when their schedule says, write what can be read, change nothing, and a full disk
// costs no file that was there before.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/io/wall_series.hpp>

#include "near.hpp"

namespace observers_test {

namespace {

using namespace engine_test;
namespace fs = std::filesystem;
using silt::every;

constexpr double step = 1e-5;  // [s]

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_observers_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

/// A heap that falls on a floor: 64 spheres.
auto scene() {
  silt::Particles<Sphere> p;
  for (int k = 0; k < 64; ++k)
    p.add({.position = {2.1e-3 * (k % 4) + 1e-4 * (k / 16), 2.1e-3 * (k / 4 % 4),
                        1e-3 + 2.1e-3 * (k / 16)},
           .radius = 1e-3,
           .density = 2500,
           .velocity = {0.1, 0, -0.5}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = step;
  sim.threads = 1;
  sim.add_wall(silt::box({-2e-3, -2e-3, 0}, {0.02, 0.02, 0.02}), rubber);
  return sim;
}

/// Remembers the times at which it was called [s].
struct Times {
  std::vector<double>* times;
  template <class Sim>
  void operator()(const Sim& sim) const {
    times->push_back(sim.time());
  }
};

std::size_t count_of(const std::string& word, const std::string& content) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = content.find(word, at)) != std::string::npos; ++at) ++count;
  return count;
}

/// Runs `action` in a child process that may write no file longer than `bytes`; returns what the
/// error says, which comes back through a pipe.
template <class Action>
std::string error_on_full_disk(std::size_t bytes, Action&& action) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);  // the write fails instead, as on a full disk
    std::string said = "no error";
    try {
      const struct rlimit limit { bytes, bytes };
      if (::setrlimit(RLIMIT_FSIZE, &limit) == 0) action();
    } catch (const silt::FileError& error) {
      said = error.what();
    } catch (const std::exception& error) {
      said = silt::text("another error: ", error.what());
    }
    const auto written = ::write(ends[1], said.data(), said.size());
    ::_exit(written == static_cast<ssize_t>(said.size()) ? 0 : 1);
  }
  ::close(ends[1]);
  std::string said(4096, '\0');
  const auto got = ::read(ends[0], said.data(), said.size());
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  said.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return said;
}

}  // namespace

TEST_CASE(
    "schedule: fires at time 0, at every multiple of its interval, at the nearest step, once") {
  // Multiples of the step, fractions of it, and numbers that neither divides.
  for (const double interval : {5 * step, 1e-4, 3.3 * step, 7.49999 * step, 1.0 / 3 * 1e-3}) {
    CAPTURE(interval);
    auto sim = scene();
    std::vector<double> times;
    const double duration = 0.01;
    sim.run(duration, silt::at(every(interval), Times{&times}));
    REQUIRE(times.size() == static_cast<std::size_t>(std::floor(duration / interval + 1e-9)) + 1);
    for (std::size_t k = 0; k < times.size(); ++k)
      // Half a step, and the round-off of time = step number * step.
      CHECK(std::abs(times[k] - static_cast<double>(k) * interval) <= 0.5 * step * (1 + 1e-9));
  }
}

TEST_CASE(
    "schedule: an interval shorter than the step fires at every step, one longer at time 0 only") {
  auto sim = scene();
  std::vector<double> often, once, always;
  sim.run(100 * step, silt::at(every(0.3 * step), Times{&often}), silt::at(every(1), Times{&once}),
          Times{&always});
  CHECK(often.size() == 101);
  CHECK(once == std::vector<double>{0});
  CHECK(always.size() == 101);
  CHECK(always.back() == sim.time());
}

TEST_CASE("schedule: runs the end of the duration, where it is a multiple of the interval") {
  auto sim = scene();
  std::vector<double> times;
  for (int part = 0; part < 3; ++part) {
    times.clear();
    sim.run(0.0012, silt::at(every(0.0004), Times{&times}));
    REQUIRE(!times.empty());
    CHECK(times.back() == near(0.0012 * (part + 1)).epsilon(1e-9));
  }
}

TEST_CASE("schedule: every so many steps, over several runs, with a step that changes") {
  auto sim = scene();
  std::vector<std::int64_t> seventh, each;
  auto note = [](std::vector<std::int64_t>& of) {
    return [&of](const auto& s) { of.push_back(s.step()); };
  };
  auto sevenths = silt::at(silt::every_steps(7), note(seventh));
  auto all = silt::at(silt::every_steps(1), note(each));
  sim.run(10 * step, sevenths, all);
  sim.time_step = 0.5 * step;
  sim.run(5 * step, sevenths, all);
  CHECK(sim.step() == 20);
  CHECK(seventh == std::vector<std::int64_t>{0, 7, 14});
  REQUIRE(each.size() == 21);
  for (std::size_t k = 0; k < each.size(); ++k) CHECK(each[k] == static_cast<std::int64_t>(k));
  for (const std::int64_t steps : {0, -3})
    CHECK(has_words(refusal<silt::InputError>([&] { silt::every_steps(steps); }),
                    {"every_steps", "at least 1"}));
}

// Catches columns of csv_series that the reader takes for misprints.
TEST_CASE("a table of particles that silt has written can be read again") {
  const Folder folder;
  auto sim = scene();
  sim.run(0.002);
  silt::write_particle_csv(folder / "all.csv", sim);
  silt::Particles<Sphere> again;
  again.read(folder / "all.csv", {.density = 2500});
  REQUIRE(again.size() == sim.size());
  for (silt::ParticleId id = 0; id < 64; ++id) {
    const std::size_t k = sim.find(id);
    const auto& p = again.all()[id];
    CHECK(p.position == sim.position(k));
    CHECK(p.velocity == sim.velocity(k));
    CHECK(p.angular_velocity == sim.angular_velocity(k));
    CHECK(p.radius == sim.radius(k));
  }
  // Its names are taken together: a misprint is no field of a module.
  const auto of = [&](const std::string& header) {
    silt::AtomicFile out(folder / "other.csv");
    out.write(header + "\n0,0,0,0,0,0,0,1,0,7\n");
    out.commit();
    return refusal<silt::FileError>([&] { again.read(folder / "other.csv", {.density = 1}); });
  };
  const std::string names = "id,x,y,z,velocity x,velocity y,velocity z,radius,";
  CHECK(has_words(of(names + "materiel,charge"), {"line 1", "'id' is not a column name"}));
  CHECK(of(names + "material,density") == "");
  CHECK(again.all()[64].density == 1);  // a field may have any name
}

TEST_CASE("schedule: an interval that is no time is refused") {
  for (const double interval : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK(has_words(refusal<silt::InputError>([&] { every(interval); }),
                    {"every: interval = ", "[s]", "greater than 0"}));
}

TEST_CASE("observers: a run with all of them gives the bits of a run with none") {
  const Folder folder;
  auto alone = scene();
  alone.run(0.02);
  CHECK(alone.peak_overlap() > 0.01);
  auto watched = scene();
  std::vector<double> times;
  std::FILE* line = std::fopen((folder / "progress").c_str(), "w");
  REQUIRE(line != nullptr);
  watched.run(
      0.02, silt::vtk_series(folder / "vtk", every(1e-3)), silt::progress(line),
      silt::checkpoints(folder / "c", every(3.7e-3)), silt::at(every(2.3e-4), Times{&times}),
      silt::table(folder / "t.csv", {"time [s]", "height [m]"}, every(1e-3), [](const auto& s) {
        return std::array{s.time(), s.position(0).z};
      }));
  std::fclose(line);
  CHECK(bits(watched) == bits(alone));
  CHECK(watched.step() == alone.step());
  CHECK(times.size() == 87);
  CHECK(count_of("\n", silt::detail::read_file(folder / "t.csv")) == 22);  // header, 0 to 20 ms
  CHECK(count_of("DataSet", silt::detail::read_file(folder / "vtk/particles.pvd")) == 21);
  CHECK(count_of("DataSet", silt::detail::read_file(folder / "vtk/walls.pvd")) == 21);
  CHECK(silt::detail::read_file(folder / "progress").size() > 10);
  for (const auto& file : fs::recursive_directory_iterator(folder.path))
    CHECK_FALSE(file.path().string().ends_with(".partial"));
}

// Catches a file a frame of walls at rest, and a frame that shows a wall where it was before it
// moved.
TEST_CASE("vtk_series: walls are written where they look different, and are in each frame") {
  const Folder folder;
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0.1}, .radius = 1e-3, .density = 2500, .fixed = true});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.time_step = step;
  sim.add_wall(silt::rectangle({0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}), rubber);
  const auto files = [&] {
    int n = 0;
    for (const auto& file : fs::directory_iterator(folder / "vtk"))
      n += file.path().filename().string().starts_with("walls_");
    return n;
  };
  auto series = silt::vtk_series(folder / "vtk", every(1e-3));
  sim.run(5e-3, series);
  CHECK(files() == 1);
  sim.add_wall(silt::rectangle({0, 0, 0.02}, {0.01, 0, 0}, {0, 0.01, 0}), rubber,
               {.motion = silt::translation({1, 0, 0})});
  sim.run(5e-3, series);
  CHECK(files() == 6);
  const std::string list = silt::detail::read_file(folder / "vtk/walls.pvd");
  CHECK(count_of("DataSet", list) == 11);
  CHECK(count_of("file=\"walls_000000000.vtp\"", list) == 6);
  CHECK(count_of("file=\"walls_000001000.vtp\"", list) == 1);
}

/// Turns a grain back: twice at one instant would be not at all.
struct TurnBack {
  int* times;
  template <class Sim>
  void operator()(Sim& sim) const {
    ++*times;
    sim.set_velocity(9, -sim.velocity(sim.find(9)));
  }
};

// Catches: observers that are called at the end of one run and again at the start of the next; a
// checkpoint of that instant without the change, which is then lost.
TEST_CASE("observers: what they change is changed once an instant, however the run is cut") {
  const Folder folder;
  int edits = 0;
  const auto edit = [&] { return silt::at(every(1e-3), TurnBack{&edits}); };
  auto whole = scene();
  whole.run(6e-3, edit());
  CHECK(edits == 7);

  edits = 0;
  auto pieces = scene();
  pieces.run(0);  // nobody looks: the next run's observers do
  pieces.run(2e-3, edit());
  pieces.run(0.5e-3, edit());
  pieces.run(3.5e-3, edit());
  CHECK(edits == 7);
  CHECK(bits(pieces) == bits(whole));

  // The checkpoint stands before the edit in the list, and has it.
  edits = 0;
  auto stopped = scene();
  stopped.run(2e-3, silt::checkpoints(folder / "c", every(2e-3)), edit());
  auto continued = scene();
  silt::load_checkpoint(continued, folder / "c");
  CHECK(continued.observed());
  CHECK(bits(continued) == bits(stopped));
  continued.run(4e-3, edit());
  CHECK(edits == 7);
  CHECK(bits(continued) == bits(whole));

  // Saved where nobody has looked: then the next run's observers do, in both.
  edits = 0;
  auto unseen = scene();
  unseen.run(2e-3);
  save_checkpoint(unseen, folder / "c");
  auto loaded = scene();
  silt::load_checkpoint(loaded, folder / "c");
  unseen.run(1e-3, edit());
  CHECK(edits == 2);
  loaded.run(1e-3, edit());
  CHECK(edits == 4);
  CHECK(bits(loaded) == bits(unseen));
}

// A run of a duration that is no multiple of the step ends up to a step later. Catches: rows at the
// start that come or not by how the end was rounded (of these seven runs three had none).
TEST_CASE("observers: a new table begins with the start of its run, wherever a step falls") {
  const Folder folder;
  for (const double odd : {0.97e-5, 1e-5, 1.03e-5, 0.71e-5, 0.83e-5, 1.29e-5, 1.17e-5}) {
    CAPTURE(odd);
    auto sim = scene();
    sim.time_step = odd;
    sim.run(1e-3);
    sim.run(1e-3, silt::table(folder / "t.csv", {"time [s]", "height [m]"}, every(0.5e-3),
                              [](const auto& s) {
                                return std::array{s.time(), s.position(0).z};
                              }));
    CHECK(count_of("\n", silt::detail::read_file(folder / "t.csv")) == 4);  // header, 1, 1.5, 2 ms
  }
}

TEST_CASE("observers: each step is seen once over two runs; a new table begins with its start") {
  const Folder folder;
  auto sim = scene();
  std::vector<double> always, timed;
  const auto table = [&](const char* name) {
    return silt::table(folder / name, {"time [s]"}, every(50 * step),
                       [](const auto& s) { return s.time(); });
  };
  sim.run(100 * step, Times{&always}, silt::at(every(50 * step), Times{&timed}), table("1.csv"));
  sim.run(100 * step, Times{&always}, silt::at(every(50 * step), Times{&timed}), table("2.csv"));
  CHECK(always.size() == 201);
  CHECK(timed.size() == 5);
  CHECK(count_of("\n", silt::detail::read_text(folder / "1.csv")) == 4);  // header, 0, 50, 100
  CHECK(count_of("\n", silt::detail::read_text(folder / "2.csv")) == 4);  // 100, 150, 200
}

TEST_CASE("table: a row may be one number, and is one column of numbers") {
  Folder folder;
  auto sim = scene();
  sim.run(3 * step, silt::table(folder / "t.csv", {"time [s]"}, every(step),
                                [](const auto& s) { return s.time(); }));
  sim.run(0, silt::table(folder / "n.csv", {"steps [-]"}, every(step),
                         [](const auto& s) { return s.step(); }));
  const auto lines = [&](const char* name) {
    return count_of("\n", silt::detail::read_text(folder / name));
  };
  CHECK(lines("t.csv") == 5);
  CHECK(silt::detail::read_text(folder / "n.csv") == "steps [-]\n3\n");
}

TEST_CASE("vtk_series: frames say their time and hold every particle with its fields") {
  const Folder folder;
  auto sim = scene();
  sim.run(2e-3, silt::vtk_series(folder.path, every(1e-3),
                                 [](const auto& s, auto& fields, const auto& places) {
                                   static std::vector<double> speed;
                                   speed.clear();
                                   for (const auto k : places) speed.push_back(norm(s.velocity(k)));
                                   fields.add("speed", speed);
                                 }));
  const auto series = silt::detail::read_file(folder / "particles.pvd");
  CHECK(
      has_words(series, {"timestep=\"0\"", "timestep=\"0.001\"", "timestep=\"0.002\"",
                         "file=\"particles_000000000.vtp\"", "file=\"particles_000000200.vtp\""}));
  const auto frame = silt::detail::read_file(folder / "particles_000000100.vtp");
  CHECK(has_words(frame,
                  {"NumberOfPoints=\"64\"", "Name=\"radius\"", "Name=\"velocity\"", "Name=\"id\"",
                   "Name=\"material\"", "Name=\"angular_velocity\"", "Name=\"speed\""}));
  // The same points as numbers: they stand one after the other, behind their length in bytes.
  const auto names = frame.find("Name=\"Points\"");
  const auto offset = std::stoul(frame.substr(frame.find("offset=\"", names) + 8));
  const char* points = frame.data() + frame.find("\n_") + 2 + offset + 8;
  // The box is drawn whole: six sides of two triangles, the same in each frame.
  CHECK(
      has_words(silt::detail::read_file(folder / "walls_000000000.vtp"), {"NumberOfPolys=\"12\""}));
  CHECK(count_of("walls_000000000.vtp", silt::detail::read_file(folder / "walls.pvd")) == 3);
  auto again = scene();
  again.run(1e-3);
  for (std::size_t k = 0; k < again.rows(); ++k) {
    double xyz[3];
    std::copy_n(points + 24 * k, 24, reinterpret_cast<char*>(xyz));
    CHECK(Vec3d{xyz[0], xyz[1], xyz[2]} == again.position(k));
  }
  // VTK's own reader: tests/io/vtk.cpp.
}

TEST_CASE(
    "observers: a continued run repeats no frame and no row, and drops those after its start") {
  const Folder folder;
  const auto observe = [&](auto& sim, double duration) {
    sim.run(duration, silt::vtk_series(folder / "vtk", every(1e-3)),
            silt::table(folder / "t.csv", {"time [s]", "height [m]"}, every(1e-3),
                        [](const auto& s) {
                          return std::array{s.time(), s.position(0).z};
                        }),
            silt::checkpoints(folder / "c", every(4e-3)));
  };
  auto whole = scene();
  observe(whole, 0.012);
  const auto table = silt::detail::read_file(folder / "t.csv");
  const auto series = silt::detail::read_file(folder / "vtk/particles.pvd");
  CHECK(count_of("DataSet", series) == 13);

  // Stopped after 10 ms, 2 ms after its last checkpoint; continued from there.
  fs::remove_all(folder / "vtk"), fs::remove(folder / "t.csv");
  auto stopped = scene();
  observe(stopped, 0.010);
  auto continued = scene();
  silt::load_checkpoint(continued, folder / "c");
  CHECK(continued.time() == near(0.008));
  observe(continued, 0.004);
  CHECK(silt::detail::read_file(folder / "t.csv") == table);
  CHECK(silt::detail::read_file(folder / "vtk/particles.pvd") == series);
  CHECK(bits(continued) == bits(whole));
}

TEST_CASE("observers: files that cannot be written are named, with the reason") {
  const Folder folder;
  auto sim = scene();
  std::fclose(std::fopen((folder / "file").c_str(), "w"));
  CHECK(has_words(refusal<silt::FileError>(
                      [&] { sim.run(1e-4, silt::checkpoints(folder / "file/c", every(1e-4))); }),
                  {"file' cannot be created", "is a file"}));
  CHECK(has_words(refusal<silt::FileError>(
                      [&] { sim.run(1e-4, silt::vtk_series(folder / "file", every(1e-4))); }),
                  {"file' cannot be created", "is a file"}));
}

TEST_CASE(
    "observers: a disk that fills up stops the run with the reason and spoils no older file") {
  const Folder folder;
  const auto frames = [&](auto& sim) {
    sim.run(2e-3, silt::vtk_series(folder / "vtk", every(1e-3)));
  };
  const auto rows = [&](auto& sim) {
    sim.run(0.02, silt::table(folder / "t.csv", {"time [s]", "height [m]"}, every(1e-4),
                              [](const auto& s) {
                                return std::array{s.time(), s.position(0).z};
                              }));
  };
  {
    auto sim = scene();
    frames(sim);
    save_checkpoint(sim, folder / "c");
  }
  const auto checkpoint = silt::detail::read_file(folder / "c");
  const auto series = silt::detail::read_file(folder / "vtk/particles.pvd");
  const auto continued = [&] {
    auto sim = scene();
    silt::load_checkpoint(sim, folder / "c");
    return sim;
  };

  // Lists of frames still fit, frames and checkpoints do not.
  CHECK(has_words(error_on_full_disk(2000,
                                     [&] {
                                       auto sim = continued();
                                       sim.run(2e-3, silt::checkpoints(folder / "c", every(1e-3)));
                                     }),
                  {folder / "c", "cannot be written", "File too large"}));
  CHECK(silt::detail::read_file(folder / "c") == checkpoint);
  CHECK(has_words(error_on_full_disk(2000,
                                     [&] {
                                       auto sim = continued();
                                       frames(sim);
                                     }),
                  {"vtk/particles_000000300.vtp", "cannot be written", "File too large"}));
  // The frames of the first run and their list are as they were.
  CHECK(fs::file_size(folder / "vtk/particles_000000200.vtp") > 2000);
  CHECK(silt::detail::read_file(folder / "vtk/particles.pvd") == series);
  CHECK(has_words(error_on_full_disk(1000,
                                     [&] {
                                       auto sim = scene();
                                       rows(sim);
                                     }),
                  {"t.csv", "cannot be written", "File too large"}));
  const auto table = silt::detail::read_file(folder / "t.csv");
  CHECK(table.size() > 900);
  CHECK(table.ends_with('\n'));  // no half of a row
  for (const auto& file : fs::recursive_directory_iterator(folder.path))
    CHECK_FALSE(file.path().string().ends_with(".partial"));
}

// Catches: the frames and rows of the first run lost, or those of the instant between both twice; a
// new simulation that adds to what another has left.
TEST_CASE("observers: a second run of a simulation adds to the files of the first") {
  const Folder folder;
  const auto run_twice = [&] {
    auto sim = scene();
    for (int k = 0; k < 2; ++k)
      sim.run(1e-3, silt::vtk_series(folder / "vtk", every(5e-4)),
              silt::table(folder / "t.csv", {"time [s]", "energy [J]"}, every(5e-4),
                          [](const auto& s) {
                            return std::array{s.time(), s.kinetic_energy()};
                          }),
              silt::wall_series(folder / "w.csv", std::size_t{0}, every(5e-4)));
  };
  for (int again = 0; again < 2; ++again) {
    run_twice();
    const auto series = silt::detail::read_file(folder / "vtk/particles.pvd");
    CHECK(count_of("<DataSet", series) == 5);  // 0, 0.5, ... 2 ms
    for (const char* file :
         {"particles_000000000.vtp", "particles_000000100.vtp", "particles_000000200.vtp"})
      CHECK(count_of(file, series) == 1);
    CHECK(count_of("<DataSet", silt::detail::read_file(folder / "vtk/walls.pvd")) == 5);
    CHECK(count_of("\n", silt::detail::read_file(folder / "t.csv")) == 1 + 5);
    CHECK(count_of("\n", silt::detail::read_file(folder / "w.csv")) == 1 + 5);
  }
}

TEST_CASE("run: what is left of a time, and a time that is over") {
  auto sim = scene();
  sim.run(0.995e-3);  // ends at 1 ms
  CHECK(sim.time() == near(1e-3));
  sim.run(0.995e-3 - sim.time());
  CHECK(sim.step() == 100);
  CHECK_THROWS_WITH_AS(sim.run(0.9e-3 - sim.time()),
                       doctest::Contains("the time is 0.001 s already"), silt::InputError);
}

}  // namespace observers_test
