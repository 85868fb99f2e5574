// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/triangle_mesh.hpp>

/// Second part of TriangleMesh: contacts of a sphere, from its centre.

namespace silt::inline SILT_TARGET {

/// Number of the face, edge or vertex, to round-off; `along` [m] from the start of an edge.
inline std::uint32_t TriangleMesh::feature_on(std::uint32_t edge, double along) const {
  const auto& e = topology_.edges[edge];
  const auto faces = static_cast<std::uint32_t>(triangles_.size());
  const auto faces_and_edges = faces + static_cast<std::uint32_t>(topology_.edges.size());
  if (along <= tolerance_) return faces_and_edges + e.from;
  if (along >= e.length - tolerance_) return faces_and_edges + e.to;
  return faces + edge;
}

/// Nearest point of a triangle, if nearer than `reach`. A centre over the triangle, or beside it
/// within round-off, gets exactly the normal and distance of the plane; a flat surface then has no
/// seams.
inline auto TriangleMesh::nearest(std::uint32_t triangle, const Vec3d& centre, double reach) const
    -> std::optional<Nearest> {
  const auto& corners = triangles_[triangle];
  const Vec3d& normal = normals_[triangle];
  const double height = dot(centre - vertices_[corners[0]], normal);
  if (!(std::abs(height) < reach)) return {};

  std::array<double, 3> beyond;  // [m] distance of the centre outside each side, in the plane
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& edge = topology_.edges[topology_.edges_of[triangle][k]];
    const double turn = edge.from == corners[k] ? 1 : -1;
    beyond[k] = turn * dot(centre - vertices_[corners[k]], cross(edge.direction, normal));
  }
  const auto side =
      static_cast<std::size_t>(std::max_element(beyond.begin(), beyond.end()) - beyond.begin());
  if (beyond[side] > tolerance_) return nearest_side(triangle, centre, reach, beyond, height);

  std::uint32_t feature = triangle;
  if (beyond[side] >= -tolerance_) {
    const auto number = topology_.edges_of[triangle][side];
    const auto& edge = topology_.edges[number];
    const double along = dot(centre - vertices_[edge.from], edge.direction);
    const bool past_corner = along < -tolerance_ || along > edge.length + tolerance_;
    if (past_corner) return nearest_side(triangle, centre, reach, beyond, height);
    feature = feature_on(number, along);
  }
  const Vec3d towards = height < 0 ? -normal : normal;
  return Nearest{{towards, std::abs(height), feature}, true, true};
}

/// The same for a centre beside the triangle: the nearest of the sides that it is outside of.
inline auto TriangleMesh::nearest_side(std::uint32_t triangle, const Vec3d& centre, double reach,
                                       const std::array<double, 3>& beyond, double height) const
    -> std::optional<Nearest> {
  double square = reach * reach;
  Vec3d arm{0, 0, 0};
  std::uint32_t feature = triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(beyond[k] > 0)) continue;
    const auto number = topology_.edges_of[triangle][k];
    const auto& edge = topology_.edges[number];
    const Vec3d from = centre - vertices_[edge.from];
    const double along = std::clamp(dot(from, edge.direction), 0.0, edge.length);
    const Vec3d to_centre = from - along * edge.direction;
    const double candidate = dot(to_centre, to_centre);
    if (candidate >= square) continue;
    square = candidate, arm = to_centre, feature = feature_on(number, along);
  }
  if (feature == triangle) return {};
  const double distance = std::sqrt(square);
  const Vec3d beside = arm - height * normals_[triangle];
  return Nearest{
      {arm * (1 / distance), distance, feature}, false, norm(beside) <= flatness(distance)};
}

/// True if no other triangle at this edge or vertex is nearer.
inline bool TriangleMesh::is_minimum(const Nearest& contact, const Vec3d& centre) const {
  const auto feature = contact.point.feature;
  if (feature < triangles_.size()) return true;
  const auto faces_and_edges =
      static_cast<std::uint32_t>(triangles_.size() + topology_.edges.size());
  const auto sharing =
      is_edge(feature)
          ? topology_.triangles_at_edge[feature - static_cast<std::uint32_t>(triangles_.size())]
          : topology_.triangles_at_vertex[feature - faces_and_edges];
  const double nearer = contact.point.distance - tolerance_;
  return std::none_of(sharing.begin(), sharing.end(),
                      [&](std::uint32_t t) { return nearest(t, centre, nearer).has_value(); });
}

/// True if `other` repeats the contact `deeper`: rules (a) and (b) of TriangleMesh.
inline bool TriangleMesh::is_same_contact(const Nearest& deeper, const Nearest& other) const {
  const SurfacePoint &a = deeper.point, &b = other.point;
  if (a.feature == b.feature || dot(a.normal, b.normal) > cos_smooth_) return true;
  if (other.on_face) return false;
  if (deeper.flat) return in_tangent_plane(b, a, flatness(b.distance));
  if (!is_edge(a.feature)) return false;
  const Vec3d gap = a.distance * a.normal - b.distance * b.normal;
  const Vec3d along = edge_of(a.feature).direction;
  return norm(gap - dot(gap, along) * along) <= plane_tolerance_;
}

/// Order: deepest first, then by feature. Of points equally deep within the tolerance of a plane:
/// first a point over its face, which has the exact normal of the plane; then one in the plane
/// beside its face; then one above the plane (a hanging node raised by rounding to float).
inline bool TriangleMesh::comes_before(const Nearest& a, const Nearest& b) const {
  const auto rank = [&](const Nearest& n) {
    return n.point.distance - plane_tolerance_ * (n.on_face ? 2 : n.flat ? 1 : 0);
  };
  const double rank_a = rank(a), rank_b = rank(b);
  return rank_a != rank_b ? rank_a < rank_b : a.point.feature < b.point.feature;
}

template <int Most>
int TriangleMesh::deepest_contacts(const Vec3d& centre, double reach,
                                   std::span<const std::uint32_t> candidates,
                                   SurfacePoint* out) const {
  std::array<Nearest, Most> kept;
  std::array<std::uint32_t, 64> touched;  // those in reach; only the first round scans all
  int count = 0;
  while (count < Most) {
    std::optional<Nearest> deepest;
    std::size_t in_reach = 0;
    for (const auto triangle : candidates) {
      const auto found = nearest(triangle, centre, reach);
      if (!found) continue;
      if (in_reach < touched.size()) touched[in_reach] = triangle;
      ++in_reach;
      if (deepest && !comes_before(*found, *deepest)) continue;
      const bool known = std::any_of(kept.begin(), kept.begin() + count,
                                     [&](const Nearest& k) { return is_same_contact(k, *found); });
      if (!known && is_minimum(*found, centre)) deepest = found;
    }
    if (!deepest) break;
    kept[static_cast<std::size_t>(count)] = *deepest;
    out[count++] = deepest->point;
    if (static_cast<std::size_t>(count) == in_reach) break;  // at most one per triangle
    if (in_reach <= touched.size()) candidates = {touched.data(), in_reach};
  }
  return count;
}

inline int TriangleMesh::contacts(const Vec3d& centre, double reach,
                                  std::span<const std::uint32_t> candidates,
                                  SurfacePoint* out) const {
  return deepest_contacts<max_contacts>(centre, reach, candidates, out);
}

inline bool TriangleMesh::has_more_contacts(const Vec3d& centre, double reach,
                                            std::span<const std::uint32_t> candidates) const {
  SurfacePoint points[max_contacts + 1];
  return deepest_contacts<max_contacts + 1>(centre, reach, candidates, points) > max_contacts;
}

}  // namespace silt
