// silt - BSD-3-Clause, see LICENSE
// CellGrid against BruteForce, the oracle: both decide with the same comparison, so that the sets
// of pairs must be equal, without any tolerance.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>

namespace {

using silt::Box;
using silt::OpenDomain;
using silt::PeriodicBox;
using silt::PositionRow;
using silt::Random;
using silt::Vec3d;
using Rows = std::vector<PositionRow>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

template <class Search, class Domain>
std::vector<silt::IndexPair> found_by(Search& search, const Rows& rows, double reach,
                                      const Domain& domain, int threads = 1) {
  double largest = 0;  // [m]
  for (const auto& row : rows) largest = std::max(largest, row.r);
  std::vector<silt::IndexPair> found{{7, 7}};  // what was in the list before must be gone
  search.find({rows, largest}, reach, domain, silt::Team(threads), found);
  return found;
}

/// Each pair with the lower index first, all pairs in ascending order; repeated ones stay.
Pairs sorted(const std::vector<silt::IndexPair>& found) {
  Pairs pairs;
  for (const auto& [a, b] : found) pairs.emplace_back(std::min(a, b), std::max(a, b));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// The pairs that the grid finds in rows that it has put in order, by their first places.
template <class Domain>
std::vector<silt::IndexPair> found_in_order(const Rows& rows, double reach, const Domain& domain,
                                            int threads) {
  double largest = 0;  // [m]
  for (const auto& row : rows) largest = std::max(largest, row.r);
  silt::CellGrid grid;
  const silt::Team team(threads);
  std::vector<std::uint32_t> order;
  grid.order({rows, largest}, reach, domain, team, order);
  std::vector<silt::IndexPair> found{{7, 7}};
  grid.find_ordered(reach, domain, team, found);
  for (auto& [a, b] : found) a = order[a], b = order[b];
  return found;
}

/// Checks that the grid finds the oracle's pairs, each once; returns how many there are.
template <class Domain = OpenDomain>
std::size_t compare(const Rows& rows, double reach, const Domain& domain = {}) {
  silt::BruteForce oracle;
  silt::CellGrid grid;
  const Pairs expected = sorted(found_by(oracle, rows, reach, domain));
  CHECK(sorted(found_by(grid, rows, reach, domain)) == expected);
  CHECK(sorted(found_in_order(rows, reach, domain, 3)) == expected);
  return expected.size();
}

Rows random_rows(std::size_t count, const Box& box, double r_min, double r_max, Random& random) {
  Rows rows;
  for (std::size_t k = 0; k < count; ++k)
    rows.push_back({random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
                    random.uniform(box.min.z, box.max.z), random.uniform(r_min, r_max)});
  return rows;
}

const Box unit{{0, 0, 0}, {1, 1, 1}};  // [m]

}  // namespace

TEST_CASE("cell_grid: pairs equal brute force for random spheres, any reach and size ratio to 20") {
  Random random(1);
  for (const double ratio : {1.0, 2.0, 20.0})
    for (const double reach : {0.0, 0.01, 0.2, 3.0}) {
      CAPTURE(ratio);
      CAPTURE(reach);
      CHECK(compare(random_rows(600, unit, 0.06 / ratio, 0.06, random), reach) > 100);
    }
}

TEST_CASE("cell_grid: pairs equal brute force for clusters in a nearly empty domain") {
  Random random(2);
  Rows rows;
  for (int cluster = 0; cluster < 6; ++cluster) {
    const Vec3d c{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50)};
    const auto near = random_rows(80, {c, c + Vec3d{0.05, 0.05, 0.05}}, 0.001, 0.01, random);
    rows.insert(rows.end(), near.begin(), near.end());
  }
  CHECK(compare(rows, 0.002) > 1000);
  // Two spheres at opposite ends and a pair in between: almost all cells are empty.
  CHECK(compare({{-1e3, 0, 0, 0.01}, {1e3, 1e3, 1e3, 0.01}, {5, 5, 5, 0.01}, {5.01, 5, 5, 0.01}},
                0) == 1);
}

TEST_CASE("cell_grid: centres on the edges of cells lose no pair and double none") {
  // Lattices whose spacing is the cutoff to within rounding: centres fall on cell edges to either
  // side, and pairs are as far apart as one cell is wide.
  for (const double spacing : {0.1, 0.125, 1.0 / 3, 0.3})
    for (const double factor : {0.5, 0.999999, 1.0, 1.0 + 1e-15, 1.000001, 1.5}) {
      CAPTURE(spacing);
      CAPTURE(factor);
      Rows rows;
      const double r = 0.4 * spacing * factor, reach = 0.2 * spacing * factor;  // cutoff: spacing
      for (int k = 0; k < 9; ++k)
        for (int j = 0; j < 9; ++j)
          for (int i = 0; i < 9; ++i) rows.push_back({i * spacing, j * spacing, k * spacing, r});
      compare(rows, reach);
    }
  // Rows of spheres that touch to within rounding, one cell each.
  Random random(8);
  for (int trial = 0; trial < 2000; ++trial) {
    const double spacing = random.uniform(0.01, 1), start = random.uniform(-3, 3);
    Rows rows;
    for (std::uint64_t k = 0, n = 3 + random.index(30); k < n; ++k)
      rows.push_back({start + static_cast<double>(k) * spacing, 0, 0, 0.5 * spacing});
    compare(rows, 0);
  }
}

