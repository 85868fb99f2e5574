// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/level_plan.hpp>
#include <silt/search/levels.hpp>
#include <silt/search/occupied_rows.hpp>
#include <silt/search/pair_scan.hpp>
#include <silt/search/row_scan.hpp>
#include <silt/search/space_order.hpp>

namespace silt::inline SILT_TARGET {

/// Grid that stores only occupied cells. Time and memory are proportional to the number of spheres,
/// for any size of the domain. Spheres of different sizes are in several grids with cells that
/// match their sizes (see Levels).
///
///   silt::HashedGrid{}                        levels chosen from the sizes
///   silt::HashedGrid{silt::sub_grid(0.2)}     one additional grid for small spheres
///   silt::HashedGrid{silt::one_level}         one grid for all
///
/// Within a level, each row of cells is tested against four of the eight rows around it (half
/// stencil), in windows that move along x. Between levels either each coarse sphere tests the parts
/// of rows of fine spheres within its reach, or groups of a few fine spheres of a row test the
/// coarse spheres that reach their bounding box; the cheaper method is chosen by their numbers.
/// Despite its name it uses sorted lists (OccupiedRows), which are faster than a hash table.
/// Valid:  at most 2^32 - 1 spheres. Keys have 64 bits, including the sphere's number; where they
///         do not suffice cells are enlarged (1e6 spheres: from 1e13 cells on).
/// Shapes: none. Units: SI. Errors: InputError for invalid levels, and for a sphere without a
///         finite position or size.
/// Tests:  tests/search/searches.cpp (pair sets identical to BruteForce), tests/search/levels.cpp.
/// Source: levels and sub-grids: see Levels (search/levels.hpp); the search along rows is silt's.
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

  /// First half of find(): sorts spheres into rows.
  template <class Domain>
  void build(const SphereSet& spheres, double reach, const Domain& domain, const Team& team) {
    grid_.sort(spheres, reach, domain, team, levels_);
    plan_.make(grid_);
  }

  /// Largest cutoffs [m] of the spheres of each level at the last search, coarsest first.
  DynArray<double> cutoffs() const {
    DynArray<double> all;
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
