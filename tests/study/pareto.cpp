// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>

#include <silt/core/random.hpp>
#include <silt/study/pareto.hpp>

namespace pareto_test {

namespace {

using namespace silt;
using Points = std::vector<CostAndError>;

/// True if some other point is as good in both and better in one.
bool beaten(const Points& all, std::size_t k) {
  for (const auto& p : all)
    if (p.cost <= all[k].cost && p.error <= all[k].error &&
        (p.cost < all[k].cost || p.error < all[k].error))
      return true;
  return false;
}

}  // namespace

TEST_CASE("pareto: the front holds exactly those that no other beats, by rising cost") {
  Random random(7);
  for (int scene = 0; scene < 50; ++scene) {
    Points all;
    // Whole numbers: many have the same cost or the same error.
    for (int k = 0; k < 30; ++k)
      all.push_back({std::ceil(random.uniform(0, 12)), std::floor(random.uniform(0, 12))});
    const auto front = pareto_front(all);
    std::vector<bool> on_front(all.size(), false);
    for (std::size_t n = 0; n < front.size(); ++n) {
      on_front[front[n]] = true;
      if (n == 0) continue;
      CHECK(all[front[n]].cost > all[front[n - 1]].cost);
      CHECK(all[front[n]].error < all[front[n - 1]].error);
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (on_front[k]) CHECK_FALSE(beaten(all, k));
      if (on_front[k] || beaten(all, k)) continue;
      // Left out though nothing beats it: its equal stands there already.
      CHECK(std::any_of(front.begin(), front.end(), [&](std::size_t f) {
        return f < k && all[f].cost == all[k].cost && all[f].error == all[k].error;
      }));
    }
  }
}

TEST_CASE("pareto: the knee is the corner of a bent front; a power law has none") {
  const Points bent{{1, 1}, {2, 0.1}, {4, 0.01}, {40, 0.009}, {400, 0.008}};
  CHECK(knee_of(bent) == 2);
  // Units do not matter.
  Points scaled = bent;
  for (auto& p : scaled) p.cost *= 1e-6, p.error *= 1e3;
  CHECK(knee_of(scaled) == 2);
  CHECK_FALSE(knee_of(Points{{1, 1}, {2, 0.25}, {4, 0.0625}, {8, 0.015625}}));  // straight
  CHECK_FALSE(knee_of(Points{{1, 1}, {100, 0.9}, {200, 0.001}}));               // above the line
  CHECK_FALSE(knee_of(Points{{1, 1}, {2, 0.1}}));
  CHECK_FALSE(knee_of(Points{{1, 1}}));
  // 0 counts as 0.001 here: the point lies at (1/2, 1/3), 1/6 below the line.
  CHECK(knee_of(Points{{1, 1}, {10, 0.01}, {100, 0}}) == 1);
}

TEST_CASE("pareto: a cost or an error that is none is refused") {
  CHECK_THROWS_AS(pareto_front(Points{{0, 1}}), InputError);
  CHECK_THROWS_AS(pareto_front(Points{{1, -1}}), InputError);
  CHECK_THROWS_AS(pareto_front(Points{{1, std::nan("")}}), InputError);
  CHECK(pareto_front(Points{}).empty());
}

}  // namespace pareto_test
