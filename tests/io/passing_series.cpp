// silt - BSD-3-Clause, see LICENSE
// What passes a surface: numbers and masses that can be counted by hand, tables that go on.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/passing_series.hpp>
#include <silt/io/wall_series.hpp>

#include "near.hpp"

namespace passing_series_test {

namespace {

using namespace engine_test;
using silt::every;
using silt::InputError;
using silt::PassingCounter;
namespace fs = std::filesystem;

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_passing_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};
std::string content(const std::string& path) { return silt::detail::read_file(path); }
std::vector<std::vector<double>> rows(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::vector<double>> all;
  std::string line, cell;
  std::getline(in, line);
  while (std::getline(in, line)) {
    all.emplace_back();
    for (std::stringstream cells(line); std::getline(cells, cell, ',');)
      all.back().push_back(std::stod(cell));
  }
  return all;
}

/// Whether two numbers of a table agree but for rounding.
bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

using Beads = silt::Particles<Sphere>;
template <class... Policies>
auto scene(Beads beads, Policies... policies) {
  silt::Simulation sim{std::move(beads), silt::Contacts<HertzMindlin>{rubber},
                       std::move(policies)...};
  sim.time_step = 1e-5, sim.threads = 1;
  return sim;
}
/// Beads of 64 sizes that fly down without touching.
Beads shower() {
  Beads beads;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      beads.add({.position = {3e-3 * (i - 3.5), 3e-3 * (j - 3.5), 1e-3 + 1e-4 * (i + 3 * j)},
                 .radius = 0.5e-3 + 1e-5 * (8 * i + j),
                 .density = 2500,
                 .velocity = {0, 0, -1}});
  return beads;
}

// Catches: beads beside the disc that count, ones on its seams that do not, masses of other beads,
// a sign against the normal.
TEST_CASE("passing: beads that fall through a disc, by number and mass") {
  const double radius = 7e-3;
  for (const double down : {1.0, -1.0}) {
    auto sim = scene(shower());
    PassingCounter disc(silt::disc({0, 0, 0}, {0, 0, -down}, radius, 256));
    std::size_t inside = 0;
    double mass = 0;  // [kg]
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (const Vec3d x = sim.position(k); std::hypot(x.x, x.y) < radius)
        ++inside, mass += sim.mass(k);
    CHECK(inside == 16);
    sim.run(0.5e-3, disc);
    CHECK(disc.forwards().number + disc.backwards().number == 0);
    sim.run(5.5e-3, disc);
    const auto &with = down > 0 ? disc.forwards() : disc.backwards(),
               &against = down > 0 ? disc.backwards() : disc.forwards();
    CHECK(with.number == inside);
    CHECK(with.mass == near(mass).epsilon(1e-14));
    CHECK(against.number == 0);
    CHECK(against.mass == 0);
    CHECK(disc.net_number() == down * 16);
    CHECK(disc.net_mass() == near(down * mass).epsilon(1e-14));
    CHECK(disc.watched() == near(6e-3));
    CHECK(disc.mass_rate() == near(down * mass / 6e-3));
    disc.clear();
    sim.run(1e-3, disc);
    CHECK(with.number == 0);
    CHECK(disc.watched() == near(1e-3));
  }
}

/// Beads that bounce on a floor; the plane is among them.
auto bouncing(int beads = 5) {
  Beads all;
  for (int k = 0; k < beads; ++k)
    all.add({.position = {5e-3 * k, 0, 4e-3 + 1e-3 * k}, .radius = 1e-3, .density = 2500});
  auto sim = scene(std::move(all));
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  return sim;
}
const silt::Plane middle{{0, 0, 2.5e-3}, {0, 0, 1}};

/// Counts by hand, in each step.
struct ByHand {
  std::map<silt::ParticleId, double> height{};
  std::array<std::size_t, 2> passed{0, 0};
  static constexpr bool reads_contacts = false;
  template <class Sim>
  void operator()(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const double z = sim.position(k).z - middle.point.z;
      const auto [at, is_new] = height.try_emplace(sim.id(k), z);
      if (!is_new && (at->second >= 0) != (z >= 0)) ++passed[z >= 0 ? 0 : 1];
      at->second = z;
    }
  }
};

