// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET {

/// Input of a search: spheres.
struct SphereSet {
  std::span<const PositionRow> rows;
  double largest_radius = 0;  // [m]
};

/// Neighbour search: finds every pair of spheres with a surface distance below `reach` [m], exactly
/// once. The order must depend on positions only, not on threads:
///   void find(SphereSet, double reach, const Domain&, const Team&, std::vector<IndexPair>& pairs)
/// A search does not depend on forces. Optional members, detected by name, for rows that are kept
/// sorted:
///   void order(SphereSet, double reach, const Domain&, const Team&, std::vector<std::uint32_t>&)
///     an order in which neighbours are close in memory;
///   void find_ordered(double reach, const Domain&, const Team&, std::vector<IndexPair>& pairs)
///     find() for the spheres of the last order(), after they have been sorted into that order.
template <class S>
concept NeighbourSearch = requires(S s, const SphereSet& spheres, const OpenDomain& domain,
                                   const Team& team, std::vector<IndexPair>& pairs) {
  s.find(spheres, 1.0, domain, team, pairs);
};

namespace detail {

/// True if the surface distance of a and b is below `reach`.
template <class Domain>
inline bool within_reach(const PositionRow& a, const PositionRow& b, double reach,
                         const Domain& domain) {
  Vec3d d{a.x - b.x, a.y - b.y, a.z - b.z};
  if constexpr (Domain::periodic) d = domain.shortest(d);
  const double cutoff = a.r + b.r + reach;
  return dot(d, d) < cutoff * cutoff;
}

}  // namespace detail
}  // namespace silt
