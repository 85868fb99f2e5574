// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/mass_properties.hpp>

/// Mass properties of any solid bounded by closed triangles, convex or not.
///
/// With det = a . (b x c) of an outward triangle (a, b, c), all about one origin:
///   6 V = sum det,   24 V centroid = sum det (a + b + c),                                     (1)
///   S_ij = int x_i x_j dV = sum det/120 [ (a+b+c)_i (a+b+c)_j + a_i a_j + b_i b_j + c_i c_j ] (2)
/// Source: the divergence theorem on tetrahedra (origin, a, b, c); B. Mirtich, Fast and accurate
///         computation of polyhedral mass properties, J. Graphics Tools 1 (1996), has the same.
/// Units:  density 1.
/// Tests:  tests/shape/polyhedron.cpp (box, tetrahedron, turned and shifted ones)

namespace silt::inline SILT_TARGET {

/// Moments (1) and (2) about `origin`.
inline Moments moments_of(const DynArray<std::array<Vec3d, 3>>& triangles, const Vec3d& origin) {
  Moments m;
  for (const auto& triangle : triangles) {
    const Vec3d a = triangle[0] - origin, b = triangle[1] - origin, c = triangle[2] - origin;
    const double det = dot(a, cross(b, c));
    const Vec3d sum = a + b + c;
    m.volume += det / 6;
    m.first += (det / 24) * sum;
    for (const auto& p : {sum, a, b, c}) m.second += (det / 120) * outer(p);
  }
  return m;
}

/// From moments about `origin`.
inline MassProperties mass_properties_about(const Vec3d& origin, const Moments& moments) {
  auto out = mass_properties(moments);
  out.centroid += origin;
  return out;
}

inline MassProperties mass_properties(const DynArray<std::array<Vec3d, 3>>& triangles) {
  require(!triangles.empty(), "mass_properties: no triangles given");
  Vec3d origin{0, 0, 0};  // in the middle of the corners, against cancellation far from zero
  for (const auto& [a, b, c] : triangles) origin += a + b + c;
  origin *= 1 / (3.0 * static_cast<double>(triangles.size()));
  const auto moments = moments_of(triangles, origin);
  require(moments.volume > 0, "mass_properties: the triangles enclose ", moments.volume,
          " [m3]; they must be closed and ordered counter-clockwise seen from outside");
  return mass_properties_about(origin, moments);
}

}  // namespace silt
