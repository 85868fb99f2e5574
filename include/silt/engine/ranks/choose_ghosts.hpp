// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The owned rows that each other rank needs as ghosts, because they may touch one of its
/// particles. `grown`: the owned spheres, grown by their reaches (collective).
template <class Comm, class Domain>
DynArray<DynArray<std::uint32_t>> ghosts_in_reach(const Comm& comm,
                                                  std::span<const PositionRow> grown,
                                                  const Domain& domain) {
  Box own;
  double largest = 0;
  for (const PositionRow& p : grown) own.include(p.centre()), largest = std::max(largest, p.r);
  const std::array<double, 7> part{own.min.x, own.min.y, own.min.z, own.max.x,
                                   own.max.y, own.max.z, largest};
  const auto parts = gather(comm, std::span<const double>(part));
  DynArray<DynArray<std::uint32_t>> to(static_cast<std::size_t>(comm.size()));
  for (int r = 0; r < comm.size(); ++r) {
    const auto other = parts[r];
    if (r == comm.rank() || !(other[0] <= other[3])) continue;  // that rank has no particles
    const Vec3d centre{(other[0] + other[3]) / 2, (other[1] + other[4]) / 2,
                       (other[2] + other[5]) / 2},
        half{(other[3] - other[0]) / 2, (other[4] - other[1]) / 2, (other[5] - other[2]) / 2};
    for (std::uint32_t k = 0; k < grown.size(); ++k) {
      Vec3d d = grown[k].centre() - centre;
      if constexpr (Domain::periodic) d = domain.shortest(d);
      const Vec3d out{std::max(std::abs(d.x) - half.x, 0.0), std::max(std::abs(d.y) - half.y, 0.0),
                      std::max(std::abs(d.z) - half.z, 0.0)};
      const double reach = grown[k].r + other[6];
      if (dot(out, out) < (1 + 1e-12) * reach * reach) to[static_cast<std::size_t>(r)].push_back(k);
    }
  }
  return to;
}

}  // namespace silt::detail
