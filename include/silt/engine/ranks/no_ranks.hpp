// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/parallel/comm.hpp>

// Declarations for simulations on one process; silt/ranks.hpp has the rest.

namespace silt::inline SILT_TARGET::detail {

template <class Policy>
class RankStage;  // rank_stage.hpp
template <class State, class Mover, class Pairs, class Walls>
class RankChange;  // rank_change.hpp
template <class Stage, class Engine>
class RankBonds;  // rank_bonds.hpp
template <class List>
class NearOthers;  // near_others.hpp

template <>
class RankStage<NoRanks> {
 public:
  static constexpr bool active = false;
};

}  // namespace silt::detail
