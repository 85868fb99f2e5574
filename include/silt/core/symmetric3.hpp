// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET {

/// Symmetric tensor of three dimensions.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  Symmetric3& operator+=(const Symmetric3& b) {
    xx += b.xx, yy += b.yy, zz += b.zz, xy += b.xy, yz += b.yz, zx += b.zx;
    return *this;
  }
  friend Symmetric3 operator*(double s, Symmetric3 a) {
    a.xx *= s, a.yy *= s, a.zz *= s, a.xy *= s, a.yz *= s, a.zx *= s;
    return a;
  }
  double trace() const { return xx + yy + zz; }
};

/// v v^T
inline Symmetric3 outer(const Vec3d& v) {
  return {v.x * v.x, v.y * v.y, v.z * v.z, v.x * v.y, v.y * v.z, v.z * v.x};
}

/// Tensor with these components along the axes x, y and z.
inline Symmetric3 tensor_along(const Vec3d& x, const Vec3d& y, const Vec3d& z,
                               const Symmetric3& s) {
  const Vec3d a = s.xx * x + s.xy * y + s.zx * z, b = s.xy * x + s.yy * y + s.yz * z,
              c = s.zx * x + s.yz * y + s.zz * z;
  return {a.x * x.x + b.x * y.x + c.x * z.x, a.y * x.y + b.y * y.y + c.y * z.y,
          a.z * x.z + b.z * y.z + c.z * z.z, a.x * x.y + b.x * y.y + c.x * z.y,
          a.y * x.z + b.y * y.z + c.y * z.z, a.z * x.x + b.z * y.x + c.z * z.x};
}

/// Principal values and axes: tensor = R diag(values) R^T, R the rotation `axes`.
struct Principal {
  Vec3d values;
  Quaternion axes;
};

/// Rotation whose columns are three right-handed orthonormal vectors. Uses the largest of the four
/// possible divisors (Shepperd, J. Guid. Control 1 (1978) 223).
inline Quaternion rotation_of(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  const double four[4] = {1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z,
                          1 - x.x - y.y + z.z};
  int k = 0;
  for (int n = 1; n < 4; ++n)
    if (four[n] > four[k]) k = n;
  const double s = std::sqrt(four[k]), d = 0.5 / s;
  const double a = (y.z - z.y) * d, b = (z.x - x.z) * d, c = (x.y - y.x) * d;
  const double e = (x.y + y.x) * d, f = (y.z + z.y) * d, g = (z.x + x.z) * d;
  if (k == 0) return {s / 2, a, b, c};
  if (k == 1) return {a, s / 2, e, g};
  if (k == 2) return {b, e, s / 2, f};
  return {c, g, f, s / 2};
}

/// By cyclic Jacobi rotations, to rounding. Values are in the order of the nearest axes.
/// Source: Golub and Van Loan, Matrix Computations, 8.5.
inline Principal principal(const Symmetric3& t) {
  double a[3][3] = {{t.xx, t.xy, t.zx}, {t.xy, t.yy, t.yz}, {t.zx, t.yz, t.zz}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 32; ++sweep) {
    bool done = true;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(a[p][q]) <= 1e-17 * std::sqrt(std::abs(a[p][p] * a[q][q]))) continue;
        done = false;
        // The smaller of the two rotations that make a[p][q] zero.
        const double half = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
        const double tangent = std::copysign(1.0, half) / (std::abs(half) + std::hypot(half, 1.0));
        const double c = 1 / std::hypot(tangent, 1.0), s = c * tangent;
        for (auto& row : a)
          row[p] = c * row[p] - s * std::exchange(row[q], s * row[p] + c * row[q]);
        for (int k = 0; k < 3; ++k)
          a[p][k] = c * a[p][k] - s * std::exchange(a[q][k], s * a[p][k] + c * a[q][k]);
        for (auto& row : v)
          row[p] = c * row[p] - s * std::exchange(row[q], s * row[p] + c * row[q]);
      }
    if (done) break;
  }
  const Vec3d x{v[0][0], v[1][0], v[2][0]}, y{v[0][1], v[1][1], v[2][1]};
  return {{a[0][0], a[1][1], a[2][2]}, rotation_of(x, y, cross(x, y))};
}

}  // namespace silt
