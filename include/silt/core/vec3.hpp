// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Three Cartesian components. `Real` is `double` or a SIMD batch (one lane per pair or particle).
/// A plain aggregate, initialised by `{x, y, z}`, and stored and loaded as three Reals.
template <class Real>
struct Vec3 {
  Real x, y, z;

  constexpr Vec3& operator+=(const Vec3& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  constexpr Vec3& operator-=(const Vec3& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }
  constexpr Vec3& operator*=(const Real& s) {
    x *= s, y *= s, z *= s;
    return *this;
  }
  friend constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend constexpr Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, const Real& s) { return a *= s; }
  friend constexpr Vec3 operator*(const Real& s, Vec3 a) { return a *= s; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3d = Vec3<double>;

template <class Real>
constexpr Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Cross product.
template <class Real>
constexpr Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double norm(const Vec3d& a) { return std::sqrt(dot(a, a)); }

/// Unit vector along `a`; `a` must not be zero.
inline Vec3d normalised(const Vec3d& a) { return a * (1.0 / norm(a)); }

/// True if all three components are finite.
inline bool is_finite(const Vec3d& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

namespace detail {
/// Two unit vectors normal to the unit vector `n` and to each other.
inline std::array<Vec3d, 2> across(const Vec3d& n) {
  const Vec3d least = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalised(cross(n, least));
  return {u, cross(n, u)};
}
}  // namespace detail

}  // namespace silt
