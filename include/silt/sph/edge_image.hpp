// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// [m] Way out of a solid at a convex edge or corner, from a point `depth` [m] below the surface;
/// empty: there is none near, and the way to the nearest point is right. The direction is the
/// gradient of `distance(x)` (negative inside) over 1.3 h to both sides: across a face away
/// from edges, and between two faces where both are as near.
///
/// A mirror image across the nearest face alone has the wrong velocity for liquid in front of the
/// other face: it flows across that face. Liquid beside a block gained energy at each edge that it
/// passed, circulated with 5 to 13 cm/s for ever, and swelled by a quarter in 30 s
/// (tests/sph/edges.cpp).
///
/// Source: silt's own.
template <class Distance>
std::optional<Vec3d> way_out_at_edge(const Vec3d& x, double depth, double h, bool flat,
                                     const Distance& distance) {
  constexpr double smooth = 0.95;  // [-] least gradient without an edge
  const double reach = 1.3 * h, here = -depth;
  const Vec3d axes[] = {{reach, 0, 0}, {0, 0, reach}, {0, reach, 0}};
  Vec3d slope{0, 0, 0};
  double bend = 0;  // [m] > 0 where faces recede
  for (int d = 0; d < (flat ? 2 : 3); ++d) {
    const double ahead = distance(x + axes[d]), behind = distance(x - axes[d]);
    slope += ((ahead - behind) / (2 * reach * reach)) * axes[d];
    bend += ahead + behind - 2 * here;
  }
  const double steep = norm(slope), enough = 1e-6 * h;
  if (!(steep < smooth && bend > 0.1 * reach && steep > 0.1)) return std::nullopt;
  const Vec3d out = (1 / steep) * slope;
  double length = 0;
  for (int n = 0; n < 100; ++n) {
    const double to = distance(x + length * out);
    if (to > -enough) return length * out;
    length -= to;
    if (length > 1.8 * depth) break;  // at a corner of a cube sqrt(3)
  }
  return std::nullopt;
}

}  // namespace silt::detail