// Catches: directions mixed up, passages between looks lost, one bead that hides another.
TEST_CASE("passing: forth and back through a plane, as counted in each step") {
  auto sim = bouncing();
  PassingCounter plane(middle), once(middle, {.once = true});
  ByHand hand;
  sim.run(0.3, plane, once, hand);
  CHECK(hand.passed[0] >= 5);
  CHECK(hand.passed[1] > hand.passed[0]);
  CHECK(plane.forwards().number == hand.passed[0]);
  CHECK(plane.backwards().number == hand.passed[1]);
  CHECK(once.forwards().number == 0);  // each has fallen first
  CHECK(once.backwards().number == 5);
  CHECK(once.backwards().mass == near(sim.total_mass()));
}

// Catches: `once` that forgets, at the next run or by clear().
TEST_CASE("passing: once, in several runs with the same counter") {
  auto sim = bouncing();
  PassingCounter once(middle, {.once = true});
  sim.run(0.02, once);
  const auto before = once.backwards().number;
  CHECK(before > 0);
  CHECK(before < 5);
  once.clear();
  sim.run(0.3, once);
  CHECK(once.backwards().number == 5 - before);
  CHECK(once.forwards().number == 0);
}

// Catches: a wrap that counts; a passage across the face of the box that does not.
TEST_CASE("passing: a bead that goes round in a periodic box counts at the plane alone") {
  Beads beads;
  beads.add(
      {.position = {1e-3, 5e-3, 5e-3}, .radius = 1e-3, .density = 2500, .velocity = {1, 0.35, 0}});
  auto sim = scene(std::move(beads),
                   silt::PeriodicBox{{{0, 0, 0}, {0.01, 0.01, 0.01}}, {true, true, false}});
  PassingCounter inside(silt::Plane{{7e-3, 0, 0}, {1, 0, 0}}),
      face(silt::Plane{{0, 0, 0}, {-1, 0, 0}}), above(silt::Plane{{0, 0, 6e-3}, {0, 0, 1}}),
      patch(silt::rectangle({7e-3, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01})),
      half(silt::rectangle({7e-3, 0, 0}, {0, 5e-3, 0}, {0, 0, 0.01}));
  std::size_t wraps = 0, in_half = 0;
  Vec3d last = sim.position(0);
  double y = last.y;  // [m] at the last passage
  const auto watch = [&](const auto& s) {
    const Vec3d x = s.position(0);
    wraps += last.x - x.x > 5e-3;
    last = x;
    const double way = s.time() - 6e-3;  // [m] beyond the first passage, 1 m/s
    if (const double since = std::fmod(way + 0.01, 0.01); way >= 0 && since < 1e-5 - 1e-9) {
      y = std::fmod(5e-3 + 0.35 * s.time(), 0.01);
      in_half += y < 5e-3;
    }
  };
  sim.run(0.1, inside, face, above, patch, half, silt::at(every(1e-5), watch));
  CHECK(wraps > 3);  // the search has wrapped it
  CHECK(inside.forwards().number == 10);
  CHECK(inside.backwards().number == 0);
  CHECK(face.backwards().number == 10);
  CHECK(face.forwards().number == 0);
  CHECK(above.forwards().number + above.backwards().number == 0);
  CHECK(patch.forwards().number == 10);
  CHECK(patch.backwards().number == 0);
  CHECK(in_half > 2);
  CHECK(in_half < 8);
  CHECK(half.forwards().number == in_half);
}

