// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/lanes.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/symmetric3.hpp>

/// Pose of a body, the input of the narrow phases. A matrix is used, as many vectors are rotated.
/// Tests: tests/shape/polyhedron.cpp

namespace silt::inline SILT_TARGET {

/// Rotation by its columns: the body's axes in space.
struct RotationMatrix {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  friend SILT_INLINE Vec3d operator*(const RotationMatrix& r, const Vec3d& v) {
    return v.x * r.x + v.y * r.y + v.z * r.z;
  }
  /// Inverse rotation: space to body.
  SILT_INLINE Vec3d back(const Vec3d& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

/// Matrix of a rotation.
inline RotationMatrix rotation_matrix(const Quaternion& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)},
          {2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)},
          {2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)}};
}

/// A tensor in the body's axes, transformed to space.
inline Symmetric3 turned(const RotationMatrix& r, const Symmetric3& s) {
  return tensor_along(r.x, r.y, r.z, s);
}

/// Position and orientation of a body.
struct RigidPose {
  Vec3d position{0, 0, 0};  // [m] of the body's origin
  RotationMatrix turn;      // body to space

  RigidPose() = default;
  RigidPose(const Vec3d& at, const RotationMatrix& r) : position(at), turn(r) {}
  RigidPose(const Vec3d& at, const Quaternion& q) : position(at), turn(rotation_matrix(q)) {}

  SILT_INLINE Vec3d to_space(const Vec3d& p) const { return position + turn * p; }
  SILT_INLINE Vec3d to_body(const Vec3d& p) const { return turn.back(p - position); }
};

}  // namespace silt
