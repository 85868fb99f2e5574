// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <numbers>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/shape/clip_graph.hpp>
#include <silt/shape/closed_faces.hpp>
#include <silt/shape/concept.hpp>
#include <silt/shape/rigid_pose.hpp>
#include <silt/shape/solid_mesh.hpp>
#include <silt/shape/triangle_moments.hpp>

namespace silt::inline SILT_TARGET {

/// Convex polyhedron, sharp or dilated (all points within `radius` of its core).
///
/// Corners, faces and edges are those of the core, in the frame of the points from which it was
/// made. principal_shape() of shape/dilated_moments.hpp moves it to its centroid and principal
/// axes. A face's normal points outwards; its corners are counter-clockwise seen from outside.
///
/// Valid:  up to 4000 faces (thus 8000 corners): they and all cuts of them are numbered by 16 bits.
/// Units:  [m].
/// Errors: InputError with one sentence: too few points, coplanar points (convex_hull.hpp); an
///         open, inside-out, self-touching or concave mesh (solid_mesh.hpp); faces that do not
///         bound a convex body (closed_faces.hpp); a radius below 0.
/// Tests:  tests/shape/polyhedron.cpp, tests/shape/closed_faces.cpp
/// Source: Steiner's formulas for the dilated body; hulls: shape/convex_hull.hpp; overlaps and
///         normals: shape/narrow/solid_pairs.hpp.
class Polyhedron {
 public:
  static constexpr bool is_body = true, one_part = true, is_cut_into_cells = true;
  using Kinds = KindList<Polyhedron>;
  static constexpr std::size_t most_faces = 4000, most_vertices = 2 * most_faces;
  static constexpr std::size_t block = 8;  // arrays for lanes are padded to multiples of it

  struct Face {
    Vec3d normal;                  // [-] unit
    double offset;                 // [m] normal . x on the plane
    std::uint32_t first, corners;  // of its loop
  };
  struct Edge {
    std::uint32_t from, to;     // vertices
    std::uint32_t left, right;  // faces, seen from outside along the edge
  };
  /// x, y, z and a fourth number of vertices or planes, each in its own array.
  struct Columns {
    DynArray<double> x, y, z, w;
    std::size_t padded = 0;
  };
  /// The graph with separate coordinates, padded by copies of the first vertex.
  struct GraphColumns {
    DynArray<double> x, y, z;
    DynArray<std::array<std::uint16_t, 4>> neighbour, face;  // the fourth: unused
    std::size_t size = 0;
  };

  /// Convex hull of points, dilated by `radius` [m].
  static Polyhedron from_points(const DynArray<Vec3d>& points, double radius = 0) {
    return Polyhedron(convex_hull(points), radius);
  }
  /// Closed mesh, convex to 1e-6 of its diagonal (corners rounded to float).
  static Polyhedron from_mesh(const DynArray<std::array<Vec3d, 3>>& triangles, double radius = 0) {
    const TriangleMesh mesh = solid_mesh(triangles);
    const double dent = largest_dent(mesh), diagonal = norm(mesh.bounds().extent());
    require(dent <= 1e-6 * diagonal, "Polyhedron: the mesh is not convex: a vertex is ", dent,
            " [m] outside the plane of a triangle; give convex parts, or use its convex hull");
    return Polyhedron(convex_hull(mesh.vertices()), radius);
  }

  /// From corners and faces as returned by convex_faces(). They are checked (closed_faces.hpp), and
  /// must be convex to 1e-6 of the diagonal.
  static Polyhedron from_faces(const ConvexFaces& body, double radius = 0) {
    detail::check_faces(body);
    return Polyhedron(body, radius);
  }
  /// Input of from_faces() for the same polyhedron, equal in all numbers to the last bit. Not for
  /// one that was scaled(): its numbers are rounded differently.
  ConvexFaces convex_faces() const {
    ConvexFaces out{vertices_, {}};
    for (const Face& face : faces_) out.faces.emplace_back(loop(face).begin(), loop(face).end());
    return out;
  }
  /// The same, with all numbers computed again from corners and faces.
  Polyhedron made_anew() const { return Polyhedron(convex_faces(), radius_); }

  /// Scaled by `scale` [-] about the origin.
  Polyhedron scaled(double scale) const;