/// A hopper that empties, in which searches sort the particles anew.
auto hopper() {
  Beads beads;
  beads.fill(Box{{-4e-3, -4e-3, 9e-3}, {4e-3, 4e-3, 0.028}},
             {.radius = silt::uniform(0.7e-3, 0.9e-3), .density = 2500, .count = 190});
  auto sim = scene(std::move(beads));
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cone{{0, 0, 0}, {0, 0, 0.03}, 4e-3, 12e-3, silt::Side::Inside}, rubber);
  sim.add_outlet(Box{{-0.1, -0.1, -0.02}, {0.1, 0.1, -6e-3}});
  return sim;
}

// Catches: particles that are lost when the memory is sorted, or counted as another; ones that an
// outlet takes.
TEST_CASE("passing: a hopper's orifice against its outlet and what is between") {
  auto sim = hopper();
  PassingCounter orifice(silt::disc({0, 0, 0}, {0, 0, -1}, 0.02));
  std::vector<silt::ParticleId> order;
  std::size_t sorted = 0;
  sim.run(0.09, orifice, silt::at(every(1e-2), [&](const auto& s) {
            std::vector<silt::ParticleId> now;
            for (std::size_t k = 0; k < s.rows(); ++k)
              if (s.is_present(k)) now.push_back(s.id(k));
            sorted += !order.empty() && !std::is_sorted(now.begin(), now.end()) && now != order;
            order = now;
          }));
  std::size_t between = 0;
  double mass = sim.outlet(0).mass;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && sim.position(k).z < 0) ++between, mass += sim.mass(k);
  CHECK(sorted > 0);
  CHECK(sim.outlet(0).count > 100);
  CHECK(between > 5);
  CHECK(orifice.net_number() == static_cast<double>(sim.outlet(0).count + between));
  CHECK(orifice.net_mass() == near(mass).epsilon(1e-12));
}

