// silt - BSD-3-Clause, see LICENSE
// What passes a surface on many ranks: the numbers of one process, while the planes between ranks
// move through the particles at each search, and particles change ranks as they pass.
#include <doctest/doctest.h>

#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include <silt/boundary/finite_walls.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/passing_series.hpp>

#include "near.hpp"
#include "rank_scenes.hpp"
#include "refusal.hpp"

namespace parallel_passing_test {

namespace {

using namespace silt_test;
using silt::every;

std::vector<double> numbers(const std::string& path) {
  std::string all = silt::detail::read_file(path);
  all.erase(0, all.find('\n') + 1);
  std::replace(all.begin(), all.end(), ',', ' ');
  std::vector<double> values;
  for (const char* at = all.c_str();;) {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at) return values;
    values.push_back(x), at = end;
  }
}
/// The same but for the rounding of the motion; numbers of particles are the same.
void check_alike(const std::string& one, const std::string& other) {
  CAPTURE(other);
  const auto a = numbers(one), b = numbers(other);
  REQUIRE(a.size() == b.size());
  REQUIRE(a.size() % 7 == 0);
  double off = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (k % 7 == 1 || k % 7 == 2) CHECK(a[k] == b[k]);
    if (a[k] != b[k]) off = std::max(off, std::abs(a[k] / b[k] - 1));
  }
  CHECK(off < 1e-12);
}

/// Spheres that slide to and fro along the slabs of the ranks, through two planes and a disc.
template <class... Policies>
auto tilted(Policies... policies) {
  auto sim = trough(cloud(12, 4, 3), std::move(policies)...);
  sim.time_step = 2e-5;
  sim.add_outlet({{0.1, -1, -1}, {0.12, 1, 0.012}});
  return sim;
}
const silt::Plane cut{{0.0553, 0, 0}, {1, 0, 0}}, cut_beside{{0.0367, 0, 0}, {-1, 0, 0}};

struct Numbers {
  double forwards = 0, backwards = 0, once = 0, of_seventh = 0, watched = 0, mass = 0;
  bool operator==(const Numbers&) const = default;
};
template <class Sim>
Numbers pass(Sim& sim, const std::string& folder, double duration = 0.12) {
  auto plane = silt::passing_series(folder + "/plane.csv", cut, every(0.04));
  auto disc = silt::passing_series(folder + "/disc.csv",
                                   silt::disc({0.06, 0.02, 0.01}, {1, 0, 0.2}, 0.012), every(0.04));
  silt::PassingCounter once(cut_beside, {.once = true}),
      seventh(cut, {.which = [&](std::size_t k) { return sim.id(k) % 7 == 0; }});
  const auto turn = [](auto& s) { s.gravity.x = s.time() < 0.05 ? 20 : -30; };
  sim.run(duration, silt::at(every(0.002), turn), plane, disc, once, seventh);
  const auto& c = plane.counter();
  return {static_cast<double>(c.forwards().number),
          static_cast<double>(c.backwards().number),
          once.net_number(),
          seventh.net_number(),
          c.watched(),
          c.net_mass()};
}

// Catches: a particle that is lost to the counter when it changes its rank, or is counted on both;
// sums of one rank alone; flags of `once` that stay behind.
TEST_CASE("ranks: what passes planes and a disc is that of one process") {
  const Folder one;
  auto alone = tilted();
  const Numbers by_one = pass(alone, one.path);
  CHECK(by_one.forwards > 15);
  CHECK(by_one.backwards > 15);
  CHECK(by_one.once < -5);  // the plane's normal is -x
  CHECK(by_one.of_seventh != 0);
  CHECK(alone.outlet(0).count > 0);
  CHECK(numbers(one / "disc.csv").rbegin()[5] > 3);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    const Folder many;
    std::mutex mutex;
    std::vector<Numbers> seen;
    double migrated = 0;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto sim = tilted(wandering(comm));
      const Numbers own = pass(sim, many.path);
      double all = 0;
      for (const auto& load : sim.rank_loads()) all += static_cast<double>(load.migrated);
      const std::lock_guard lock(mutex);
      seen.push_back(own), migrated = all;
    });
    if (n > 1) CHECK(migrated > 100);
    for (const Numbers& own : seen) {
      CHECK(own == seen[0]);  // every bit
      CHECK(own.forwards == by_one.forwards);
      CHECK(own.backwards == by_one.backwards);
      CHECK(own.once == by_one.once);
      CHECK(own.of_seventh == by_one.of_seventh);
      CHECK(own.watched == by_one.watched);
      CHECK(own.mass == near(by_one.mass).epsilon(1e-12));
    }
    check_alike(one / "plane.csv", many / "plane.csv");
    check_alike(one / "disc.csv", many / "disc.csv");
  }
}

// Catches: counts of the last row that only rank 0 has; a restart on other ranks that takes the
// particles for new ones.
TEST_CASE("ranks: the table goes on in a later run and after a restart on fewer ranks") {
  const Folder one, many;
  auto alone = tilted();
  pass(alone, one.path);
  const auto series = [&] { return silt::passing_series(many / "plane.csv", cut, every(0.04)); };
  const auto turn = [](auto& s) { s.gravity.x = s.time() < 0.05 ? 20 : -30; };
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = tilted(wandering(comm));
    sim.run(0.04, silt::at(every(0.002), turn), series());
    sim.run(0.08 - sim.time(), silt::at(every(0.002), turn), series());
    silt::save_checkpoint(sim, many / "state");
  });
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    auto sim = tilted(wandering(comm));
    silt::load_checkpoint(sim, many / "state");
    sim.gravity.x = -30;  // as the observer has left it
    auto last = series();
    sim.run(0.12 - sim.time(), silt::at(every(0.002), turn), last);
    const auto all = numbers(one / "plane.csv");
    CHECK(static_cast<double>(last.counter().forwards().number) == all.rbegin()[5]);
  });
  check_alike(one / "plane.csv", many / "plane.csv");
}

// Catches: an error of one rank's predicate, or of rank 0's file, that leaves the others waiting.
TEST_CASE("ranks: what one rank cannot count or write is told on all") {
  const Folder folder;
  silt::run_on_ranks(
      3,
      [&](const silt::ThreadComm& comm) {
        auto sim = tilted(wandering(comm));
        silt::PassingCounter fails(
            cut, {.which = [&](std::size_t) -> bool { throw silt::InputError("no such kind"); }});
        CHECK(has(refusal([&] { sim.run(0.05, fails); }), "no such kind"));
        const auto series = [&] { return silt::passing_series(folder / "a", cut, every(0.01)); };
        CHECK(has(refusal([&] { sim.run(0.01, series(), series()); }),
                  "two observers of this run write"));
        CHECK(sim.sum_over_ranks(1) == 3);
      },
      20);
}

}  // namespace

}  // namespace parallel_passing_test
