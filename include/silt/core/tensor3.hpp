// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/symmetric3.hpp>

namespace silt::inline SILT_TARGET {

/// Tensor of three dimensions, row by row.
struct Tensor3 {
  double xx = 0, xy = 0, xz = 0, yx = 0, yy = 0, yz = 0, zx = 0, zy = 0, zz = 0;

  Tensor3& operator+=(const Tensor3& b) {
    xx += b.xx, xy += b.xy, xz += b.xz, yx += b.yx, yy += b.yy, yz += b.yz;
    zx += b.zx, zy += b.zy, zz += b.zz;
    return *this;
  }
  friend Tensor3 operator+(Tensor3 a, const Tensor3& b) { return a += b; }
  friend Tensor3 operator*(double s, Tensor3 a) {
    a.xx *= s, a.xy *= s, a.xz *= s, a.yx *= s, a.yy *= s, a.yz *= s;
    a.zx *= s, a.zy *= s, a.zz *= s;
    return a;
  }
  double trace() const { return xx + yy + zz; }
};

/// a b^T
inline Tensor3 dyad(const Vec3d& a, const Vec3d& b) {
  return {a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.x, a.y * b.y,
          a.y * b.z, a.z * b.x, a.z * b.y, a.z * b.z};
}
inline Tensor3 full(const Symmetric3& s) {
  return {s.xx, s.xy, s.zx, s.xy, s.yy, s.yz, s.zx, s.yz, s.zz};
}

}  // namespace silt
