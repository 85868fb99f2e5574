// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/shape/narrow/placed_polyhedron.hpp>

namespace silt::inline SILT_TARGET {

/// Shortest translation that separates two overlapping convex sets.
struct Penetration {
  double depth = 0;        // [m] a translation of a by depth normal separates them
  double lower_bound = 0;  // [m] lower bound of depth; = depth to rounding for polyhedra
  Vec3d normal{0, 0, 1};   // [-] unit, from b to a
  Vec3d on_a{0, 0, 0}, on_b{0, 0, 0};  // [m] deepest points, depth apart along the normal
  bool flat = false;  // A - B has no volume (touching, or both in one plane): depth is 0
};

namespace detail {

/// Polytope of points of A - B around the origin that grows towards its boundary.
///
/// The nearest face gives a lower bound of the depth, the support along any normal an upper one;
/// both agree at a face of A - B. Coplanar faces end the search together, as the support adds
/// nothing.
/// Source: G. van den Bergen, Proximity queries and penetration depth computation on 3D game
///         objects, GDC 2001 (expanding polytope). Capped at 64 supports.
template <ConvexSet A, ConvexSet B>
class ExpandingPolytope {
 public:
  ExpandingPolytope(const A& a, const B& b, const Simplex& start) : a_(a), b_(b) {
    for (int k = 0; k < start.size; ++k) points_.push_back(start.corner[k]);
    for (const auto& p : points_) scale_ = std::max(scale_, norm(p.difference));
    out_.depth = std::numeric_limits<double>::infinity();
    if (complete()) grow();
    if (!(out_.depth < std::numeric_limits<double>::infinity())) out_.flat = true, out_.depth = 0;
  }
  const Penetration& result() const { return out_; }

 private:
  struct Face {
    std::size_t corner[3];
    Vec3d normal;
    double distance;
  };

  SimplexPoint support(const Vec3d& n) const {
    const Vec3d on_a = a_.support(n), on_b = b_.support(-n);
    return {on_a - on_b, on_a, on_b};
  }

  /// Adds points until four span a volume; false (with the normal of the plane) if impossible.
  bool complete() {
    const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (points_.size() < 2 && !try_both(axes[0]) && !try_both(axes[1]) && !try_both(axes[2]))
      return flat(axes[2]);
    while (points_.size() < 4) {
      const Vec3d side = points_[1].difference - points_[0].difference;
      Vec3d n{0, 0, 0};
      if (points_.size() == 3) n = cross(side, points_[2].difference - points_[0].difference);
      if (points_.size() == 2)
        for (const Vec3d& axis : axes)
          if (const Vec3d across = cross(side, axis); dot(across, across) > dot(n, n)) n = across;
      if (!(dot(n, n) > 0)) return flat(axes[2]);
      n = normalised(n);
      if (points_.size() == 2 && try_both(n)) continue;
      if (points_.size() == 2) n = normalised(cross(side, n));
      if (!try_both(n)) return flat(n);
    }
    return true;
  }
  bool flat(const Vec3d& normal) {
    out_.normal = normal;
    out_.on_a = points_[0].on_a, out_.on_b = points_[0].on_b;
    return false;
  }
  bool try_both(const Vec3d& n) {
    for (const double sign : {1.0, -1.0}) {
      const auto p = support(sign * n);
      scale_ = std::max(scale_, norm(p.difference));
      if (std::abs(dot(n, p.difference - points_[0].difference)) > 1e-12 * scale_) {
        points_.push_back(p);
        return true;
      }
    }
    return false;
  }

  /// False if its three points are collinear, to rounding.
  bool push(std::size_t i, std::size_t j, std::size_t k) {
    const Vec3d a = points_[i].difference;
    const Vec3d n = cross(points_[j].difference - a, points_[k].difference - a);
    const double length = norm(n);
    if (!(length > 1e-16 * scale_ * scale_)) return false;
    faces_.push_back({{i, j, k}, n * (1 / length), dot(n, a) / length});
    return true;
  }

  void grow() {
    const Vec3d d = points_[3].difference - points_[0].difference;
    const Vec3d n = cross(points_[1].difference - points_[0].difference,
                          points_[2].difference - points_[0].difference);
    if (dot(n, d) > 0) std::swap(points_[1], points_[2]);
    if (!push(0, 1, 2) || !push(0, 3, 1) || !push(1, 3, 2) || !push(2, 3, 0)) return;
    for (int step = 0; step < 64; ++step) {
      std::size_t nearest = 0;
      for (std::size_t f = 1; f < faces_.size(); ++f)
        if (faces_[f].distance < faces_[nearest].distance) nearest = f;
      const Face face = faces_[nearest];
      const auto p = support(face.normal);
      const double reach = dot(face.normal, p.difference);
      out_.lower_bound = std::max(out_.lower_bound, face.distance);
      const bool ended = reach - face.distance <= 1e-10 * face.distance + 1e-14 * scale_;
      if (ended || reach < out_.depth) keep(face, reach);
      if (ended) return;
      if (!add(p)) return;
    }
  }

  /// The face's point nearest to the origin, as a point of A and one of B.
  void keep(const Face& face, double reach) {
    out_.depth = reach, out_.normal = -face.normal;
    const auto &p = points_[face.corner[0]], &q = points_[face.corner[1]],
               &r = points_[face.corner[2]];
    const Vec3d foot = face.distance * face.normal;
    const Vec3d u = p.difference - foot, v = q.difference - foot, w = r.difference - foot;
    const double wp = dot(face.normal, cross(v, w)), wq = dot(face.normal, cross(w, u)),
                 wr = dot(face.normal, cross(u, v)), scale = 1 / (wp + wq + wr);
    out_.on_a = scale * (wp * p.on_a + wq * q.on_a + wr * r.on_a);
    out_.on_b = scale * (wp * p.on_b + wq * q.on_b + wr * r.on_b);
  }

