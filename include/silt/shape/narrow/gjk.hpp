// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Convex set for gjk_distance: its farthest point along n, in space. n need not be a unit vector.
template <class C>
concept ConvexSet = requires(const C& c, const Vec3d& n) {
  { c.support(n) } -> std::same_as<Vec3d>;
};

/// Point: the core of a sphere.
struct PointSet {
  Vec3d at;  // [m]
  Vec3d support(const Vec3d&) const { return at; }
};
/// Segment: the core of a capsule.
struct SegmentSet {
  Vec3d a, b;  // [m]
  Vec3d support(const Vec3d& n) const { return dot(n, b - a) > 0 ? b : a; }
};
/// Triangle of a mesh wall.
struct TriangleSet {
  std::array<Vec3d, 3> corners;  // [m]
  Vec3d support(const Vec3d& n) const {
    const double h[3] = {dot(n, corners[0]), dot(n, corners[1]), dot(n, corners[2])};
    return corners[h[0] >= h[1] ? (h[0] >= h[2] ? 0 : 2) : (h[1] >= h[2] ? 1 : 2)];
  }
};

namespace detail {

/// Vertex of the simplex: a point of A - B and its points in A and B.
struct SimplexPoint {
  Vec3d difference, on_a, on_b;
};

/// Up to four points of A - B, and the weights of the point nearest to the origin.
struct Simplex {
  SimplexPoint corner[4];
  double weight[4];
  int size = 0;

  Vec3d nearest() const {
    Vec3d v{0, 0, 0};
    for (int k = 0; k < size; ++k) v += weight[k] * corner[k].difference;
    return v;
  }
};

inline void nearest_on_segment(Simplex& s) {
  const Vec3d a = s.corner[0].difference, ab = s.corner[1].difference - a;
  const double square = dot(ab, ab), t = square > 0 ? -dot(a, ab) / square : 0;
  if (t <= 0) {
    s.size = 1, s.weight[0] = 1;
  } else if (t >= 1) {
    s.corner[0] = s.corner[1], s.size = 1, s.weight[0] = 1;
  } else {
    s.weight[0] = 1 - t, s.weight[1] = t;
  }
}

/// Keeps the better of the present simplex and one on some of its vertices.
inline void keep_nearer(const Simplex& candidate, Simplex& best, double& best_square) {
  const Vec3d v = candidate.nearest();
  if (const double square = dot(v, v); square < best_square) best = candidate, best_square = square;
}

/// By the projection if it is inside, else by the nearest of the sides. There is no case
/// distinction that rounding could decide wrongly.
inline void nearest_on_triangle(Simplex& s) {
  const Vec3d a = s.corner[0].difference, b = s.corner[1].difference, c = s.corner[2].difference;
  const Vec3d n = cross(b - a, c - a);
  const double square = dot(n, n);
  const double wa = dot(n, cross(b, c)), wb = dot(n, cross(c, a)), wc = dot(n, cross(a, b));
  if (wa > 0 && wb > 0 && wc > 0 && square > 0) {
    const double scale = 1 / (wa + wb + wc);
    s.weight[0] = wa * scale, s.weight[1] = wb * scale, s.weight[2] = wc * scale;
    return;
  }
  Simplex best;
  double best_square = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    Simplex side;
    side.corner[0] = s.corner[k], side.corner[1] = s.corner[(k + 1) % 3], side.size = 2;
    nearest_on_segment(side);
    keep_nearer(side, best, best_square);
  }
  s = best;
}

/// True if the origin is inside (the simplex is then kept whole). `outside`: it is known to be
/// outside.
inline bool nearest_on_tetrahedron(Simplex& s, bool outside = false) {
  Simplex best;
  double best_square = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (int k = 0; k < 4; ++k) {
    Simplex face;
    for (int i = 0, j = 0; i < 4; ++i)
      if (i != k) face.corner[j++] = s.corner[i];
    face.size = 3;
    const Vec3d a = face.corner[0].difference;
    const Vec3d n = cross(face.corner[1].difference - a, face.corner[2].difference - a);
    const double apex = dot(n, s.corner[k].difference - a), origin = -dot(n, a);
    if (apex * origin > 0 && !outside) continue;
    inside = false;
    nearest_on_triangle(face);
    keep_nearer(face, best, best_square);
  }
  if (!inside) s = best;
  return inside;
}

