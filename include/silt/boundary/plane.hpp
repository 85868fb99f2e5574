// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <limits>

#include <silt/boundary/surface_point.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Infinite plane; the particles are on the side of its normal. One-sided: a centre behind it has a
/// negative distance and is pushed back through the plane.
/// Errors: check() names `Plane.point` or `Plane.normal`.
/// Tests:  tests/boundary/plane.cpp
struct Plane {
  Vec3d point;   // [m] any point of the plane
  Vec3d normal;  // [-] towards the particles, any length except zero

  static constexpr int max_contacts = 1;

  void check() const {
    require(is_finite(point), "Plane.point = ", point, " [m] must be finite");
    const double length = norm(normal);
    require(std::isfinite(length) && length > 0, "Plane.normal = ", normal,
            " [-] must be finite and not zero");
  }

  /// Bounds: flat along an axis if the normal is parallel to it, otherwise infinite.
  Box bounds() const {
    constexpr double far = std::numeric_limits<double>::infinity();
    Box box{{-far, -far, -far}, {far, far, far}};
    if (normal.y == 0 && normal.z == 0) box.min.x = box.max.x = point.x;
    if (normal.z == 0 && normal.x == 0) box.min.y = box.max.y = point.y;
    if (normal.x == 0 && normal.y == 0) box.min.z = box.max.z = point.z;
    return box;
  }

  /// The same plane with a unit normal, which contacts() need not normalise again.
  Plane unit() const {
    const double length = norm(normal);
    return std::isfinite(length) && length > 0 ? Plane{point, normalised(normal)} : *this;
  }

  int contacts(const Vec3d& centre, double reach, SurfacePoint* out) const {
    const double length2 = dot(normal, normal);
    const Vec3d n = std::abs(length2 - 1) <= 4e-16 ? normal : normalised(normal);
    const double distance = dot(centre - point, n);
    if (!(distance < reach)) return 0;
    *out = {n, distance, 0};
    return 1;
  }
};

/// The six walls of the box from `min` to `max` [m], facing inwards: x low, x high, y low, ...
inline DynArray<Plane> box_planes(const Vec3d& min, const Vec3d& max) {
  require(is_finite(min) && is_finite(max), "box: min = ", min, " and max = ", max,
          " [m] must be finite");
  require(min.x < max.x && min.y < max.y && min.z < max.z, "box: min = ", min,
          " [m] must be less than max = ", max, " [m] in x, y and z");
  return {{min, {1, 0, 0}},  {max, {-1, 0, 0}}, {min, {0, 1, 0}},
          {max, {0, -1, 0}}, {min, {0, 0, 1}},  {max, {0, 0, -1}}};
}

}  // namespace silt
