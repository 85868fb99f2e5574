// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>

#include <silt/core/error.hpp>
#include <silt/search/hashed_grid.hpp>

namespace silt::inline SILT_TARGET {

/// Neighbour list: stores the pairs found by `Finder` within a margin beyond touching (the skin).
/// It searches again only when particles or walls may have moved by this margin. No contact is
/// missed: for the proof and the test that renews the list see engine/lists/list_upkeep.hpp.
///
///   silt::VerletList<>{}                      a margin for each sphere that follows its motion
///   silt::VerletList<>{.skin = 0.3e-3}        [m] the same margin for all: half of this skin
///
/// Source: L. Verlet, Phys. Rev. 159 (1967) 98.
/// Errors: InputError for a skin that is not finite and positive.
/// Tests:  tests/engine/list_upkeep.cpp.
/// Valid:  every scene; the skin affects only the run time.
/// Units:  [m].
template <NeighbourSearch Finder = HashedGrid>
struct VerletList {
  std::optional<double> skin = {};  // [m] > 0; left out: chosen from the motion
  bool sort = true;                 // keep particles in the order of their cells in memory
  Finder finder = {};

  void check() const {
    if (skin) require_positive("VerletList.skin", *skin, "m");
  }
};

namespace detail {

/// The search of a policy: the finder of a list, or the policy itself.
template <class Search>
auto& finder_of(Search& search) {
  if constexpr (requires { search.finder; })
    return search.finder;
  else
    return search;
}

}  // namespace detail
}  // namespace silt