// Catches: births that count as passages from somewhere, the places of others' ids; fixed particles
// with their infinite mass.
TEST_CASE("passing: particles of an inlet, removed ones, fixed ones") {
  Beads beads;
  beads.add({.position = {0, 0, 2e-3},
             .radius = 1e-3,
             .density = 2500,
             .velocity = {0, 0, -1},
             .fixed = true});
  beads.add({.position = {5e-3, 0, 5e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  auto sim = scene(std::move(beads));
  // Into a box that the plane cuts: about half of them pass it.
  const std::size_t inlet =
      sim.add_inlet(Box{{0.02, 0, -4e-3}, {0.03, 0.01, 4e-3}},
                    {.radius = 1e-3, .density = 2500, .rate = 2000, .velocity = {0, 0, -1}});
  PassingCounter plane(silt::Plane{{0, 0, 0}, {0, 0, -1}});
  std::map<silt::ParticleId, double> born;  // [m] height where it was seen first
  const auto watch = [&](const auto& s) {
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.is_present(k)) born.try_emplace(s.id(k), s.position(k).z);
  };
  sim.run(4e-3, plane, silt::at(every(1e-4), watch));
  sim.remove(1);  // 1 mm above the plane
  sim.run(0.03, plane, silt::at(every(1e-4), watch));
  std::size_t passed = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && std::isfinite(sim.mass(k)))
      passed += born.at(sim.id(k)) >= 0 && sim.position(k).z < 0;
  CHECK(sim.inlet(inlet).placed > 40);
  CHECK(passed > 20);
  CHECK(passed < sim.inlet(inlet).placed - 10);
  CHECK(plane.forwards().number == passed);
  CHECK(plane.backwards().number == 0);
  CHECK(std::isfinite(plane.forwards().mass));
}

// Catches: an observer that changes the motion; counts that depend on the number of threads.
TEST_CASE("passing: the motion has the same bits with it, the table with one and three threads") {
  const Folder folder;
  auto without = hopper();
  without.run(0.05);
  for (const int threads : {1, 3}) {
    auto sim = hopper();
    sim.threads = threads;
    sim.run(0.05, silt::passing_series(folder / ("t" + std::to_string(threads)),
                                       silt::disc({0, 0, 0}, {0, 0, -1}, 0.02), every(5e-3)));
    CHECK(bits(sim) == bits(without));
  }
  CHECK(content(folder / "t1") == content(folder / "t3"));
  CHECK(rows(folder / "t1").back()[1] > 10);
}

// Catches: rows that are not cumulated, rates over another time, looks at rows alone (the outlet
// takes what has passed within 3 ms).
TEST_CASE("passing_series: a table of numbers, masses and rates") {
  const Folder folder;
  auto sim = hopper();
  auto series = silt::passing_series(folder / "new/orifice.csv",
                                     silt::disc({0, 0, -2e-3}, {0, 0, 1}, 0.02), every(0.04));
  sim.run(0.13, series);
  CHECK(content(folder / "new/orifice.csv")
            .starts_with("time [s],number forwards [-],number backwards [-],mass forwards "
                         "[kg],mass backwards [kg],number rate [1/s],mass rate [kg/s]\n"));
  const auto all = rows(folder / "new/orifice.csv");
  REQUIRE(all.size() == 5);  // 0, 0.04, 0.08, 0.12 and the end
  CHECK(all[0] == std::vector<double>(7, 0.0));
  std::size_t between = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    between += sim.is_present(k) && sim.position(k).z < -2e-3;
  CHECK(all[4][2] == static_cast<double>(sim.outlet(0).count + between));
  CHECK(all[4][0] == near(0.13));
  for (std::size_t k = 1; k < all.size(); ++k) {
    const double t = all[k][0] - all[k - 1][0];
    CHECK(t == near(k < 4 ? 0.04 : 0.01).epsilon(1e-3));
    CHECK(all[k][1] == 0);
    CHECK(alike(all[k][5], (all[k - 1][2] - all[k][2]) / t));
    CHECK(alike(all[k][6], (all[k - 1][4] - all[k][4]) / t));
  }
  CHECK(series.counter().backwards().mass == all[4][4]);
}

// Catches: a row over the last step of a run, which ends up to a step behind its duration; a row
// that is left out where each step has one.
TEST_CASE("passing_series: a run that ends a step behind its last row has that row at its end") {
  const Folder folder;
  const silt::Plane plane{{0, 0, 0}, {0, 0, -1}};
  auto sim = scene(shower());
  sim.time_step = 1.0001e-5;
  sim.run(2e-3, silt::passing_series(folder / "a", plane, every(1e-3)),
          silt::passing_series(folder / "b", plane, every(1.0001e-5)));
  CHECK(sim.step() == 200);
  sim.run(3e-3 - sim.time() + 1e-9, silt::passing_series(folder / "a", plane, every(1e-3)));
  CHECK(sim.step() == 300);
  const auto all = rows(folder / "a");
  REQUIRE(all.size() == 4);
  CHECK(all[2][0] == near(200 * 1.0001e-5));
  CHECK(all[3][0] == near(300 * 1.0001e-5));
  CHECK(rows(folder / "b").size() == 201);
  auto other = scene(shower());
  other.time_step = 0.9999e-5;
  other.run(2e-3, silt::passing_series(folder / "c", plane, every(1e-3)));
  CHECK(other.step() == 201);
  REQUIRE(rows(folder / "c").size() == 3);
  CHECK(rows(folder / "c")[2][0] == near(201 * 0.9999e-5));
}

/// The hopper's table, in one run.
std::string in_one_run(const Folder& folder) {
  auto sim = hopper();
  sim.run(0.12, silt::passing_series(folder / "one", silt::disc({0, 0, 0}, {0, 0, -1}, 0.02),
                                     every(0.02)));
  return folder / "one";
}

// Catches: a table that begins anew or from zero, rows twice, passages between two runs or between
// the last row and a checkpoint that are lost or counted twice.
TEST_CASE("passing_series: a table of several runs and restarts is that of one run") {
  const Folder folder;
  const auto whole = rows(in_one_run(folder));
  REQUIRE(whole.size() == 7);
  const auto series = [&] {
    return silt::passing_series(folder / "parts", silt::disc({0, 0, 0}, {0, 0, -1}, 0.02),
                                every(0.02));
  };
  const auto restarted = [&](const char* file) {
    auto sim = hopper();
    silt::load_checkpoint(sim, folder / file);
    return sim;
  };
  SUBCASE("at times of rows") {
    {
      auto sim = hopper();
      sim.run(0.04, series());
      sim.run(0.06 - sim.time(), series());
      silt::save_checkpoint(sim, folder / "c");
      sim.run(0.05, series());  // and is killed: its rows behind the checkpoint go
    }
    auto sim = restarted("c");
    sim.run(0.12 - sim.time(), series());
    CHECK(content(folder / "parts") == content(folder / "one"));
  }
  SUBCASE("at any times") {
    {
      auto sim = hopper();
      auto kept = series();
      sim.run(0.0501, kept);
      sim.run(0.0733 - sim.time(), kept);  // the same observer
      sim.run(0.012, silt::checkpoints(folder / "c", every(0.0777)), series());  // another one
    }
    auto sim = restarted("c");
    CHECK(sim.time() == near(0.0777).epsilon(1e-3));
    auto last = series();
    sim.run(0.12 - sim.time(), last);
    const auto parts = rows(folder / "parts");
    REQUIRE(parts.size() == 10);  // at 0.0501, 0.0733 and 0.0777 too
    double from = 0, number = 0;
    for (std::size_t k = 0, row = 0; k < parts.size(); ++k) {
      const double rate = k > 0 ? (parts[k][1] - number) / (parts[k][0] - from) : 0;
      CHECK(alike(parts[k][5], rate));
      from = parts[k][0], number = parts[k][1];
      if (row < whole.size() && std::abs(parts[k][0] - whole[row][0]) > 1e-9) continue;
      for (std::size_t c = 1; c < 5; ++c) CHECK(alike(parts[k][c], whole[row][c]));
      ++row;
    }
    CHECK(parts.back()[0] == whole.back()[0]);
    CHECK(last.counter().forwards().number == whole.back()[1]);
  }
  SUBCASE("runs without it are not counted") {
    auto sim = hopper();
    auto kept = series();
    sim.run(0.04, kept);
    const auto before = kept.counter().forwards().number;
    sim.run(0.04);
    sim.run(0.04, kept);
    CHECK(static_cast<double>(kept.counter().forwards().number) ==
          before + whole[6][1] - whole[4][1]);
    const auto parts = rows(folder / "parts");
    REQUIRE(parts.size() == 6);  // at 0.08 too, where it began again
    CHECK(parts[3][1] == parts[2][1]);
    CHECK(alike(parts[4][5], (parts[4][1] - parts[3][1]) / (parts[4][0] - parts[3][0])));
    CHECK(kept.counter().watched() == near(0.08));
  }
}

// Catches: counts that are lost or doubled in silence, two series that mix their rows in one file.
TEST_CASE("passing_series: files, restarts and surfaces that do not fit are refused") {
  const Folder folder;
  const silt::Plane plane{{0, 0, 0}, {0, 0, -1}};
  const auto series = [&](const char* file, silt::PassingOptions options = {}) {
    return silt::passing_series(folder / file, plane, every(0.01), options);
  };
  auto sim = hopper();
  CHECK(has_words(
      refusal<InputError>([&] { sim.run(0.01, series("a"), series("a")); }),
      {"two observers of this run write '" + folder / "a'", "give each a file of its own"}));
  for (const char* same : {"./a", "x/../a", "/a", "x/./y//../../a/"})
    CHECK(has_words(refusal<InputError>([&] { sim.run(0.01, series("a"), series(same)); }),
                    {"two observers of this run write"}));
  CHECK(has_words(refusal<InputError>([&] {
                    sim.run(0.01, silt::wall_series(folder / "b", std::size_t{0}, every(0.01)),
                            series("b"));
                  }),
                  {"two observers of this run write '" + folder / "b'"}));
  {
    auto kept = series("c");
    sim.run(0.01, kept);
    CHECK(has_words(refusal<InputError>([&] { sim.run(0.01, kept, series("c")); }),
                    {"two observers of this run write"}));
  }
  // A file that another series has written, in an earlier run and before a restart.
  sim.run(0.01, silt::wall_series(folder / "w", std::size_t{0}, every(0.01)));
  CHECK(has_words(refusal<silt::FileError>([&] { sim.run(0.01, series("w")); }),
                  {"table '" + folder / "w' cannot be continued: its first line is", "force x"}));
  // `once` in another observer, and after a restart.
  auto once = series("d", {.once = true});
  sim.run(0.01, once);
  sim.run(0.01, once);
  CHECK(has_words(
      refusal<InputError>([&] { sim.run(0.01, series("d", {.once = true})); }),
      {"passing_series '" + folder / "d'", "counts each particle once", "give the same observer"}));
  // A checkpoint that the table does not reach.
  auto saved = series("e");
  auto other = hopper();
  other.run(0.015, saved, silt::at(every(0.007), [&](const auto& s) {
              silt::save_checkpoint(s, folder / "own");
            }));
  auto again = hopper();
  silt::load_checkpoint(again, folder / "own");
  CHECK(has_words(refusal<InputError>([&] { again.run(0.01, series("e")); }),
                  {"passing_series '" + folder / "e' has its last row at t = ",
                   "and this run begins at t = ", "save by silt::checkpoints"}));
  CHECK_NOTHROW(again.run(0.01, series("f")));
  // Surfaces, by the names of what counts.
  CHECK(has_words(refusal<InputError>([&] {
                    PassingCounter{silt::box({0, 0, 0}, {1, 1, 1})};
                  }),
                  {"PassingCounter: 6 surfaces given, but it takes one"}));
  CHECK(has_words(refusal<InputError>([&] {
                    silt::passing_series(
                        "x", silt::Cylinder{{0, 0, 0}, {0, 0, 1}, 1, silt::Side::Inside}, every(1));
                  }),
                  {"passing_series: a Cylinder or Cone is not counted at"}));
  CHECK(has_words(refusal<InputError>([&] {
                    silt::passing_series("x", silt::Plane{{0, 0, 0}, {0, 0, 0}}, every(1));
                  }),
                  {"Plane.normal = (0, 0, 0) [-] must be finite and not zero"}));
  CHECK(has_words(refusal<InputError>([&] {
                    PassingCounter{silt::disc({0, 0, 0}, {0, 0, 1}, -1)};
                  }),
                  {"disc: radius = -1 [m] must be finite and greater than 0"}));
  CHECK(has_words(refusal<InputError>([&] { PassingCounter{silt::TriangleMesh({})}; }),
                  {"0 triangles given"}));
  auto round = scene(shower(), silt::PeriodicBox{{{-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02}},
                                                 {true, true, false}});
  PassingCounter oblique(silt::Plane{{0, 0, 0}, {1, 0, 1}});
  CHECK(has_words(refusal<InputError>([&] { round.run(1e-3, oblique); }),
                  {"PassingCounter: the normal", "is oblique to x, which repeats"}));
}

// Catches: looks of one's own that count twice what the same place has seen, or nothing.
TEST_CASE("passing: looks of one's own, between short runs and in an observer") {
  auto sim = bouncing();
  PassingCounter by_hand(middle), in_observer(middle), own(middle);
  by_hand.look(sim);
  for (int k = 0; k < 200; ++k) {
    sim.run(1e-3, own, silt::at(every(1e-4), [&](const auto& s) { in_observer.look(s); }));
    by_hand.look(sim);
    by_hand.look(sim);
  }
  CHECK(own.backwards().number > 5);
  CHECK(by_hand.net_number() == own.net_number());
  CHECK(in_observer.backwards().number == own.backwards().number);
  CHECK(in_observer.forwards().number == own.forwards().number);
  CHECK(by_hand.watched() == near(0.2).epsilon(1e-3));
}

}  // namespace

}  // namespace passing_series_test
