// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/shape/narrow/penetration.hpp>
#include <silt/shape/narrow/solid_edges.hpp>
#include <silt/shape/narrow/solid_planes.hpp>
#include <silt/shape/narrow/surface_depth.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Contacts of one body with a mesh: faces first, then edges, then vertices.
template <class Body>
class MeshContacts {
 public:
  MeshContacts(const Body& body, const TriangleMesh& mesh,
               std::span<const std::uint32_t> candidates)
      : body_(body),
        mesh_(mesh),
        candidates_(candidates),
        centre_(centre_of(body)),
        bound_(bound_of(body)) {
    // A plane that separates a triangle from the body separates its edges and vertices too.
    std::array<std::uint32_t, 64> list;
    std::size_t open = 0;
    for (const auto t : candidates)
      if (add_face(t) && open++ < list.size()) list[open - 1] = t;
    const std::span<const std::uint32_t> reached =
        open <= list.size() ? std::span<const std::uint32_t>(list.data(), open) : candidates;
    const auto& topology = mesh.topology();
    for (const auto t : reached)
      for (const auto edge : topology.edges_of[t])
        if (topology.triangles_at_edge[edge][0] == t) add_edge(edge);
    for (const auto t : reached)
      for (const auto v : mesh.triangles()[t])
        if (topology.triangles_at_vertex[v][0] == t) add_vertex(v);
  }

