// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/triangle_mesh.hpp>

/// Third part of TriangleMesh: inside test and nearest point.

namespace silt::inline SILT_TARGET {

inline double TriangleMesh::sum_of_volumes() const {
  const Vec3d origin = bounds().centre();
  double six_times = 0;
  for (const auto& [i, j, k] : triangles_)
    six_times += dot(vertices_[i] - origin, cross(vertices_[j] - origin, vertices_[k] - origin));
  return six_times / 6;
}

inline bool TriangleMesh::contains(const Vec3d& point) const {
  require(closed_,
          "TriangleMesh::contains: the mesh is not closed and has no inside; "
          "close its gaps and orient its triangles the same way");
  if (!bounds().contains(point)) return false;
  if (const auto turns = turns_by_ray(point)) return *turns != 0;
  return std::abs(turns_by_solid_angle(point)) > 0.5;
}

/// Winding number of the surface about the point: its signed crossings with the ray in +x. Empty if
/// the ray meets an edge, or the point a face, within the welding tolerance.
inline std::optional<int> TriangleMesh::turns_by_ray(const Vec3d& p) const {
  const double slack = 2 * weld_tolerance_;
  const auto ray_meets = [&](const Box& box) {
    return p.x <= box.max.x + slack && p.y >= box.min.y - slack && p.y <= box.max.y + slack &&
           p.z >= box.min.z - slack && p.z <= box.max.z + slack;
  };
  int turns = 0;
  bool sure = true;
  tree_.for_each(ray_meets, [&](std::uint32_t t) {
    Box box;
    for (const auto v : triangles_[t]) box.include(vertices_[v]);
    if (!sure || !ray_meets(box)) return;
    int left = 0;  // number of sides that the ray passes on the left of the edge
    bool on_edge = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& a = vertices_[triangles_[t][k]];
      const Vec3d edge = vertices_[triangles_[t][(k + 1) % 3]] - a;
      const double area = edge.y * (p.z - a.z) - edge.z * (p.y - a.y);
      on_edge |= std::abs(area) <= slack * std::sqrt(edge.y * edge.y + edge.z * edge.z);
      left += area > 0;
    }
    const double height = dot(p - vertices_[triangles_[t][0]], normals_[t]);
    const bool inside = left == 0 || left == 3;
    if (on_edge || (inside && std::abs(height) <= slack))
      sure = false;
    else if (inside && (height > 0) != (normals_[t].x > 0))
      turns += left == 3 ? 1 : -1;
  });
  return sure ? std::optional(turns) : std::nullopt;
}

/// The winding number from the solid angles of all triangles (van Oosterom and Strackee, IEEE
/// Trans. Biomed. Eng. 30 (1983) 125, eq. 8): an integer to round-off for every point, but slower.
inline double TriangleMesh::turns_by_solid_angle(const Vec3d& point) const {
  double half_angle = 0;
  for (const auto& [i, j, k] : triangles_) {
    const Vec3d a = vertices_[i] - point, b = vertices_[j] - point, c = vertices_[k] - point;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    half_angle += std::atan2(dot(a, cross(b, c)),
                             la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return half_angle / (2 * std::numbers::pi);
}

inline SurfacePoint TriangleMesh::nearest_point(const Vec3d& centre) const {
  const Vec3d arm = centre - vertices_[triangles_.front().front()];
  const auto best = nearest_point(centre, std::sqrt(dot(arm, arm)) * (1 + 1e-9) + 2 * tolerance_);
  require(best.has_value(), "TriangleMesh: no triangle is nearest to ", centre,
          " [m]; the point must be finite");
  return *best;
}

inline std::optional<SurfacePoint> TriangleMesh::nearest_point(const Vec3d& centre,
                                                               double reach) const {
  std::optional<SurfacePoint> best;
  tree_.for_each_nearer(centre, reach, [&](std::uint32_t t) {
    const auto found = nearest(t, centre, reach + tolerance_);
    if (!found || (best && !(found->point.distance < best->distance))) return;
    best = found->point, reach = found->point.distance;
  });
  return best;
}

}  // namespace silt
