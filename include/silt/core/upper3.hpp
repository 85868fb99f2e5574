// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Upper triangular 3 x 3 matrix. Sums, products and inverses are upper triangular too: edges of a
/// box under shear, its velocity gradient and its deformation.
struct Upper3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  static Upper3 identity() { return {1, 1, 1, 0, 0, 0}; }
  std::array<double, 6> values() const { return {xx, yy, zz, xy, xz, yz}; }
  static Upper3 of(const std::array<double, 6>& v) { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }

  template <class Real>
  Vec3<Real> operator*(const Vec3<Real>& v) const {
    return {Real(xx) * v.x + Real(xy) * v.y + Real(xz) * v.z, Real(yy) * v.y + Real(yz) * v.z,
            Real(zz) * v.z};
  }
  Upper3 operator*(const Upper3& b) const {
    return {xx * b.xx,
            yy * b.yy,
            zz * b.zz,
            xx * b.xy + xy * b.yy,
            xx * b.xz + xy * b.yz + xz * b.zz,
            yy * b.yz + yz * b.zz};
  }
  Upper3 operator+(const Upper3& b) const {
    return {xx + b.xx, yy + b.yy, zz + b.zz, xy + b.xy, xz + b.xz, yz + b.yz};
  }
  Upper3 operator-(const Upper3& b) const { return *this + (-1) * b; }
  friend Upper3 operator*(double s, const Upper3& a) {
    return {s * a.xx, s * a.yy, s * a.zz, s * a.xy, s * a.xz, s * a.yz};
  }
  Upper3 inverse() const {
    const double x = 1 / xx, y = 1 / yy, z = 1 / zz;
    return {x, y, z, -xy * x * y, (xy * yz * y - xz) * x * z, -yz * y * z};
  }
  double determinant() const { return xx * yy * zz; }
};

/// Sum of the products of entries.
inline double inner(const Upper3& a, const Upper3& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + a.xy * b.xy + a.xz * b.xz + a.yz * b.yz;
}
/// Upper part of a b^T.
inline Upper3 upper_outer(const Vec3d& a, const Vec3d& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z, a.x * b.y, a.x * b.z, a.y * b.z};
}

}  // namespace silt