  /// From the deepest to the least deep, without duplicates (b).
  void write(DeepestContacts& deepest) const {
    std::array<const SolidContact*, most> kept;
    std::size_t count = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      const SolidContact& c = found_[k].contact;
      if (std::none_of(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const SolidContact* deeper) { return is_same(*deeper, c); }))
        kept[count++] = &c, deepest.add(c);
    }
  }

 private:
  static constexpr bool polyhedron = std::is_same_v<Body, PlacedPolyhedron>;
  static constexpr std::size_t most = 32, most_planes = 8;

  /// A plane of triangles, relative to the body, and the contact with all of it.
  struct FacePlane {
    Vec3d at, normal;
    SolidContact contact;
    bool parts;  // the body does not reach it
  };

  struct Found {
    SolidContact contact;
    Vec3d at;     // [m] a point of the wall
    double rank;  // [m]
    bool face;
  };

  const Vec3d& corner(std::uint32_t triangle, std::size_t k) const {
    return mesh_.vertices()[mesh_.triangles()[triangle][k]];
  }

  /// Distance of the projection of p outside the triangle.
  double beside(std::uint32_t t, const Vec3d& p) const {
    const auto& topology = mesh_.topology();
    double most_beside = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& edge = topology.edges[topology.edges_of[t][k]];
      const double turn = edge.from == mesh_.triangles()[t][k] ? 1 : -1;
      const Vec3d out = turn * cross(edge.direction, mesh_.normals()[t]);
      most_beside = std::max(most_beside, dot(p - corner(t, k), out));
    }
    return most_beside;
  }

  /// Adds the contact with a triangle's face; false if its plane separates body and triangle.
  bool add_face(std::uint32_t t) {
    const Vec3d& at = corner(t, 0);
    Vec3d normal = mesh_.normals()[t];
    double height = dot(centre_ - at, normal);
    if (height < 0) normal = -normal, height = -height;
    if (!(height < bound_)) return false;
    if constexpr (polyhedron) {
      return add_corners(t, at, normal, height);
    } else {
      const FacePlane& plane = plane_of(at, normal);
      if (plane.parts) return false;
      const SolidContact& c = plane.contact;
      if (c.overlap > 0 && beside(t, c.point) <= mesh_.round_off() &&
          in_sight(t, c.point - dot(c.point - at, normal) * normal))
        keep(c, true, at);
      return true;
    }
  }

  /// Plane of a triangle; that of an earlier one if it is the same.
  const FacePlane& plane_of(const Vec3d& at, const Vec3d& normal) {
    for (std::size_t k = 0; k < std::min(planes_, most_planes); ++k) {
      const FacePlane& p = plane_[k];
      const Vec3d turn = p.normal - normal;
      if (dot(turn, turn) <= 1e-26 && std::abs(dot(p.normal, at - p.at)) <= mesh_.round_off())
        return p;
    }
    FacePlane& next = plane_[planes_++ % most_planes];
    next = {at, normal, {}, false};
    next.contact = half_space_contact(body_, at, normal);
    next.parts = !(next.contact.overlap > 0);
    return next;
  }

  bool add_corners(std::uint32_t t, const Vec3d& at, const Vec3d& normal, double height) {
    const Vec3d n = body_.pose.turn.back(normal);
    const auto& corners = body_.shape->vertices();
    const double r = body_.shape->radius();
    bool reached = false;
    for (std::uint32_t v = 0; v < corners.size(); ++v) {
      const double above = height + dot(n, corners[v]);
      reached |= above < r;
      if (!(above < r && above > -r)) continue;
      const Vec3d p = body_.pose.to_space(corners[v]);
      if (beside(t, p) <= mesh_.round_off() && in_sight(t, p - above * normal))
        keep(corner_contact(body_, v, p, above, normal), true, at);
    }
    return reached;
  }

  /// Whether no other triangle hides the point p of t from the centre: the far slope of a ridge is
  /// seen from its back. In a concave crease the body penetrates slightly into its other side,
  /// beyond which t protrudes.
  bool in_sight(std::uint32_t t, const Vec3d& p) const {
    const Vec3d ray = p - centre_;
    for (const auto other : candidates_) {
      const Vec3d &n = mesh_.normals()[other], &at = corner(other, 0);
      const double from = dot(centre_ - at, n), to = from + dot(ray, n);
      if (other == t || !(from * to < 0)) continue;
      const double part = from / (from - to);
      if (beside(other, centre_ + part * ray) > 0) continue;
      bool behind = true;
      for (std::size_t k = 0; k < 3; ++k)
        behind &= std::copysign(1.0, from) * dot(corner(t, k) - at, n) <= mesh_.plane_tolerance();
      if (behind || part < 0.9) return false;
    }
    return true;
  }

  /// The same point of the body on a smooth continuation of the surface.
  bool is_same(const SolidContact& a, const SolidContact& b) const {
    if (dot(a.normal, b.normal) <= mesh_.cos_smooth_angle()) return false;
    constexpr auto corners = Polyhedron::most_vertices;
    if (a.feature != b.feature && a.feature < corners && b.feature < corners) return false;
    const double turn = norm(a.normal - b.normal);
    const double near = 1.5 * std::max(a.R_eff, b.R_eff) * turn + mesh_.plane_tolerance();
    return norm(a.point - b.point) <= near;
  }

  /// Inserts a contact by depth; among equally deep ones, within the tolerance of a plane, faces
  /// first.
  void keep(const SolidContact& c, bool face, const Vec3d& at) {
    const double rank = c.overlap + (face ? mesh_.plane_tolerance() : 0);
    if (count_ == most && !(rank > found_[most - 1].rank)) return;
    std::size_t k = count_ < most ? count_++ : most - 1;
    for (; k > 0 && rank > found_[k - 1].rank; --k) found_[k] = found_[k - 1];
    found_[k] = {c, at, rank, face};
  }

  void keep(const FeatureDepth& found, std::uint32_t number) {
    for (std::size_t k = 0; k < count_ && !polyhedron; ++k) {
      const auto& [face, at, rank, is_face] = found_[k];
      const double flat = mesh_.plane_tolerance() + 1e-4 * norm(found.at - face.point);
      if (is_face && std::abs(dot(found.at - at, face.normal)) <= flat) return;  // (a)
    }
    SolidContact out;
    out.normal = found.normal, out.overlap = found.depth;
    out.point = found.at - (0.5 * found.depth) * found.normal;
    out.R_eff = contact_radius_at(body_, -found.normal);
    out.feature = static_cast<std::uint32_t>(Polyhedron::most_vertices) + number;
    keep(out, false, found.at);
  }

  /// Whether the surface protrudes at one of its points towards n: none of the triangles at the
  /// point rises above the plane across n.
  bool sticks_out(const Vec3d& p, const Vec3d& n) const {
    const double tolerance = mesh_.plane_tolerance();
    for (const auto t : candidates_) {
      if (std::abs(dot(p - corner(t, 0), mesh_.normals()[t])) > tolerance) continue;
      bool rises = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d arm = corner(t, k) - p;
        const double up = dot(arm, n);
        rises |= up > tolerance && up * up > 1e-16 * dot(arm, arm);
      }
      if (rises && beside(t, p) <= tolerance) return false;
    }
    return true;
  }

  void add_edge(std::uint32_t number) {
    const auto& topology = mesh_.topology();
    const auto& edge = topology.edges[number];
    const Vec3d& from = mesh_.vertices()[edge.from];
    const Vec3d across = cross(centre_ - from, edge.direction);
    if (!(dot(across, across) < bound_ * bound_)) return;
    const auto sharing = topology.triangles_at_edge[number];
    if (sharing.size() == 2 && !may_stick_out(number, sharing[0], sharing[1])) return;
    const auto found = edge_depth(body_, from, edge.direction, edge.length);
    if (!found || !sticks_out(found->at, found->normal)) return;
    if (sharing.size() == 1 && goes_on(number, sharing[0], found->at)) return;
    keep(*found, static_cast<std::uint32_t>(mesh_.triangles().size()) + number);
  }

  /// Not an edge within a plane, and not in a concave crease seen from the body.
  bool may_stick_out(std::uint32_t edge, std::uint32_t a, std::uint32_t b) const {
    const double b_over_a = over(edge, a, b), a_over_b = over(edge, b, a);
    const double flat = mesh_.plane_tolerance();
    if (std::abs(b_over_a) <= flat && std::abs(a_over_b) <= flat)  // or folded back on itself
      return dot(inwards(edge, a), inwards(edge, b)) > 0;
    return b_over_a <= flat || a_over_b <= flat;
  }
  /// [m] height of the free corner of `other` over the plane of t, on the side of the body.
  double over(std::uint32_t edge, std::uint32_t t, std::uint32_t other) const {
    const Vec3d& n = mesh_.normals()[t];
    const double side = dot(centre_ - corner(t, 0), n) < 0 ? -1 : 1;
    return side * dot(opposite(edge, other) - corner(t, 0), n);
  }
  const Vec3d& opposite(std::uint32_t edge, std::uint32_t t) const {
    const auto& e = mesh_.topology().edges[edge];
    std::size_t k = 0;
    while (k < 2 && (mesh_.triangles()[t][k] == e.from || mesh_.triangles()[t][k] == e.to)) ++k;
    return corner(t, k);
  }
  /// From an edge to the free corner of t.
  Vec3d inwards(std::uint32_t edge, std::uint32_t t) const {
    const auto& e = mesh_.topology().edges[edge];
    const Vec3d arm = opposite(edge, t) - mesh_.vertices()[e.from];
    return arm - dot(arm, e.direction) * e.direction;
  }

  /// Whether a triangle without common corners continues the plane of t beyond its edge at p.
  bool goes_on(std::uint32_t edge, std::uint32_t t, const Vec3d& p) const {
    const double tolerance = mesh_.plane_tolerance();
    const Vec3d beyond = p - (10 * tolerance) * normalised(inwards(edge, t));
    for (const auto other : candidates_)
      if (other != t && std::abs(dot(mesh_.normals()[other], mesh_.normals()[t])) > 1 - 1e-8 &&
          std::abs(dot(p - corner(other, 0), mesh_.normals()[other])) <= 2 * tolerance &&
          beside(other, beyond) <= 2 * tolerance)
        return true;
    return false;
  }

  void add_vertex(std::uint32_t v) {
    const Vec3d& p = mesh_.vertices()[v];
    const Vec3d arm = p - centre_;
    if (!(dot(arm, arm) < bound_ * bound_)) return;
    const auto found = vertex_depth(body_, p, [&](const auto& use) {
      for (const auto t : mesh_.topology().triangles_at_vertex[v])
        for (std::size_t k = 0; k < 3; ++k) use(corner(t, k));
    });
    if (!found || !sticks_out(p, found->normal)) return;
    if (polyhedron && (flat_along_edge(v, found->normal) || !is_tip(v))) return;
    const auto before = mesh_.triangles().size() + mesh_.topology().edges.size();
    keep(*found, static_cast<std::uint32_t>(before) + v);
  }

  /// Whether a vertex is not within a plane or on a straight edge, where a nearly flat body touches
  /// with its corners or along that edge.
  bool is_tip(std::uint32_t v) const {
    const auto& topology = mesh_.topology();
    std::array<Vec3d, 2> along;
    double shorter = std::numeric_limits<double>::infinity();
    std::size_t count = 0;
    for (const auto t : topology.triangles_at_vertex[v])
      for (const auto number : topology.edges_of[t]) {
        const auto& edge = topology.edges[number];
        const auto sharing = topology.triangles_at_edge[number];
        if ((edge.from != v && edge.to != v) || sharing[0] != t) continue;
        if (sharing.size() == 1 ? goes_on(number, t, mesh_.vertices()[v])
                                : sharing.size() == 2 && !may_stick_out(number, t, sharing[1]))
          continue;
        if (count == 2) return true;
        along[count++] = (edge.from == v ? 1. : -1.) * edge.direction;
        shorter = std::min(shorter, edge.length);
      }
    if (count < 2) return count == 1;
    const bool straight = dot(along[0], along[1]) < 0 &&
                          norm(cross(along[0], along[1])) * shorter <= mesh_.plane_tolerance();
    return !straight;
  }

  /// Whether one of the edges at a vertex is across n: then the edge touches.
  bool flat_along_edge(std::uint32_t v, const Vec3d& n) const {
    const Vec3d& p = mesh_.vertices()[v];
    for (const auto t : mesh_.topology().triangles_at_vertex[v])
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d arm = corner(t, k) - p;
        const double up = dot(arm, n);
        if (mesh_.triangles()[t][k] != v && up * up <= 1e-18 * dot(arm, arm)) return true;
      }
    return false;
  }

  const Body& body_;
  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> candidates_;
  const Vec3d& centre_;
  double bound_;
  std::array<Found, most> found_;
  std::size_t count_ = 0;
  std::array<FacePlane, most_planes> plane_;
  std::size_t planes_ = 0;
};

}  // namespace detail

