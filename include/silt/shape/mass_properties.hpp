// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/symmetric3.hpp>

namespace silt::inline SILT_TARGET {

/// Volume and its first two moments: integrals over a body of 1 [m3], x [m4] and x x^T [m5].
struct Moments {
  double volume = 0;
  Vec3d first{0, 0, 0};
  Symmetric3 second;

  /// The same about a point from which the present origin is seen at `place` [m].
  void shift(const Vec3d& place) {
    const Vec3d s = first;
    first += volume * place;
    second += volume * outer(place);
    second += {2 * s.x * place.x,
               2 * s.y * place.y,
               2 * s.z * place.z,
               s.x * place.y + s.y * place.x,
               s.y * place.z + s.z * place.y,
               s.z * place.x + s.x * place.z};
  }
};

/// What a rigid body of unit density needs to move.
struct MassProperties {
  double volume;    // [m3]
  Vec3d centroid;   // [m] in the frame the body was given in
  Vec3d inertia;    // [m5] principal moments about the centroid, for a density of 1
  Quaternion axes;  // [-] turns principal axes into those the body was given in
  bool operator==(const MassProperties&) const = default;
};

/// From moments about any origin, by the parallel-axis rule; I = tr(S) 1 - S.
inline MassProperties mass_properties(const Moments& m) {
  require(m.volume > 0, "mass_properties: the volume ", m.volume, " [m3] must be greater than 0");
  const Vec3d centroid = m.first * (1 / m.volume);
  Symmetric3 s = m.second;
  s += -m.volume * outer(centroid);
  const double trace = s.trace();
  const Principal p = principal({trace - s.xx, trace - s.yy, trace - s.zz, -s.xy, -s.yz, -s.zx});
  return {m.volume, centroid, p.values, p.axes};
}

}  // namespace silt