  /// True if corners, faces and radius are equal, in the same order.
  bool operator==(const Polyhedron& b) const {
    return radius_ == b.radius_ && vertices_ == b.vertices_ && loops_ == b.loops_ &&
           faces_.size() == b.faces_.size();
  }

  void check() const {}  // checked when it was made
  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    visit("corners", static_cast<double>(vertices_.size()));
    visit("faces", static_cast<double>(faces_.size())), visit("dilation [m]", radius_);
    visit("corners", std::span<const Vec3d>(vertices_));
  }
  MassProperties mass_properties() const;
  /// Its part, in the principal frame.
  DynArray<SolidPart<Kinds>> solids(const MassProperties& mass) const;

  const DynArray<Vec3d>& vertices() const { return vertices_; }
  const DynArray<Face>& faces() const { return faces_; }
  const DynArray<Edge>& edges() const { return edges_; }
  std::span<const std::uint32_t> loop(const Face& face) const {
    return {loops_.data() + face.first, face.corners};
  }
  std::span<const std::uint32_t> neighbours(std::uint32_t v) const {
    return {neighbours_.data() + first_neighbour_[v],
            first_neighbour_[v + 1] - first_neighbour_[v]};
  }
  const DynArray<ClipVertex>& graph() const { return graph_; }
  const GraphColumns& graph_columns() const { return graph_columns_; }
  /// Planes (w: offset) and corners (w: 0); the last ones are repeated as padding.
  const Columns& plane_columns() const { return plane_columns_; }
  const Columns& vertex_columns() const { return vertex_columns_; }

  double radius() const { return radius_; }                    // [m] of dilation
  double bounding_radius() const { return bounding_radius_; }  // [m] about the origin, dilated
  double core_volume() const { return core_volume_; }          // [m3]
  double equal_volume_radius() const { return equal_volume_radius_; }  // [m] of the dilated body
  double core_area() const { return core_area_; }                      // [m2]
  double edge_turning() const { return edge_turning_; }  // [m] sum of length times exterior angle

  /// Volume [m3] by Steiner: V + S r + (1/2) sum L theta r^2 + (4/3) pi r^3.
  double volume() const {
    const double r = radius_, pi = std::numbers::pi;
    return core_volume_ + r * (core_area_ + r * (0.5 * edge_turning_ + r * 4 / 3 * pi));
  }
  /// Area [m2], its derivative by r: S + sum L theta r + 4 pi r^2.
  double area() const {
    return core_area_ + radius_ * (edge_turning_ + 4 * std::numbers::pi * radius_);
  }

  DynArray<std::array<Vec3d, 3>> triangles() const {
    DynArray<std::array<Vec3d, 3>> out;
    for (const auto& face : faces_) {
      const auto corner = loop(face);
      for (std::size_t k = 2; k < corner.size(); ++k)
        out.push_back({vertices_[corner[0]], vertices_[corner[k - 1]], vertices_[corner[k]]});
    }
    return out;
  }

  /// Number of the core's corner farthest along `n`. Tests all of a few corners; with many it
  /// climbs along edges from `hint`, a corner near the last result.
  std::uint32_t support_vertex(const Vec3d& n, std::uint32_t hint = 0) const {
    return vertices_.size() <= 64 ? scan(n) : climb(n, hint);
  }
  /// The core's corner farthest along `n`.
  Vec3d support(const Vec3d& n) const { return vertices_[support_vertex(n)]; }
  /// max n . x over the core: all corners, in lanes.
  double reach(const Vec3d& n) const;
  /// The face whose normal is closest to `n`: its number, and its normal times n.
  struct Facing {
    std::size_t face;
    double cosine;
  };
  Facing face_towards(const Vec3d& n) const;
  /// [rad] Smallest angle between the normals of a face and of its neighbours.
  double least_turn(std::size_t face) const { return least_turn_[face]; }

 private:
  Polyhedron(const ConvexFaces& body, double radius);
  void add_faces(const ConvexFaces& body);
  void add_edges();
  void add_columns();
  void measure();

