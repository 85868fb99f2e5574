// silt - BSD-3-Clause, see LICENSE
#pragma once

// The searches of the benchmark. Your own needs one line in for_each_search: any type with the
// member find() of silt/search/concept.hpp.

#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/search/fastest_of.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/search/nbs.hpp>

#include "baselines.hpp"

namespace bench {

/// HashedGrid with one grid for all sizes.
struct OneLevel : silt::HashedGrid {
  OneLevel() : HashedGrid(silt::one_level) {}
};

/// A search as a simulation uses it: on spheres that it has sorted before.
template <class Search>
struct Ordered : Search {};

/// No complete search: sorted spheres in blocks of 10 000, one after the other. Shows the time of
/// the same work within the caches near the core.
struct InPieces : Ordered<silt::HashedGrid> {
  template <class Domain>
  void find(const silt::SphereSet& spheres, double reach, const Domain& domain,
            const silt::Team& team, Pairs& pairs) {
    const auto rows = spheres.rows;
    for (std::size_t from = 0; from < rows.size(); from += 10000)
      HashedGrid::find({rows.subspan(from, std::min<std::size_t>(10000, rows.size() - from)),
                        spheres.largest_radius},
                       reach, domain, team, pairs);
  }
};

/// Calls visit.operator()<Search>(name, most): `most` spheres keep the benchmark short.
template <class Visit>
void for_each_search(const Visit& visit) {
  visit.template operator()<silt::HashedGrid>("HashedGrid", 1e6);
  visit.template operator()<Ordered<silt::HashedGrid>>("HashedGrid, in order", 1e6);
  visit.template operator()<InPieces>("HashedGrid, pieces", 1e6);
  visit.template operator()<OneLevel>("HashedGrid, one level", 1e6);
  visit.template operator()<silt::CellGrid>("CellGrid", 1e6);
  visit.template operator()<Ordered<silt::CellGrid>>("CellGrid, in order", 1e6);
  visit.template operator()<silt::Nbs>("Nbs", 1e6);
  visit.template operator()<Ordered<silt::Nbs>>("Nbs, in order", 1e6);
  visit.template operator()<silt::AutoSearch>("AutoSearch", 1e6);
  visit.template operator()<DenseGrid>("dense grid", 1e5);
  visit.template operator()<SweepAndPrune>("sweep and prune", 1e5);
  visit.template operator()<Octree>("octree", 1e5);
#if defined(BENCH_NANOFLANN)
  visit.template operator()<KdTree>("k-d tree (nanoflann)", 1e6);
#endif
  visit.template operator()<silt::BruteForce>("all pairs", 1e4);
}

}  // namespace bench
