// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Unit quaternion w + x i + y j + z k: a rotation that maps body axes to space axes.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend bool operator==(const Quaternion&, const Quaternion&) = default;
};

inline Quaternion conjugate(const Quaternion& q) { return {q.w, -q.x, -q.y, -q.z}; }

/// The rotation by `angle` [rad] about the unit vector `axis`.
inline Quaternion rotation_about(const Vec3d& axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

/// `v` turned by `q`.
inline Vec3d rotate(const Quaternion& q, const Vec3d& v) {
  const Vec3d u{q.x, q.y, q.z};
  const Vec3d t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

}  // namespace silt
