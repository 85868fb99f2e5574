// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>
#include <silt/parallel/decomposition/slabs.hpp>
#include <silt/parallel/thread_comm.hpp>

#include "clouds.hpp"
#include "near.hpp"
#include "refusal.hpp"

namespace parallel_rebalance_test {

namespace {

using silt::Load;
using silt::Rebalance;

TEST_CASE("load: largest and mean work of the ranks, and whose it is") {
  silt::run_on_ranks(4, [](const silt::ThreadComm& comm) {
    const auto load = silt::load_of(comm, comm.rank() == 2 ? 6.0 : 2.0);
    CHECK(load.largest == 6);
    CHECK(load.mean == 3);
    CHECK(load.rank == 2);
    CHECK(load.imbalance() == 2);
    CHECK(silt::load_of(comm, 0).imbalance() == 1);  // nobody has anything to do
  });
}

TEST_CASE("rebalance: due when the work lost by waiting has reached the cost of a decomposition") {
  Rebalance when{.above = 1.15, .each = 5, .per_moved = 50};
  const Load load{.largest = 1200, .mean = 1000, .rank = 0};
  // 100 points: 5 * 100 + 50 * 10 = 1000 = 5 steps of 200 lost.
  CHECK(when.cost(100) == near(1000));
  CHECK_FALSE(when.due(load, 4, 100));
  CHECK(when.due(load, 1, 100));
  when.parted(30);
  CHECK(when.lost == 0);
  CHECK(when.cost(100) == near(500 + 50 * 30));
  CHECK_FALSE(when.due(load, 9, 100));
  CHECK(when.due(load, 1, 100));
}

TEST_CASE("rebalance: due at a quarter of the cost where a rank has far more than the mean") {
  Rebalance when{.above = 1.05, .each = 5, .per_moved = 50};
  // 100 points cost 1000: 3 steps of 100 lost are more than a quarter, 4 of 70 are not enough.
  CHECK_FALSE(when.due({.largest = 1100, .mean = 1000, .rank = 0}, 2, 100));
  CHECK(when.due({.largest = 1100, .mean = 1000, .rank = 0}, 1, 100));
  when.parted(10);
  CHECK_FALSE(when.due({.largest = 1070, .mean = 1000, .rank = 0}, 4, 100));
  CHECK(when.due({.largest = 1081, .mean = 1000, .rank = 0}, 0, 100));  // of 280 lost before
}

TEST_CASE("rebalance: never below the imbalance that is allowed, however much was lost") {
  Rebalance when{.above = 1.05};
  CHECK_FALSE(when.due({.largest = 1049, .mean = 1000, .rank = 0}, 1000000, 100));
  CHECK(when.due({.largest = 1051, .mean = 1000, .rank = 0}, 1, 100));
  CHECK_FALSE(Rebalance{}.due({}, 1000, 0));
}

TEST_CASE("rebalance: wrong settings are refused") {
  using silt_test::has;
  using silt_test::refusal;
  has(refusal([] { Rebalance{.above = 0.9}.due({}, 1, 1); }),
      "Rebalance.above = 0.9 [-] must be finite and at least 1");
  has(refusal([] { Rebalance{.each = -1}.due({}, 1, 1); }),
      "Rebalance.each = -1 [-] must be finite");
  has(refusal([] { Rebalance{.per_moved = NAN}.due({}, 1, 1); }), "Rebalance.per_moved = nan");
}

/// A bed that runs out through a hole: each point falls from its height through the floor to a box
/// below, one after the other. In the bed and in the box a point has more contacts than as it
/// falls.
silt_test::Cloud hopper(std::size_t n, double t) {
  silt_test::Cloud c;
  for (std::uint64_t k = 0; k < n; ++k) {
    const double begins = static_cast<double>(k) / static_cast<double>(n);
    const double fallen = std::max(0.0, t - begins), z = 0.3 + 0.2 * begins - 2 * fallen * fallen;
    const double floor = 0.1 * begins;
    c.points.push_back(
        {0.1 * silt_test::number(2 * k), 0.1 * silt_test::number(2 * k + 1), std::max(z, floor)});
    c.weights.push_back(z > floor && fallen > 0 ? 1 : 4);
  }
  return c;
}

/// Mean imbalance of a hopper that empties in 400 looks of 200 steps, and the decompositions that
/// it took.
template <class D>
std::array<double, 2> emptied(int ranks, D parts, Rebalance when) {
  std::array<double, 2> told{};
  silt::run_on_ranks(ranks, [&](const silt::ThreadComm& comm) {
    D own_parts = parts;
    Rebalance own_when = when;
    const std::size_t n = 2000;
    const int looks = 400, steps = 200;
    double sum = 0, partitions = 0;
    for (int look = 0; look < looks; ++look) {
      const auto cloud = hopper(n, 1.5 * look / looks);
      silt_test::Cloud own;
      for (std::size_t k = 0; k < n; ++k)
        if (own_parts.rank_of(cloud.points[k]) == comm.rank())
          own.points.push_back(cloud.points[k]), own.weights.push_back(cloud.weights[k]);
      const auto load =
          silt::load_of(comm, std::accumulate(own.weights.begin(), own.weights.end(), 0.0));
      if (look > 0) sum += load.imbalance();
      if (!own_when.due(load, steps, static_cast<double>(n) / comm.size()) && look > 0) continue;
      const auto owner = own_parts.partition(comm, own.points, own.weights);
      double sent[] = {0};
      for (const int r : owner) sent[0] += r != comm.rank();
      comm.max_of(sent);
      own_when.parted(static_cast<std::int64_t>(sent[0]));
      ++partitions;
    }
    if (comm.rank() == 0) told = {sum / (looks - 1), partitions};
  });
  return told;
}

TEST_CASE(
    "rebalance: a hopper that empties stays within 5 % in time average; static slabs do not") {
  for (const int ranks : {4, 8}) {
    const auto moving = emptied(ranks, silt::Bisection{}, {});
    const auto fixed = emptied(ranks, silt::StaticSlabs{.axis = 2}, {.above = 1e9});
    INFO(ranks, " ranks: imbalance ", moving[0], " with ", moving[1],
         " decompositions of 399; static slabs ", fixed[0]);
    CHECK(moving[0] < 1.05);
    CHECK(moving[1] < 200);
    CHECK(fixed[0] > 1.5);
    CHECK(fixed[1] == 1);
  }
  // Where moving is dear there are fewer decompositions, and more imbalance.
  const auto cheap = emptied(8, silt::Bisection{}, {}),
             dear = emptied(8, silt::Bisection{}, {.per_moved = 3000});
  CHECK(dear[1] < 0.5 * cheap[1]);
  CHECK(dear[0] > cheap[0]);
  // To the bit the same again.
  CHECK(emptied(8, silt::Bisection{}, {}) == cheap);
}

}  // namespace

}  // namespace parallel_rebalance_test