inline bool nearest_on_simplex(Simplex& s) {
  if (s.size == 4) return nearest_on_tetrahedron(s);
  if (s.size == 3)
    nearest_on_triangle(s);
  else if (s.size == 2)
    nearest_on_segment(s);
  else
    s.weight[0] = 1;
  return false;
}

}  // namespace detail

/// Result of gjk_distance for two convex sets A and B.
struct GjkResult {
  double distance = 0;     // [m] between the sets; 0 if they overlap
  double lower_bound = 0;  // [m] proved by `normal`: no point of A is nearer to B along it
  Vec3d normal{0, 0, 0};   // [-] unit, from B to A; start of the next call. 0 if they overlap
  Vec3d on_a{0, 0, 0}, on_b{0, 0, 0};  // [m] nearest points
  bool overlapping = false;
  bool beyond_reach = false;  // stopped as lower_bound > reach; distance is an upper bound
  int iterations = 0;
  detail::Simplex simplex;  // where penetration() begins
};

/// Distance of two convex sets from their support functions.
///
/// The point of the simplex (at most four points of A - B) nearest to the origin gives an upper
/// bound |v|, the plane through the new support point w a lower bound, v . w/|v|. The search ends
/// with
///   |v| - v . w/|v| <= 1e-10 |v|, or no progress beyond rounding.                             (1)
/// If ended by (1), the error of the normal is at most sqrt(2e-10), and that of the distance 1e-10.
/// Source: E. G. Gilbert, D. W. Johnson, S. S. Keerthi, IEEE J. Robot. Autom. 4 (1988) 193-203;
///         G. van den Bergen, J. Graphics Tools 4 (1999), eq. 1. Sub-simplex: all faces, see above.
/// `start`: direction from B to A, such as the last `normal`; may be zero. The call ends as soon as
/// the sets are proved farther apart than `reach`. Cost: some 5 supports of each set, 1 with a good
/// start and an exceeded reach.
/// Tests:  tests/shape/gjk.cpp (closed forms, exact separating axes, libccd)
template <ConvexSet A, ConvexSet B>
GjkResult gjk_distance(const A& a, const B& b, const Vec3d& start,
                       double reach = std::numeric_limits<double>::infinity()) {
  constexpr double gap = 1e-10, rounding = 1e-14;
  GjkResult out;
  auto& s = out.simplex;
  Vec3d v = dot(start, start) > 0 ? start : Vec3d{1, 0, 0};
  double size = 0;  // [m] of the points of A - B, the scale of rounding
  bool first = true;
  out.distance = std::numeric_limits<double>::infinity();
  for (; out.iterations < 100; ++out.iterations) {
    const Vec3d on_a = a.support(-v), on_b = b.support(v), w = on_a - on_b;
    size = std::max(size, norm(w));
    const double length = norm(v), lower = dot(v, w) / length;
    if (lower > out.lower_bound || first) out.lower_bound = lower, out.normal = v * (1 / length);
    if (lower > reach) {
      out.beyond_reach = true;
      break;
    }
    bool known = false;
    for (int k = 0; k < s.size; ++k) known |= s.corner[k].difference == w;
    if (!first && (known || length - lower <= gap * length)) break;
    s.corner[s.size++] = {w, on_a, on_b};
    const auto before = s;
    out.overlapping = detail::nearest_on_simplex(s);
    // A plane separates the sets: the volume of the tetrahedron is lost in rounding.
    if (out.overlapping && out.lower_bound > rounding * size)
      out.overlapping = detail::nearest_on_tetrahedron(s, true);
    if (out.overlapping) break;
    const Vec3d next = s.nearest();
    if (!(norm(next) > rounding * size)) {  // the origin is on the simplex
      out.overlapping = true;
      break;
    }
    if (!first && !(norm(next) < out.distance)) {  // rounding: keep the better one
      s = before, --s.size;
      detail::nearest_on_simplex(s);
      break;
    }
    out.distance = norm(next), v = next, first = false;
  }
  if (out.overlapping) {
    out.distance = out.lower_bound = 0, out.normal = {0, 0, 0};
  } else if (!first) {
    for (int k = 0; k < s.size; ++k)
      out.on_a += s.weight[k] * s.corner[k].on_a, out.on_b += s.weight[k] * s.corner[k].on_b;
    if (!out.beyond_reach) out.normal = v * (1 / norm(v));
  }
  return out;
}

}  // namespace silt
