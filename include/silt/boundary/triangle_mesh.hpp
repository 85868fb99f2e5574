// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <silt/boundary/mesh_topology.hpp>
#include <silt/boundary/surface_point.hpp>
#include <silt/boundary/triangle_tree.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Surface of triangles, solid from both sides. Its contacts do not depend on the triangulation.
///
/// The contacts of a sphere are the local minima of the distance from its centre to the surface,
/// each counted once. If a triangle's nearest point is on an edge or vertex, it is a minimum of the
/// whole surface only if no triangle that shares this edge or vertex is nearer. Points are taken
/// from the deepest (ties: lowest feature number) to the least deep. At most four are kept. A point
/// is dropped (a) if it is an edge or vertex in the plane of a deeper face contact, or a point on
/// the line of
///      a deeper edge contact: hanging nodes, T-junctions, patches that share no vertices;
/// (b) if its normal is within `smooth_angle` of that of a deeper one: facets that meet at a
/// smaller
///      angle are one smooth surface, such as a drum. 0 keeps every crease as drawn; otherwise a
///      sphere in a crease shallower than `smooth_angle` touches one side at a time.
///
/// Valid:   vertices within 1e-9 of the mesh's diagonal are merged; thinner triangles are dropped
///          and counted. Points count as coplanar within 2.5e-7 of the largest coordinate (rounding
///          of vertices to float in STL files) and within 1e-4 rad (its effect on the smallest
///          facets).
/// Errors:  the constructor throws InputError: no triangles, all degenerate, a vertex not finite,
///          smooth_angle outside [0, pi/2].
/// Threads: all const members may be called concurrently; contacts() does not allocate.
/// Tests:   tests/boundary/triangle_mesh.cpp, mesh_contacts.cpp
class TriangleMesh {
 public:
  static constexpr int max_contacts = 4;

  /// `smooth_angle` in [rad].
  explicit TriangleMesh(const DynArray<std::array<Vec3d, 3>>& soup,
                        double smooth_angle = std::numbers::pi / 6);

  const DynArray<Vec3d>& vertices() const { return vertices_; }  // [m]
  const DynArray<detail::VertexTriple>& triangles() const { return triangles_; }
  std::size_t dropped_triangles() const { return dropped_; }
  const DynArray<Vec3d>& normals() const { return normals_; }  // [-] of the triangles
  const detail::MeshTopology& topology() const { return topology_; }
  /// Patch of each triangle (mesh_patches.hpp).
  const DynArray<std::uint32_t>& patches() const { return patches_; }
  double cos_smooth_angle() const { return cos_smooth_; }
  double round_off() const { return tolerance_; }              // [m] in positions and distances
  double plane_tolerance() const { return plane_tolerance_; }  // [m] of vertices rounded to float

  Box bounds() const { return tree_.bounds(); }
  double area() const { return area_; }  // [m2]
  /// Enclosed volume [m3] of a closed mesh; positive if the normals point outwards. An open mesh has
  /// none: nan.
  double volume() const { return closed_ ? volume_ : std::numeric_limits<double>::quiet_NaN(); }
  /// True if the triangles are consistently oriented and leave no gap.
  bool is_closed() const { return closed_; }
  /// True if `point` is enclosed, for either orientation of the triangles. On the surface, to
  /// round-off, the result is arbitrary. InputError unless the mesh is closed.
  bool contains(const Vec3d& point) const;

  /// Triangles with distance < reach, ascending; replaces the content of `out`.
  void triangles_near(const Vec3d& centre, double reach, DynArray<std::uint32_t>& out) const;
  void triangles_near(const Vec3d& centre, double reach, std::vector<std::uint32_t>& out) const {
    DynArray<std::uint32_t> near;
    triangles_near(centre, reach, near);
    out = near;
  }

  /// Distance from `centre` to one triangle [m].
  double distance_to(std::uint32_t triangle, const Vec3d& centre) const {
    constexpr double far = std::numeric_limits<double>::infinity();
    const auto found = nearest(triangle, centre, far);
    return found ? found->point.distance : far;
  }

  /// Nearest point of the surface to `centre`, at any distance.
  SurfacePoint nearest_point(const Vec3d& centre) const;
  /// The same if nearer than `reach`; points beyond it by round-off may be found too.
  std::optional<SurfacePoint> nearest_point(const Vec3d& centre, double reach) const;

  /// `candidates`: numbers in ascending order that include all triangles with distance < reach. The
  /// feature of a contact is the number of a triangle; for an edge the number of triangles + the
  /// edge's number; for a vertex the numbers of triangles and edges + the vertex's number.
  int contacts(const Vec3d& centre, double reach, std::span<const std::uint32_t> candidates,
               SurfacePoint* out) const;
  /// True if there are more than max_contacts; contacts() then drops the least deep.
  bool has_more_contacts(const Vec3d& centre, double reach,
                         std::span<const std::uint32_t> candidates) const;

 private:
  /// Nearest point of one triangle.
  struct Nearest {
    SurfacePoint point;
    bool on_face;  // the centre is over the triangle
    bool flat;     // or beside it within the tolerance of a plane
  };

