// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/search/fastest_of.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/search/nbs.hpp>

namespace search_test {

using silt::Box;
using silt::OpenDomain;
using silt::PeriodicBox;
using silt::PositionRow;
using silt::Random;
using silt::Vec3d;
using Rows = std::vector<PositionRow>;
using Found = std::vector<silt::IndexPair>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

struct OneLevel : silt::HashedGrid {
  OneLevel() : HashedGrid(silt::one_level) {}
};
struct SubGrid : silt::HashedGrid {
  SubGrid() : HashedGrid(silt::sub_grid(0.2)) {}
};
struct Halves : silt::HashedGrid {
  Halves() : HashedGrid({.ratio = 0.5, .most = 16}) {}
};

inline const Box unit{{0, 0, 0}, {1, 1, 1}};  // [m]

inline double largest_radius(const Rows& rows) {
  double largest = 0;
  for (const auto& row : rows) largest = std::max(largest, row.r);
  return largest;
}

template <class Search, class Domain>
Found found_by(Search& search, const Rows& rows, double reach, const Domain& domain,
               int threads = 1) {
  Found found{{7, 7}};  // what was in the list before must be gone
  search.find({rows, largest_radius(rows)}, reach, domain, silt::Team(threads), found);
  return found;
}

/// The pairs that a search finds in rows that it has put in order, by their first places.
template <class Search, class Domain>
Found found_in_order(Search& search, Rows rows, double reach, const Domain& domain, int threads) {
  const double largest = largest_radius(rows);
  const silt::Team team(threads);
  std::vector<std::uint32_t> order;
  search.order({rows, largest}, reach, domain, team, order);
  Rows ordered;
  for (const auto k : order) ordered.push_back(rows.at(k));
  rows.clear();  // what a search keeps of them must be its own
  Found found{{7, 7}};
  if constexpr (requires { search.find_ordered(reach, domain, team, found); })
    search.find_ordered(reach, domain, team, found);
  else
    search.find({ordered, largest}, reach, domain, team, found);
  for (auto& [a, b] : found) a = order[a], b = order[b];
  return found;
}

template <class Search>
concept Sorts = requires(Search s, const silt::SphereSet& spheres, const OpenDomain& domain,
                         const silt::Team& team, std::vector<std::uint32_t>& order) {
  s.order(spheres, 1.0, domain, team, order);
};

/// Each pair with the lower index first, all pairs in ascending order; repeated ones stay.
inline Pairs sorted(const Found& found) {
  Pairs pairs;
  for (const auto& [a, b] : found) pairs.emplace_back(std::min(a, b), std::max(a, b));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Checks that the search finds the oracle's pairs, each once; returns how many there are.
template <class Search, class Domain = OpenDomain>
std::size_t compare(const Rows& rows, double reach, const Domain& domain = {}) {
  silt::BruteForce oracle;
  Search search;
  const Pairs expected = sorted(found_by(oracle, rows, reach, domain));
  CHECK(sorted(found_by(search, rows, reach, domain)) == expected);
  CHECK(sorted(found_by(search, rows, reach, domain, 2)) == expected);  // used once more
  if constexpr (Sorts<Search>)
    CHECK(sorted(found_in_order(search, rows, reach, domain, 3)) == expected);
  return expected.size();
}

/// Centres uniform in a box, radii between the two given: uniform, or as many in every octave.
inline Rows random_rows(std::size_t count, const Box& box, double r_min, double r_max,
                        Random& random, bool by_octave = false) {
  Rows rows;
  for (std::size_t k = 0; k < count; ++k) {
    const double r = by_octave ? r_min * std::pow(r_max / r_min, random.uniform())
                               : random.uniform(r_min, r_max);
    rows.push_back({random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
                    random.uniform(box.min.z, box.max.z), r});
  }
  return rows;
}

}  // namespace search_test
