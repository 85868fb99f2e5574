// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/shape/rigid_pose.hpp>

/// Volume, centroid and inertia of any solid inside closed triangles, convex or not, and the frame
/// in which its inertia is diagonal.
///
/// With det = a . (b x c) of an outward triangle (a, b, c), all about one origin,
///   6 V = sum det,   24 V centroid = sum det (a + b + c),                                     (1)
///   S_ij = int x_i x_j dV = sum det/120 [ (a+b+c)_i (a+b+c)_j + a_i a_j + b_i b_j + c_i c_j ] (2)
///   inertia = tr(S) 1 - S, about the centroid by the parallel-axis rule.                      (3)
/// Source: the divergence theorem on tetrahedra (origin, a, b, c); B. Mirtich, Fast and accurate
///         computation of polyhedral mass properties, J. Graphics Tools 1 (1996), has the same.
/// Units:  density 1: volumes in [m3], inertia in [m5]; times density gives [kg m2].
/// Tests:  tests/shape/polyhedron.cpp (box, tetrahedron, turned and shifted ones)

namespace silt::inline SILT_TARGET {

/// A symmetric 3 x 3 tensor.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  double trace() const { return xx + yy + zz; }
  /// Adds `weight` p p^T.
  void add_square(const Vec3d& p, double weight) {
    xx += weight * p.x * p.x, yy += weight * p.y * p.y, zz += weight * p.z * p.z;
    xy += weight * p.x * p.y, xz += weight * p.x * p.z, yz += weight * p.y * p.z;
  }
};

struct MassProperties {
  double volume = 0;        // [m3]
  Vec3d centroid{0, 0, 0};  // [m]
  Symmetric3 inertia;       // [m5] about the centroid, for density 1
};

/// Sums of 1, x and x x^T over a volume; what a quadrature collects.
struct VolumeMoments {
  double volume = 0;     // [m3]
  Vec3d first{0, 0, 0};  // [m4]
  Symmetric3 second;     // [m5]

  void add(const Vec3d& point, double weight) {
    volume += weight, first += weight * point, second.add_square(point, weight);
  }
  /// `origin`: where these moments have their zero.
  MassProperties mass_properties(const Vec3d& origin) const {
    const Vec3d c = first * (1 / volume);
    Symmetric3 s = second;
    s.add_square(c, -volume);
    const double t = s.trace();
    return {volume, origin + c, {t - s.xx, t - s.yy, t - s.zz, -s.xy, -s.xz, -s.yz}};
  }
};

/// (1) and (2) about `origin`.
inline VolumeMoments volume_moments(const std::vector<std::array<Vec3d, 3>>& triangles,
                                    const Vec3d& origin) {
  VolumeMoments m;
  for (const auto& triangle : triangles) {
    const Vec3d a = triangle[0] - origin, b = triangle[1] - origin, c = triangle[2] - origin;
    const double det = dot(a, cross(b, c));
    const Vec3d sum = a + b + c;
    m.volume += det / 6;
    m.first += (det / 24) * sum;
    m.second.add_square(sum, det / 120);
    for (const auto& corner : {a, b, c}) m.second.add_square(corner, det / 120);
  }
  return m;
}

inline MassProperties mass_properties(const std::vector<std::array<Vec3d, 3>>& triangles) {
  require(!triangles.empty(), "mass_properties: no triangles given");
  Vec3d origin{0, 0, 0};  // amidst the corners, against cancellation far from zero
  for (const auto& [a, b, c] : triangles) origin += a + b + c;
  origin *= 1 / (3.0 * static_cast<double>(triangles.size()));
  const auto moments = volume_moments(triangles, origin);
  require(moments.volume > 0, "mass_properties: the triangles enclose ", moments.volume,
          " [m3]; they must be closed and turn counter-clockwise seen from outside");
  return moments.mass_properties(origin);
}

struct PrincipalFrame {
  Vec3d moments;        // [m5] of inertia about x, y, z of `axes`
  RotationMatrix axes;  // right-handed, the principal axes in the frame of the tensor
};

/// Diagonalises by Jacobi's rotations, to rounding. A tensor that is diagonal keeps its axes.
inline PrincipalFrame principal_frame(const Symmetric3& t) {
  double a[3][3] = {{t.xx, t.xy, t.xz}, {t.xy, t.yy, t.yz}, {t.xz, t.yz, t.zz}};
  Vec3d v[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double negligible = 1e-16 * std::abs(t.trace());
  for (int sweep = 0; sweep < 30; ++sweep) {
    if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) <= negligible) break;
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (std::abs(a[p][q]) <= 1e-3 * negligible) continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      const double tangent =
          (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(tangent * tangent + 1), s = tangent * c;
      for (auto& row : a) {
        const double ap = row[p], aq = row[q];
        row[p] = c * ap - s * aq, row[q] = s * ap + c * aq;
      }
      for (int k = 0; k < 3; ++k) {
        const double ap = a[p][k], aq = a[q][k];
        a[p][k] = c * ap - s * aq, a[q][k] = s * ap + c * aq;
      }
      const Vec3d vp = v[p], vq = v[q];
      v[p] = c * vp - s * vq, v[q] = s * vp + c * vq;
    }
  }
  return {{a[0][0], a[1][1], a[2][2]}, {v[0], v[1], cross(v[0], v[1])}};
}

}  // namespace silt
