// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/search/concept.hpp>
#include <silt/search/level_plan.hpp>
#include <silt/search/levels.hpp>
#include <silt/search/occupied_rows.hpp>
#include <silt/search/pair_scan.hpp>
#include <silt/search/row_scan.hpp>
#include <silt/search/space_order.hpp>

namespace silt::inline SILT_TARGET {

/// Grids of occupied cells alone: time and memory follow the number of spheres, however large and
/// empty the domain is. Spheres of different sizes lie in several grids, each with cells that fit
/// them (see Levels).
///
///   silt::HashedGrid{}                        levels chosen from the sizes
///   silt::HashedGrid{silt::sub_grid(0.2)}     a sub-grid for fines
///   silt::HashedGrid{silt::one_level}         one grid for all
///
/// Within a level, each row of cells is looked at together with the four rows that follow it among
/// the eight around, in windows that move along x (half stencil). Across levels either each coarse
/// sphere looks at the chords that it cuts out of rows of fines, or each few fines of a row at the
/// coarse spheres that reach the box around them: what is cheaper for their numbers.
/// Cells are found in sorted lists (OccupiedRows), which is faster than in a hash table.
/// Valid:  at most 2^32 - 1 spheres. Keys have 64 bits, the sphere's number included; cells grow
///         where they do not suffice (1e6 spheres: from 1e13 cells on).
/// Shapes: none. Units: SI. Errors: InputError for levels that cannot be, and for a sphere without
///         a finite place or size.
/// Tests:  tests/search/searches.cpp (pair sets identical to BruteForce), tests/search/levels.cpp.
/// Source: of levels and sub-grids: Levels (search/levels.hpp); the search along rows is silt's.
class HashedGrid {
 public:
  HashedGrid() = default;
  HashedGrid(const Levels& levels) : levels_(levels) { levels.check(); }  // NOLINT: converts

  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    detail::space_order(spheres, reach, domain, team, order);
  }

  template <class Arch = DefaultArch, class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    build(spheres, reach, domain, team);
    found_(team, pairs, [&](std::size_t part, std::size_t parts, detail::PairBuffer& found) {
      detail::RowScan<Arch, Domain> scan(grid_, plan_, reach, domain, found);
      const std::size_t end = plan_.first_row(part + 1, parts, grid_);
      for (std::size_t row = plan_.first_row(part, parts, grid_); row < end; ++row) scan(row);
    });
  }

  /// The first half of find(): sorts spheres into rows.
  template <class Domain>
  void build(const SphereSet& spheres, double reach, const Domain& domain, const Team& team) {
    grid_.sort(spheres, reach, domain, team, levels_);
    plan_.make(grid_);
  }

  /// The cutoffs [m] up to which spheres lay in each level at the last search, the coarsest first.
  std::vector<double> cutoffs() const {
    std::vector<double> all;
    for (const auto& level : grid_.levels()) all.push_back(level.cutoff);
    return all;
  }

 private:
  Levels levels_;
  detail::OccupiedRows grid_;
  detail::LevelPlan plan_;
  detail::FoundInParts found_;
};

static_assert(NeighbourSearch<HashedGrid>);

}  // namespace silt