  std::uint32_t scan(const Vec3d& n) const {
    std::uint32_t best = 0;
    double most = dot(n, vertices_[0]);
    for (std::uint32_t v = 1; v < vertices_.size(); ++v)
      if (const double h = dot(n, vertices_[v]); h > most) best = v, most = h;
    return best;
  }
  std::uint32_t climb(const Vec3d& n, std::uint32_t at) const {
    double most = dot(n, vertices_[at]);
    for (bool higher = true; higher;) {
      higher = false;
      for (const auto v : neighbours(at))
        if (const double h = dot(n, vertices_[v]); h > most) at = v, most = h, higher = true;
    }
    return at;
  }

  DynArray<Vec3d> vertices_;
  DynArray<Face> faces_;
  DynArray<Edge> edges_;
  DynArray<std::uint32_t> loops_;
  DynArray<double> least_turn_;
  DynArray<std::uint32_t> first_neighbour_, neighbours_;  // of each corner, in order
  DynArray<ClipVertex> graph_;
  GraphColumns graph_columns_;
  Columns plane_columns_, vertex_columns_;
  double radius_ = 0, bounding_radius_ = 0, core_volume_ = 0, core_area_ = 0, edge_turning_ = 0;
  double equal_volume_radius_ = 0;
};

inline Polyhedron::Polyhedron(const ConvexFaces& body, double radius)
    : vertices_(body.vertices), radius_(radius) {
  require_not_negative("Polyhedron: radius", radius, "m");
  require(body.faces.size() <= most_faces, "Polyhedron: ", body.faces.size(), " faces and ",
          vertices_.size(), " corners; at most ", most_faces, " faces are possible: simplify it");
  add_faces(body);
  add_edges();
  graph_ = detail::clip_graph(body);
  add_columns();
  measure();
}

inline void Polyhedron::add_faces(const ConvexFaces& body) {
  for (const auto& loop : body.faces) {
    const Vec3d& origin = vertices_[loop[0]];
    Vec3d twice_area{0, 0, 0}, middle{0, 0, 0};
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3d a = vertices_[loop[k]] - origin;
      twice_area += cross(a, vertices_[loop[(k + 1) % loop.size()]] - origin);
      middle += a;
    }
    const Vec3d normal = normalised(twice_area);
    middle = origin + middle * (1 / static_cast<double>(loop.size()));
    faces_.push_back({normal, dot(normal, middle), static_cast<std::uint32_t>(loops_.size()),
                      static_cast<std::uint32_t>(loop.size())});
    loops_.insert(loops_.end(), loop.begin(), loop.end());
    core_area_ += 0.5 * norm(twice_area);
  }
}

inline void Polyhedron::add_edges() {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  DynArray<DynArray<std::uint32_t>> neighbours(vertices_.size());
  DynArray<DynArray<std::uint32_t>> edges_from(vertices_.size());
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    const auto corner = loop(faces_[f]);
    for (std::size_t k = 0; k < corner.size(); ++k) {
      const auto a = corner[k], b = corner[(k + 1) % corner.size()];
      neighbours[a].push_back(b);
      const auto& back = edges_from[b];
      const auto twin = std::find_if(back.begin(), back.end(),
                                     [&](std::uint32_t e) { return edges_[e].to == a; });
      if (twin == back.end())
        edges_from[a].push_back(static_cast<std::uint32_t>(edges_.size())),
            edges_.push_back({a, b, f, none});
      else
        edges_[*twin].right = f;
    }
  }
  first_neighbour_.push_back(0);
  for (const auto& of : neighbours) {
    neighbours_.insert(neighbours_.end(), of.begin(), of.end());
    first_neighbour_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
  least_turn_.assign(faces_.size(), std::numbers::pi);
  for (const auto& edge : edges_) {
    require(edge.right != none, "Polyhedron: the faces of the convex hull do not close");
    const Vec3d &l = faces_[edge.left].normal, &r = faces_[edge.right].normal;
    const double turn = std::atan2(norm(cross(l, r)), dot(l, r));
    edge_turning_ += norm(vertices_[edge.to] - vertices_[edge.from]) * turn;
    for (const auto f : {edge.left, edge.right}) least_turn_[f] = std::min(least_turn_[f], turn);
  }
}

