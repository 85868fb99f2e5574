// silt - BSD-3-Clause, see LICENSE
#include <silt/core/threads.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

namespace threads_test {

TEST_CASE("team: every part is done exactly once, for any number of threads and parts") {
  for (const int threads : {1, 2, 3, 8, 40}) {
    const silt::Team team(threads);
    CHECK(team.threads() == threads);
    for (const std::size_t parts : {0, 1, 2, 3, 7, 64, 1000}) {
      CAPTURE(threads);
      CAPTURE(parts);
      std::vector<std::atomic<int>> done(parts);
      team.for_parts(parts, [&](std::size_t part) { ++done[part]; });
      for (const auto& times : done) CHECK(times == 1);
    }
  }
}

TEST_CASE("team: loops follow each other by the ten thousand, each complete before the next") {
  const silt::Team team(3);
  std::vector<long> values(50, 0);
  for (long loop = 0; loop < 30000; ++loop) {
    const std::size_t parts = static_cast<std::size_t>(loop) % values.size() + 1;
    team.for_parts(parts, [&](std::size_t part) { ++values[part]; });
  }
  // Part p is done in those of every 50 loops that have more than p parts.
  for (std::size_t part = 0; part < values.size(); ++part)
    CHECK(values[part] == 600 * static_cast<long>(values.size() - part));
}

TEST_CASE("team: ranges cover 0 ... n-1 in order and depend on n alone") {
  for (const std::size_t n : {0, 1, 255, 256, 513, 5000, 1000000}) {
    std::vector<std::pair<std::size_t, std::size_t>> of[2];
    for (int t = 0; t < 2; ++t) {
      of[t].resize(silt::Team::most_ranges, {0, 0});
      silt::Team(1 + 2 * t).for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
        of[t][r] = {from, to};
      });
    }
    CHECK(of[0] == of[1]);
    std::size_t next = 0;
    for (const auto& [from, to] : of[0]) {
      if (to == 0) continue;
      CHECK(from == next);
      next = to;
    }
    CHECK(next == n);
  }
}

TEST_CASE("team: a thread begins with its own share, and the others take over what it leaves") {
  const silt::Team team(2);
  const auto owner = std::this_thread::get_id();
  for (int loop = 0; loop < 3; ++loop) {
    std::vector<std::thread::id> by(2);
    std::atomic<int> begun{0};
    team.for_parts(2, [&](std::size_t part) {
      by[part] = std::this_thread::get_id();
      ++begun;
      while (begun < 2) std::this_thread::yield();  // so that nobody does both
    });
    CHECK(by[0] == owner);
    CHECK(by[1] != owner);
  }

  // The owner is held up in its first part until all others are done: those of its own share too.
  std::vector<std::thread::id> by(20);
  std::atomic<std::size_t> others{0};
  team.for_parts(by.size(), [&](std::size_t part) {
    by[part] = std::this_thread::get_id();
    if (by[part] != owner)
      ++others;
    else
      while (others + 1 < by.size()) std::this_thread::yield();
  });
  CHECK(std::count(by.begin(), by.end(), owner) <= 1);
}

TEST_CASE("team: more threads than cores, and threads that come late, lose no part") {
  const silt::Team team(16);
  for (int loop = 0; loop < 200; ++loop) {
    std::atomic<long> sum{0};
    team.for_parts(100, [&](std::size_t part) {
      if (part % 37 == 0) std::this_thread::yield();
      sum += static_cast<long>(part);
    });
    CHECK(sum == 4950);
    if (loop % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));  // all asleep
  }
}

TEST_CASE("team: a number of threads that cannot be is refused") {
  CHECK_THROWS_WITH_AS(silt::Team(0), "threads = 0 must be in [1, 4096]", silt::InputError);
  CHECK_THROWS_WITH_AS(silt::Team(5000), "threads = 5000 must be in [1, 4096]", silt::InputError);
}

}  // namespace threads_test
