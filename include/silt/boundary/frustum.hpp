// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <string_view>

#include <silt/boundary/surface_point.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// The side of a round wall on which the particles are.
enum class Side { Inside, Outside };

namespace detail {

/// Lateral surface of Cylinder and Cone, in the half plane through axis and centre: a segment from
/// (0, radius_from) to (length, radius_to) in (axial, radial) coordinates.
///
/// On the free side the distance is that to the nearest point of the segment; it is continuous from
/// the face around the rims. Behind the surface the distance is negative within the length. Beyond
/// the length only the rims are touched.
struct Frustum {
  Vec3d from, to;                 // [m] ends of the axis
  double radius_from, radius_to;  // [m]
  Side side;

  void check(std::string_view name) const {
    require(is_finite(from), name, ".from = ", from, " [m] must be finite");
    require(is_finite(to), name, ".to = ", to, " [m] must be finite");
    const double length = norm(to - from);
    require(std::isfinite(length) && length > 0, name, ".from = ", from, " and ", name,
            ".to = ", to, " [m] must be different points");
  }

  Box bounds() const {
    const Vec3d axis = normalised(to - from);
    const Vec3d disc{span(axis.x), span(axis.y), span(axis.z)};
    Box box;
    box.include(from - radius_from * disc), box.include(from + radius_from * disc);
    box.include(to - radius_to * disc), box.include(to + radius_to * disc);
    return box;
  }

  int contacts(const Vec3d& centre, double reach, SurfacePoint* out) const {
    const Vec3d along = to - from;
    if (is_far(centre - from, along, reach)) return 0;
    const double length = norm(along);
    const Vec3d axis = along * (1 / length);
    const Vec3d arm = centre - from;
    const double z = dot(arm, axis);
    const auto [radial, r] = split_radial(arm, z, axis, length);

    const double taper = radius_to - radius_from;
    const double slant = std::sqrt(length * length + taper * taper);
    const double sign = side == Side::Outside ? 1 : -1;
    const double n_z = -sign * taper / slant, n_r = sign * length / slant;  // free normal
    const double u = (z * length + (r - radius_from) * taper) / slant;
    const double face = z * n_z + (r - radius_from) * n_r;

    const bool over_face = face < 0 ? z >= 0 && z <= length : u >= 0 && u <= slant;
    SurfacePoint nearest{n_z * axis + n_r * radial, face, 0};
    if (!over_face) {
      const bool low = face < 0 ? z < 0 : u < 0;
      const double dz = low ? z : z - length;
      const double dr = r - (low ? radius_from : radius_to);
      const double distance = std::sqrt(dz * dz + dr * dr);
      if (distance > 0)
        nearest = {(dz / distance) * axis + (dr / distance) * radial, distance, 0};
      else
        nearest.distance = 0;
    }
    if (!(nearest.distance < reach)) return 0;
    *out = nearest;
    return 1;
  }

 private:
  struct Radial {
    Vec3d direction;  // [-] unit, across the axis
    double distance;  // [m] from the axis
  };

  /// True, without a square root, for most centres farther than `reach` from a straight wall.
  bool is_far(const Vec3d& arm, const Vec3d& along, double reach) const {
    if (radius_from != radius_to) return false;
    constexpr double rounding = 1e-9;
    const double L2 = dot(along, along), z = dot(arm, along);  // [m2]
    const double across2 = dot(arm, arm) * L2 - z * z;         // [m4]
    const double edge = side == Side::Outside ? radius_from + reach : radius_from - reach;
    if (!(edge > 0)) return false;
    const double margin = rounding * dot(arm, arm) * L2;
    return side == Side::Outside ? across2 - margin > edge * edge * L2
                                 : across2 + margin < edge * edge * L2;
  }

  /// Radial unit vector and distance of a centre at `arm` from the start of the axis. On the axis,
  /// to round-off, the direction is arbitrary: the one nearest to the least aligned coordinate
  /// axis.
  static Radial split_radial(const Vec3d& arm, double z, const Vec3d& axis, double length) {
    constexpr double round_off = 1e-14;
    Vec3d across = arm - z * axis;
    double r = norm(across);
    if (!(r > round_off * std::max(std::abs(z), length))) {
      const double ax = std::abs(axis.x), ay = std::abs(axis.y), az = std::abs(axis.z);
      across = ax <= ay && ax <= az ? Vec3d{1, 0, 0} : ay <= az ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
    }
    across -= dot(across, axis) * axis;  // twice: cancellation leaves an axial part
    return {normalised(across), r};
  }

  /// Half width of the unit disc across the axis, in a direction with the axis component `a`.
  static double span(double a) { return std::sqrt(std::max(0.0, 1 - a * a)); }
};

}  // namespace detail
}  // namespace silt