inline void Polyhedron::add_columns() {
  const auto put = [](Columns& c, const Vec3d& v, double w) {
    c.x.push_back(v.x), c.y.push_back(v.y), c.z.push_back(v.z), c.w.push_back(w);
    c.padded = c.x.size();
  };
  for (const auto& face : faces_) put(plane_columns_, face.normal, face.offset);
  while (plane_columns_.padded % block != 0)
    put(plane_columns_, faces_.back().normal, faces_.back().offset);
  for (const auto& v : vertices_) put(vertex_columns_, v, 0);
  while (vertex_columns_.padded % block != 0) put(vertex_columns_, vertices_.back(), 0);
  auto& g = graph_columns_;
  g.size = graph_.size();
  for (std::size_t k = 0; k < g.size || k % block != 0; ++k) {
    const auto& v = graph_[k < g.size ? k : 0];
    g.x.push_back(v.at.x), g.y.push_back(v.at.y), g.z.push_back(v.at.z);
    g.neighbour.push_back({v.neighbour[0], v.neighbour[1], v.neighbour[2], 0});
    g.face.push_back({v.face[0], v.face[1], v.face[2], 0});
  }
}

inline void Polyhedron::measure() {
  core_volume_ = moments_of(triangles(), vertices_[0]).volume;
  for (const auto& v : vertices_) bounding_radius_ = std::max(bounding_radius_, norm(v) + radius_);
  equal_volume_radius_ = std::cbrt(0.75 * volume() / std::numbers::pi);
}

namespace detail {
/// x times n at entry k of the columns, in lanes.
SILT_INLINE Lanes<DefaultArch>::Real heights_along(const Polyhedron::Columns& c, const Vec3d& n,
                                                   std::size_t k) {
  using Real = Lanes<DefaultArch>::Real;
  return Real(n.x) * load_any<Real>(&c.x[k]) + Real(n.y) * load_any<Real>(&c.y[k]) +
         Real(n.z) * load_any<Real>(&c.z[k]);
}

/// Maximum over all entries.
inline double highest_along(const Polyhedron::Columns& c, const Vec3d& n) {
  constexpr std::size_t width = Lanes<DefaultArch>::width;
  static_assert(Polyhedron::block % width == 0);
  auto most = heights_along(c, n, 0);
  for (std::size_t k = width; k < c.padded; k += width)
    most = silt::max(most, heights_along(c, n, k));
  alignas(64) double lanes[width];
  store(lanes, most);
  double highest = lanes[0];
  for (const double h : lanes) highest = h > highest ? h : highest;
  return highest;
}
}  // namespace detail

inline Polyhedron Polyhedron::scaled(double scale) const {
  Polyhedron p = *this;
  const auto stretch = [scale](DynArray<double>& values) {
    for (double& v : values) v *= scale;
  };
  for (auto& v : p.vertices_) v *= scale;
  for (auto& f : p.faces_) f.offset *= scale;
  for (auto& v : p.graph_) v.at *= scale;
  auto& g = p.graph_columns_;
  stretch(g.x), stretch(g.y), stretch(g.z), stretch(p.plane_columns_.w);
  auto& c = p.vertex_columns_;
  stretch(c.x), stretch(c.y), stretch(c.z);
  const double square = scale * scale;
  p.radius_ *= scale, p.bounding_radius_ *= scale, p.equal_volume_radius_ *= scale;
  p.edge_turning_ *= scale, p.core_area_ *= square, p.core_volume_ *= square * scale;
  return p;
}

inline double Polyhedron::reach(const Vec3d& n) const {
  return detail::highest_along(vertex_columns_, n);
}

inline Polyhedron::Facing Polyhedron::face_towards(const Vec3d& n) const {
  using Real = Lanes<DefaultArch>::Real;
  const double most = detail::highest_along(plane_columns_, n);
  for (std::size_t k = 0; k < plane_columns_.padded; k += Lanes<DefaultArch>::width)
    if (const auto bits = lane_bits(detail::heights_along(plane_columns_, n, k) >= Real(most)))
      return {std::min(k + static_cast<std::size_t>(std::countr_zero(bits)), faces_.size() - 1),
              most};
  return {0, most};  // n is NaN, or roundings differ: any face is right
}

}  // namespace silt

#include <silt/shape/dilated_moments.hpp>