TEST_CASE("cell_grid: coincident centres, one cell, one sphere and none") {
  Random random(3);
  CHECK(compare({}, 0.1) == 0);
  CHECK(compare({}, 0) == 0);
  CHECK(compare({}, 0, PeriodicBox{unit, {true, true, true}}) == 0);
  CHECK(compare({{1, 2, 3, 0.5}}, 0.1) == 0);
  CHECK(compare(Rows(40, PositionRow{1, -2, 3, 0.5}), 0) == 40 * 39 / 2);
  CHECK(compare(random_rows(50, unit, 2, 2, random), 0) == 50 * 49 / 2);
  Rows line;  // no extent in two directions
  for (int k = 0; k < 50; ++k) line.push_back({0.1 * k, 7, -7, 0.06});
  CHECK(compare(line, 0) == 49);
}

TEST_CASE("cell_grid: coordinates of 1e6 m change no pair set") {
  Random random(4);
  for (const Vec3d offset : {Vec3d{1e6, -1e6, 1e6}, Vec3d{-1e6, 0, 3e6}}) {
    const Box box{offset, offset + Vec3d{1, 1, 1}};
    CHECK(compare(random_rows(500, box, 0.01, 0.06, random), 0.01) > 100);
  }
  // Two heaps 2e6 m apart.
  auto rows = random_rows(200, {{-1e6, 0, 0}, {-1e6 + 1, 1, 1}}, 0.03, 0.06, random);
  const auto more = random_rows(200, {{1e6, 0, 0}, {1e6 + 1, 1, 1}}, 0.03, 0.06, random);
  rows.insert(rows.end(), more.begin(), more.end());
  CHECK(compare(rows, 0.01) > 100);
}

TEST_CASE("cell_grid: pairs equal brute force in boxes that repeat in any directions") {
  Random random(5);
  for (int directions = 1; directions < 8; ++directions)
    // In cells of the cutoff 0.2 m the box is 1, 2, 3, 4 and 9 cells wide.
    for (const double length : {0.39, 0.41, 0.61, 0.85, 1.81}) {
      CAPTURE(directions);
      CAPTURE(length);
      const PeriodicBox domain{
          {{-0.3, 0.2, 1}, {-0.3 + length, 0.2 + length, 1 + length}},
          {(directions & 1) != 0, (directions & 2) != 0, (directions & 4) != 0}};
      auto rows = random_rows(length < 1 ? 60 : 400, domain.box(), 0.02, 0.065, random);
      // Some exactly on the faces, and one in the middle of two opposite ones each.
      for (int d = 0; d < 3; ++d)
        for (int side = 0; side < 2; ++side) {
          double p[3] = {random.uniform(-0.3, -0.3 + length), random.uniform(0.2, 0.2 + length),
                         random.uniform(1, 1 + length)};
          p[d] = d == 0 ? domain.box().min.x : d == 1 ? domain.box().min.y : domain.box().min.z;
          p[d] += side * length * (1 - 1e-16);
          rows.push_back({p[0], p[1], p[2], 0.06});
        }
      CHECK(compare(rows, 0.07, domain) > 5);
    }
}

TEST_CASE("cell_grid: a repeating box joins what lies across its faces") {
  const PeriodicBox domain{unit, {true, false, true}};
  CHECK(compare(Rows{{0.01, 0.5, 0.5, 0.02}, {0.98, 0.5, 0.5, 0.02}}, 0, domain) == 1);
  CHECK(compare(Rows{{0.5, 0.01, 0.5, 0.02}, {0.5, 0.98, 0.5, 0.02}}, 0, domain) == 0);
  CHECK(compare(Rows{{0.01, 0.5, 0.99, 0.02}, {0.99, 0.5, 0.01, 0.02}}, 0, domain) == 1);
}

TEST_CASE("cell_grid: the list, its order included, does not depend on threads") {
  Random random(6);
  const auto rows = random_rows(3000, unit, 0.005, 0.03, random);
  const PeriodicBox domain{unit, {true, true, true}};
  const auto as_list = [](const std::vector<silt::IndexPair>& found) {
    Pairs pairs;
    for (const auto& [a, b] : found) pairs.emplace_back(a, b);
    return pairs;
  };
  silt::CellGrid grid;
  const auto one = as_list(found_by(grid, rows, 0.01, domain, 1));
  CHECK(one.size() > 1500);
  for (const int threads : {2, 3, 7}) {
    CAPTURE(threads);
    CHECK(as_list(found_by(grid, rows, 0.01, domain, threads)) == one);
  }
}

TEST_CASE("cell_grid: order() names every sphere once, those of a cell side by side") {
  Random random(7);
  const auto rows = random_rows(2000, unit, 0.03, 0.03, random);
  silt::CellGrid grid;
  std::vector<std::uint32_t> order;
  grid.order({rows, 0.03}, 0.0, OpenDomain{}, silt::Team(2), order);
  auto names = order;
  std::sort(names.begin(), names.end());
  REQUIRE(names.size() == rows.size());
  for (std::uint32_t k = 0; k < names.size(); ++k) CHECK(names[k] == k);
  // In random order neighbours are 0.66 m apart in the mean. Here most share a row of cells of 0.06
  // m, eight to a row, and only the step from row to row is long.
  double sum = 0;  // [m]
  for (std::size_t k = 1; k < order.size(); ++k)
    sum += norm(rows[order[k]].centre() - rows[order[k - 1]].centre());
  CHECK(sum / static_cast<double>(order.size()) < 0.33);
}
