// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Point of a surface that is locally nearest to a sphere's centre (a local minimum of the
/// distance).
///
/// A surface type has `static constexpr int max_contacts`, `Box bounds() const` (infinite where the
/// surface is), `void check() const` (throws InputError; a mesh checks when it is built) and `int
/// contacts(centre, reach, SurfacePoint* out) const`. The latter returns the number of points with
/// distance < reach that it wrote, deepest first, at most max_contacts.
struct SurfacePoint {
  Vec3d normal;           // [-] unit, from the surface to the centre
  double distance;        // [m] along normal; < 0 for a centre behind a one-sided surface
  std::uint32_t feature;  // face, edge or vertex of a mesh; 0 for primitives
};

/// True if `point` lies in the tangent plane of `surface` within `tolerance` [m], for the same
/// centre. A rim, edge or vertex there is a seam of that surface, not a second contact.
inline bool in_tangent_plane(const SurfacePoint& point, const SurfacePoint& surface,
                             double tolerance) {
  const double along = point.distance * dot(point.normal, surface.normal);
  return std::abs(along - surface.distance) <= tolerance;
}

}  // namespace silt