  /// Replaces the faces visible from the point by a fan from their rim.
  bool add(const SimplexPoint& p) {
    DynArray<std::pair<std::size_t, std::size_t>> rim;
    DynArray<Face> kept;
    for (const auto& face : faces_) {
      if (!(dot(face.normal, p.difference) - face.distance > 1e-15 * scale_)) {
        kept.push_back(face);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::pair side{face.corner[k], face.corner[(k + 1) % 3]};
        const auto twin = std::find(rim.begin(), rim.end(), std::pair{side.second, side.first});
        if (twin == rim.end())
          rim.push_back(side);
        else
          rim.erase(twin);
      }
    }
    faces_ = std::move(kept);
    points_.push_back(p);
    for (const auto& [i, j] : rim)
      if (!push(i, j, points_.size() - 1)) return false;
    return !rim.empty();
  }

  const A& a_;
  const B& b_;
  double scale_ = 0;  // [m] of A - B
  DynArray<SimplexPoint> points_;
  DynArray<Face> faces_;
  Penetration out_;
};

/// All possible normals of the nearest face of A - B: normals of faces, and cross products of edges
/// whose arcs on the sphere of normals intersect (D. Gregorius, GDC 2013).
class SeparatingAxes {
 public:
  SeparatingAxes(const PlacedPolyhedron& a, const PlacedPolyhedron& b) : a_(a), b_(b) {
    out_.depth = std::numeric_limits<double>::infinity();
    for (const auto& face : a.shape->faces()) of_face(a.pose.turn * face.normal, true);
    for (const auto& face : b.shape->faces()) of_face(-(b.pose.turn * face.normal), false);
    DynArray<Arc> of_b;
    for (const auto& e : b.shape->edges()) of_b.push_back(arc(b, e));
    for (const auto& e : a.shape->edges()) {
      const Arc of_a = arc(a, e);
      for (const auto& other : of_b) of_edges(of_a, other);
    }
    out_.lower_bound = out_.depth;
  }
  /// depth < 0: the bodies are apart along the normal.
  const Penetration& result() const { return out_; }

 private:
  struct Arc {
    Vec3d at, along, left, right;
  };
  static Arc arc(const PlacedPolyhedron& p, const Polyhedron::Edge& e) {
    const auto& v = p.shape->vertices();
    const auto& turn = p.pose.turn;
    return {p.pose.to_space(v[e.from]), turn * (v[e.to] - v[e.from]),
            turn * p.shape->faces()[e.left].normal, turn * p.shape->faces()[e.right].normal};
  }

  /// n: outward normal of a's face, or the opposite of b's; the deepest corner of the other body.
  void of_face(const Vec3d& n, bool face_of_a) {
    const Vec3d on_a = a_.support(n), on_b = b_.support(-n);
    const double depth = dot(n, on_a - on_b);
    if (!(depth < out_.depth)) return;
    if (face_of_a)
      keep(depth, n, on_b + depth * n, on_b);
    else
      keep(depth, n, on_a, on_a - depth * n);
  }
  void keep(double depth, const Vec3d& n, const Vec3d& on_a, const Vec3d& on_b) {
    out_.depth = depth, out_.normal = -n, out_.on_a = on_a, out_.on_b = on_b;
  }
  void of_edges(const Arc& a, const Arc& b) {
    const Vec3d c = -b.left, d = -b.right;
    const double ca = dot(c, a.along), da = dot(d, a.along);
    const double ab = dot(a.left, b.along), bb = dot(a.right, b.along);
    if (!(ca * da < 0 && ab * bb < 0)) return;
    Vec3d n = cross(a.along, b.along);
    const double length = norm(n);
    if (!(length > 1e-12 * norm(a.along) * norm(b.along))) return;
    n *= 1 / length;
    if (dot(n, a.left + a.right) < 0) n = -n;
    if (!(dot(n, c + d) > 0)) return;  // the arcs are on opposite sides
    const Vec3d between = b.at - a.at;
    const double depth = -dot(n, between);
    if (!(depth < out_.depth)) return;
    const double square = length * length;
    const double s = dot(cross(between, b.along), cross(a.along, b.along)) / square;
    const double t = dot(cross(between, a.along), cross(a.along, b.along)) / square;
    keep(depth, n, a.at + s * a.along, b.at + t * b.along);
  }

  const PlacedPolyhedron &a_, &b_;
  Penetration out_;
};

}  // namespace detail

/// For any two convex sets, from the simplex at which gjk_distance found the overlap. For smooth
/// sets the result is between lower_bound and depth, limited by 64 tangent planes.
/// Tests:   tests/shape/gjk.cpp
template <ConvexSet A, ConvexSet B>
Penetration penetration(const A& a, const B& b, const GjkResult& gjk) {
  return detail::ExpandingPolytope<A, B>(a, b, gjk.simplex).result();
}
/// For two polyhedra: exact. Uses all axes if the expanding polytope did not converge and the
/// bodies have fewer than 200 faces.
inline Penetration penetration(const PlacedPolyhedron& a, const PlacedPolyhedron& b,
                               const GjkResult& gjk) {
  const auto found =
      detail::ExpandingPolytope<PlacedPolyhedron, PlacedPolyhedron>(a, b, gjk.simplex).result();
  const bool ended = !found.flat && found.depth - found.lower_bound <= 1e-9 * found.depth;
  if (ended || a.shape->faces().size() + b.shape->faces().size() >= 200) return found;
  return detail::SeparatingAxes(a, b).result();
}

}  // namespace silt
