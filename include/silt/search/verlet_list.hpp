// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>

#include <silt/core/error.hpp>
#include <silt/search/hashed_grid.hpp>

namespace silt::inline SILT_TARGET {

/// Keeps the pairs that `Finder` found with some reach beyond touching (the skin), and finds anew
/// only when particles or walls may have moved by as much. No contact is ever missed: the proof
/// and the test that renews the list are in engine/lists/list_upkeep.hpp.
///
///   silt::VerletList<>{}                      for each sphere a reach that follows its motion
///   silt::VerletList<>{.skin = 0.3e-3}        [m] the same for all: half of this skin
///
/// Source: L. Verlet, Phys. Rev. 159 (1967) 98.
/// Errors: InputError for a skin that is not finite and positive.
/// Tests:  tests/engine/list_upkeep.cpp.
/// Valid:  every scene; a skin only changes the time that a run takes.
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

/// The search that a policy finds pairs with: the finder of a list, or the policy itself.
template <class Search>
auto& finder_of(Search& search) {
  if constexpr (requires { search.finder; })
    return search.finder;
  else
    return search;
}

}  // namespace detail
}  // namespace silt