/// Contacts with a mesh, which is solid from both sides: the body is on the side of its centre, and
/// no deeper. `candidates`: any triangles in ascending order that include all nearer to the centre
/// than the bounding radius (TriangleMesh::triangles_near).
///
/// Sharp polyhedra: surface_contacts(), on coarse and fine meshes. Others:
///
///   faces     as the triangle's plane (plane_contacts), if the contact's point is over the
///             triangle; for a rounded polyhedron the corner
///   edges     minimum over unit m across the edge of h(-m) - m . (centre - edge)
///   vertices  smallest depth of the point in the body
///
/// An edge or vertex counts where it protrudes: no triangle at the contact's point rises above the
/// plane across the normal. As for TriangleMesh, contacts do not depend on the triangulation: edges
/// within a plane and seams of patches do not count. For a super-ellipsoid, (a) an edge or vertex
/// in the plane of a face contact is omitted; (b) of contacts with normals within `smooth_angle`
/// and points as close to each other as on a body of the contact's radius, the deepest is kept.
///
/// Features: 0 for faces, for those of a rounded polyhedron the number of its corner; for edges and
/// vertices most_vertices + that of TriangleMesh. Contacts of one feature differ in their normals.
///
/// Valid:   up to 32 contacts. Smooth bodies at edges and vertices: overlaps below the radius of
///          curvature, otherwise the way out nearest to that of the body's gauge. Contacts jump, as
///          for spheres, in hollows and at saddles, where a point that is no longer a minimum still
///          overlaps; where two ways out of a corner are equally short (the normal); and when a
///          rounded corner leaves the last triangle of a plane while it is not the nearest point.
///          Sharp polyhedra do not jump.
/// Tests:   tests/shape/solid_mesh_contacts.cpp, surface_depth.cpp
template <class Body>
int mesh_contacts(const Body& body, const TriangleMesh& mesh,
                  std::span<const std::uint32_t> candidates, SolidContact* out, int most) {
  if constexpr (std::is_same_v<Body, PlacedPolyhedron>)
    if (body.shape->radius() == 0) return surface_contacts(body, mesh, candidates, out, most);
  detail::DeepestContacts deepest{out, most};
  detail::MeshContacts<Body>(body, mesh, candidates).write(deepest);
  return deepest.count;
}

}  // namespace silt
