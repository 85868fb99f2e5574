// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Places and velocities of the particles of a pack, one per lane, in double precision. Lanes
/// beyond the `n` particles repeat the last one.
template <class Real, std::size_t lanes>
struct SphPackedRows {
  Vec3<Real> x, v;  // [m], [m/s]

  SphPackedRows(const SphRow* rows, std::size_t n) {
    alignas(64) double of[6][lanes];
    for (std::size_t l = 0; l < lanes; ++l) {
      const SphRow& r = rows[std::min(l, n - 1)];
      const double values[6] = {r.x, r.y, r.z, r.vx, r.vy, r.vz};
      for (std::size_t c = 0; c < 6; ++c) of[c][l] = values[c];
    }
    x = load3<Real>(of[0], of[1], of[2]), v = load3<Real>(of[3], of[4], of[5]);
  }
};

}  // namespace silt::detail
