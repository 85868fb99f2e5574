// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>

namespace silt::inline SILT_TARGET {

/// Tests all pairs, O(N^2). Reference for the tests of all other searches.
///
/// Shapes: none. Units: SI. Errors: InputError for a sphere without a finite position or size.
/// Tests:  tests/search/searches.cpp.
/// Source: none: the definition of a pair within reach.
/// Valid:  every scene; for tests and small numbers of spheres.
struct BruteForce {
  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) const {
    detail::bounds_of(spheres, domain, team);
    pairs.clear();
    const auto n = static_cast<std::uint32_t>(spheres.rows.size());
    for (std::uint32_t a = 0; a < n; ++a)
      for (std::uint32_t b = a + 1; b < n; ++b)
        if (detail::within_reach(spheres.rows[a], spheres.rows[b], reach, domain))
          pairs.push_back({a, b});
  }
};

static_assert(NeighbourSearch<BruteForce>);

}  // namespace silt
