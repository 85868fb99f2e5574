// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Unit quaternion w + x i + y j + z k: a rotation that maps body axes to space axes. `Real` is
/// `double` or a SIMD batch.
template <class Real>
struct BasicQuaternion {
  Real w = Real(1), x = Real(0), y = Real(0), z = Real(0);

  Vec3<Real> vector() const { return {x, y, z}; }
  friend SILT_INLINE BasicQuaternion operator*(const BasicQuaternion& a, const BasicQuaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend bool operator==(const BasicQuaternion&, const BasicQuaternion&) = default;
};
using Quaternion = BasicQuaternion<double>;

/// Inverse rotation.
template <class Real>
SILT_INLINE BasicQuaternion<Real> conjugate(const BasicQuaternion<Real>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

namespace detail {
/// The same direction with length 1.
[[gnu::cold]] inline Vec3d unit_axis(const Vec3d& axis, double angle) {
  const double length = norm(axis);
  require(std::isfinite(length) && length > 0 && std::isfinite(angle),
          "rotation_about: axis = ", axis, " [-] and angle = ", angle,
          " [rad] must be finite, and the axis not zero");
  return axis * (1 / length);
}
}  // namespace detail

/// The rotation by `angle` [rad] about `axis` (any length), by the right-hand rule. InputError for
/// an axis of length 0, or a value that is not finite.
inline Quaternion rotation_about(Vec3d axis, double angle) {
  // An axis of length 1 to rounding stays as it is: runs keep their last bits.
  if (!(std::abs(dot(axis, axis) - 1) < 1e-12 && std::isfinite(angle)))
    axis = detail::unit_axis(axis, angle);
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

/// `v` rotated by `q`.
template <class Real>
SILT_INLINE Vec3<Real> rotate(const BasicQuaternion<Real>& q, const Vec3<Real>& v) {
  const Vec3<Real> u = q.vector();
  const Vec3<Real> t = Real(2) * cross(u, v);
  return v + q.w * t + cross(u, t);
}

inline Vec3d rotate(const Quaternion& q, const Vec3d& v) { return rotate<double>(q, v); }

}  // namespace silt