  static Box checked_bounds(const DynArray<std::array<Vec3d, 3>>& soup);
  void weld(const DynArray<std::array<Vec3d, 3>>& soup, const Vec3d& origin);
  DynArray<std::uint32_t> find_patches() const;
  std::optional<int> turns_by_ray(const Vec3d& point) const;
  double turns_by_solid_angle(const Vec3d& point) const;
  double sum_of_volumes() const;
  std::optional<Nearest> nearest(std::uint32_t triangle, const Vec3d& centre, double reach) const;
  std::optional<Nearest> nearest_side(std::uint32_t triangle, const Vec3d& centre, double reach,
                                      const std::array<double, 3>& beyond, double height) const;
  std::uint32_t feature_on(std::uint32_t edge, double along) const;
  bool is_minimum(const Nearest& contact, const Vec3d& centre) const;
  bool comes_before(const Nearest& a, const Nearest& b) const;
  bool is_same_contact(const Nearest& deeper, const Nearest& other) const;
  template <int Most>
  int deepest_contacts(const Vec3d& centre, double reach, std::span<const std::uint32_t> candidates,
                       SurfacePoint* out) const;

  /// [m] tolerance of being in a plane, at `distance` from the centre.
  double flatness(double distance) const { return plane_tolerance_ + 1e-4 * distance; }

  bool is_edge(std::uint32_t feature) const {
    return feature >= triangles_.size() && feature < triangles_.size() + topology_.edges.size();
  }
  const detail::MeshEdge& edge_of(std::uint32_t feature) const {
    return topology_.edges[feature - triangles_.size()];
  }

  double cos_smooth_;
  double weld_tolerance_ = 0;   // [m]
  double plane_tolerance_ = 0;  // [m] for vertices rounded to float
  double tolerance_ = 0;        // [m] round-off in positions and distances
  DynArray<Vec3d> vertices_;
  DynArray<detail::VertexTriple> triangles_;
  DynArray<Vec3d> normals_;
  std::size_t dropped_ = 0;
  double area_ = 0, volume_ = 0;
  bool closed_ = false;
  detail::MeshTopology topology_;
  detail::TriangleTree tree_;
  DynArray<std::uint32_t> patches_;
};

inline TriangleMesh::TriangleMesh(const DynArray<std::array<Vec3d, 3>>& soup, double smooth_angle) {
  // Numbers of faces, edges and vertices share 32 bits: at most 1 + 3 + 3 features per triangle.
  require(!soup.empty() && soup.size() < (1u << 29), "TriangleMesh: ", soup.size(),
          " triangles given; there must be at least 1 and fewer than 2^29");
  require_in("TriangleMesh: smooth_angle", smooth_angle, "rad", 0, std::numbers::pi / 2);
  cos_smooth_ = std::min(std::cos(smooth_angle), 1 - 1e-10);  // equal normals count as equal at 0
                                                              // too
  const Box all = checked_bounds(soup);
  const double largest = std::max({std::abs(all.min.x), std::abs(all.min.y), std::abs(all.min.z),
                                   std::abs(all.max.x), std::abs(all.max.y), std::abs(all.max.z)});
  weld_tolerance_ = 1e-9 * norm(all.extent());
  plane_tolerance_ = 2.5e-7 * largest;
  tolerance_ = 1e-12 * largest;
  weld(soup, all.min);
  topology_ = {vertices_, triangles_};
  DynArray<Box> boxes(triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (const auto v : triangles_[t]) boxes[t].include(vertices_[v]);
  tree_ = detail::TriangleTree(boxes);
  volume_ = sum_of_volumes();
  patches_ = find_patches();
}

inline Box TriangleMesh::checked_bounds(const DynArray<std::array<Vec3d, 3>>& soup) {
  Box all;
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (const auto& corner : soup[t]) {
      require(is_finite(corner), "TriangleMesh: triangle ", t, " (counted from 0) has the vertex ",
              corner, " [m]; vertices must be finite");
      all.include(corner);
    }
  return all;
}

inline void TriangleMesh::weld(const DynArray<std::array<Vec3d, 3>>& soup, const Vec3d& origin) {
  DynArray<detail::VertexTriple> welded;
  if (weld_tolerance_ > 0) {
    detail::VertexWelder welder(3 * soup.size(), origin, weld_tolerance_);
    for (const auto& [a, b, c] : soup) {
      // In sequence: the numbers follow the order of the corners.
      const auto i = welder.add(a), j = welder.add(b), k = welder.add(c);
      welded.push_back({i, j, k});
    }
    vertices_ = std::move(welder.points);
  }
  for (const auto& triple : welded) {
    const Vec3d ab = vertices_[triple[1]] - vertices_[triple[0]];
    const Vec3d bc = vertices_[triple[2]] - vertices_[triple[1]];
    const Vec3d ca = vertices_[triple[0]] - vertices_[triple[2]];
    const Vec3d normal = cross(ab, bc);
    const double twice_area = norm(normal);
    const double longest = std::sqrt(std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)}));
    if (!(twice_area > weld_tolerance_ * longest)) continue;
    triangles_.push_back(triple);
    normals_.push_back(normal * (1 / twice_area));
    area_ += 0.5 * twice_area;
  }
  dropped_ = soup.size() - triangles_.size();
  require(!triangles_.empty(), "TriangleMesh: all ", soup.size(),
          " triangles are degenerate (two corners in one place, or three on one line)");
  closed_ = detail::without_boundary(welded);  // includes needles that fill a T-junction
}

inline void TriangleMesh::triangles_near(const Vec3d& centre, double reach,
                                         DynArray<std::uint32_t>& out) const {
  out.clear();
  if (!(reach > 0)) return;
  tree_.for_each_near(centre, reach + tolerance_, [&](std::uint32_t t) {
    if (nearest(t, centre, reach)) out.push_back(t);
  });
  std::sort(out.begin(), out.end());
}

}  // namespace silt

#include <silt/boundary/mesh_contacts.hpp>
#include <silt/boundary/mesh_inside.hpp>
#include <silt/boundary/mesh_patches.hpp>
