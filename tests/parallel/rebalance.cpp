// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/parallel/decomposition/rebalance.hpp>
#include <silt/parallel/thread_comm.hpp>

#include "near.hpp"
#include "refusal.hpp"

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
  Rebalance when{.above = 1.05, .each = 5, .per_moved = 50};
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

}  // namespace
