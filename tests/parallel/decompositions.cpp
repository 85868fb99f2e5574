// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/slabs.hpp>
#include <silt/parallel/thread_comm.hpp>

#include "clouds.hpp"

namespace parallel_decompositions_test {

namespace {

using silt::ThreadComm;

template <class F>
void on(std::initializer_list<int> ranks, const F& f) {
  for (const int n : ranks) CHECK_NOTHROW(silt::run_on_ranks(n, f));
}

TEST_CASE("bisection: any number of ranks has its share of every cloud, within one point or so") {
  // A cut is off by half a weight; what its two sides have too much they share. The sum of the
  // largest shares (1/2, 2/3, 3/5, 5/9, ...) is 2.27 halves.
  on({1, 2, 3, 5, 8, 16}, [](const ThreadComm& comm) {
    silt_test::divides_every_cloud(
        comm, [] { return silt::Bisection{}; }, 1.14);
  });
  on({48}, [](const ThreadComm& comm) {
    silt_test::divides_every_cloud(
        comm, [] { return silt::Bisection{}; }, 1.14, 600);
  });
}

TEST_CASE("moving slabs: all ranks have their share of every cloud, within one point's weight") {
  on({1, 2, 7, 16}, [](const ThreadComm& comm) {
    silt_test::divides_every_cloud(
        comm, [] { return silt::MovingSlabs{.axis = 0}; }, 1);
  });
  on({48}, [](const ThreadComm& comm) {
    silt_test::divides_every_cloud(
        comm, [] { return silt::MovingSlabs{.axis = 2}; }, 1, 600);
  });
}

TEST_CASE(
    "decompositions end on clouds that cannot be divided, and refuse wrong weights on all ranks") {
  on({1, 2, 3, 8, 16}, [](const ThreadComm& comm) {
    const auto both = [&](const auto& make) {
      silt_test::ends_on_every_cloud(comm, make);
      silt_test::refuses_wrong_input(comm, make);
    };
    both([] { return silt::Bisection{}; });
    both([] { return silt::MovingSlabs{.axis = 1}; });
    both([] { return silt::StaticSlabs{.axis = 1}; });
  });
}

TEST_CASE(
    "static slabs: the same thickness; those outside of the box belong to the ends; never moved") {
  on({1, 2, 4, 7}, [](const ThreadComm& comm) {
    using silt_test::expect;
    const int n = comm.size();
    silt::StaticSlabs slabs{.axis = 0, .box = {{-1, 0, 0}, {3, 1, 1}}};
    silt_test::parted(comm, slabs, silt_test::bed(500, true));
    for (int r = 1; r < n; ++r)
      expect(std::abs(slabs.planes()[static_cast<std::size_t>(r - 1)] - (-1 + 4.0 * r / n)) < 1e-15,
             "where a plane is");
    expect(slabs.rank_of({-7, 0, 0}) == 0 && slabs.rank_of({9, 0, 0}) == n - 1, "outside");
    const auto planes = slabs.planes();
    silt_test::parted(comm, slabs, silt_test::lattice(5));
    expect(slabs.planes() == planes, "slabs stay");
    // Without a box: that of the first points that there are.
    silt::StaticSlabs own{.axis = 2};
    silt_test::parted(comm, own, {});
    silt_test::parted(comm, own, {{{0, 0, 2}, {0, 0, 4}}, {1, 1}});
    if (n > 1) expect(std::abs(own.planes()[0] - (2 + 2.0 / n)) < 1e-15, "the points' box");
  });
}

TEST_CASE("moving slabs: planes move when a slab's work has changed by more than the percentage") {
  on({2, 4}, [](const ThreadComm& comm) {
    using silt_test::expect;
    silt::MovingSlabs slabs{.axis = 2, .percent = 10};
    auto cloud = silt_test::bed(4000, false);
    silt_test::parted(comm, slabs, cloud);
    const auto planes = slabs.planes();
    // Weights of the lower slab grow: its share of n ranks by f/(1 + f/n) - ... of the mean.
    const auto grown = [&](double by) {
      auto c = cloud;
      for (std::size_t k = 0; k < c.points.size(); ++k)
        if (slabs.rank_of(c.points[k]) == 0) c.weights[k] *= 1 + by;
      return c;
    };
    const double n = comm.size();
    // (1 + f)/(1 + f/n) = 1.1 at f = 0.1/(1 - 1.1/n).
    const double limit = 0.1 / (1 - 1.1 / n);
    silt_test::parted(comm, slabs, grown(0.99 * limit));
    expect(slabs.planes() == planes, "a change below the percentage");
    const auto work = silt_test::parted(comm, slabs, grown(1.01 * limit));
    expect(slabs.planes() != planes, "a change above it");
    expect(silt_test::furthest_from_mean(work) <= (1 + 1.01 * limit), "balance is back");
  });
  CHECK_THROWS_WITH(
      silt::run_on_ranks(
          2, [](const ThreadComm& comm) { silt::MovingSlabs{.axis = 3}.partition(comm, {}, {}); }),
      "MovingSlabs.axis = 3 must be 0, 1 or 2: x, y or z");
  CHECK_THROWS_WITH(silt::MovingSlabs{.percent = -1}.partition(silt::NoRanks{}, {}, {}),
                    "MovingSlabs.percent = -1 [%] must be finite and not negative");
  CHECK_THROWS_WITH(silt::StaticSlabs{.axis = -1}.partition(silt::NoRanks{}, {}, {}),
                    "StaticSlabs.axis = -1 must be 0, 1 or 2: x, y or z");
  silt::StaticSlabs endless{.axis = 0, .box = {{0, 0, 0}, {INFINITY, 1, 1}}};
  CHECK_THROWS_WITH(
      silt::run_on_ranks(2,
                         [&](const ThreadComm& comm) {
                           auto own = endless;
                           own.partition(comm, {}, {});
                         }),
      "StaticSlabs.box from (0, 0, 0) to (inf, 1, 1) [m] must be finite along the axis");
}

TEST_CASE(
    "bisection: points that hardly move stay with their ranks, also where sides are as long") {
  silt::run_on_ranks(8, [](const ThreadComm& comm) {
    const auto cube = [](double stretch) {
      auto cloud = silt_test::bed(4000, false);
      for (std::size_t k = 0; k < cloud.points.size(); ++k)
        cloud.points[k] = {silt_test::number(5 * k), silt_test::number(5 * k + 1),
                           stretch * silt_test::number(5 * k + 2)};
      return cloud;
    };
    silt::Bisection parts;
    const auto moved = [&](double stretch) {
      const auto before = parts;
      const auto own = silt_test::own_part(comm, cube(stretch));
      const auto owner = parts.partition(comm, own.points, own.weights);
      std::int64_t changed = 0;
      for (std::size_t k = 0; k < owner.size(); ++k)
        changed += owner[k] != before.rank_of(own.points[k]);
      comm.sum_of({&changed, 1});
      return changed;
    };
    moved(0.99);
    for (const double stretch : {1.01, 0.99, 1.05}) CHECK(moved(stretch) < 400);
    CHECK(moved(1.6) > 400);  // now that side is longer by more than a quarter
  });
}

TEST_CASE("bisection: parts of a long box are cut across its long side") {
  silt::run_on_ranks(4, [](const ThreadComm& comm) {
    auto parts = silt::Bisection{};
    auto cloud = silt_test::bed(2000, false);
    for (auto& p : cloud.points) p.x *= 10;
    silt_test::parted(comm, parts, cloud);
    for (const auto& node : parts.nodes) CHECK(node.axis == 0);
    CHECK(parts.nodes.size() == 3);
    // Weights that all sum to the same do not depend on the order of points.
    const double x = parts.nodes[0].cut.along[0] > 0
                         ? silt::detail::value_of_key(parts.nodes[0].cut.along[0])
                         : 0;
    CHECK(x == doctest::Approx(0.2).epsilon(0.1));  // half of -0.3 to 0.7
  });
}

}  // namespace

}  // namespace parallel_decompositions_test
