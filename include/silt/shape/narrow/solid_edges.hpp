// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>

#include <silt/shape/narrow/hard_normal.hpp>
#include <silt/shape/narrow/solid_round_search.hpp>
#include <silt/shape/narrow/sphere_polyhedron.hpp>

/// Depth of an edge or a point in a convex body: for edges and vertices of meshes.

namespace silt::inline SILT_TARGET::detail {

/// An edge or point of a wall inside a body.
struct FeatureDepth {
  Vec3d normal;  // [-] unit, the shortest way out for the body
  double depth;  // [m] > 0
  Vec3d at;      // [m] the point of the wall
};

/// Gradient direction of the gauge of a super-ellipsoid, and f of super_ellipsoid.hpp (1), at a
/// point in its own axes: start of a search for the common normal.
struct GaugeSlope {
  Vec3d slope;
  double f;
};
template <class Form>
GaugeSlope gauge_slope(const Form& form, const Vec3d& at) {
  const double s1 = form.p1 / (form.p1 - 1), s2 = form.p2 / (form.p2 - 1);
  const Vec3d a2 = form.axes2_towards(at);
  const double u = std::abs(at.x) / std::sqrt(a2.x), v = std::abs(at.y) / std::sqrt(a2.y),
               w = std::abs(at.z) / std::sqrt(a2.z);
  if (s1 == 2 && s2 == 2) return {{at.x / a2.x, at.y / a2.y, at.z / a2.z}, u * u + v * v + w * w};
  const double pu = std::pow(u, s2 - 1), pv = std::pow(v, s2 - 1), pw = std::pow(w, s1 - 1);
  const double A = pu * u + pv * v;
  const double ratio = s1 == s2 || !(A > 0) ? 1 : std::pow(A, s1 / s2 - 1);
  const auto part = [](double p, double x, double square) {
    return std::copysign(p / std::sqrt(square), x);
  };
  return {{ratio * part(pu, at.x, a2.x), ratio * part(pv, at.y, a2.y), part(pw, at.z, a2.z)},
          ratio * A + pw * w};
}

/// The way out of a body from `at`, across the edge, by the gauge.
template <class Form>
Vec3d way_out(const PlacedSuper<Form>& body, const Vec3d& at, const Vec3d& edge) {
  const Vec3d g = gauge_slope(body.form, body.axes.to_body(at - body.position)).slope;
  const Vec3d out = body.axes.to_space(g), across = out - dot(out, edge) * edge;
  const double length = norm(across);
  return length > 1e-9 * norm(out) ? across * (1 / length) : Vec3d{0, 0, 0};
}

/// Approximate point of an edge with the smallest gauge: bisection by the sign of its slope.
template <class Form>
double deepest_on_edge(const PlacedSuper<Form>& body, const Vec3d& from, const Vec3d& edge,
                       double low, double high) {
  const Vec3d start = body.axes.to_body(from - body.position), d = body.axes.to_body(edge);
  for (int k = 0; k < 8; ++k) {
    const double middle = 0.5 * (low + high);
    (dot(gauge_slope(body.form, start + middle * d).slope, d) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// An edge in a smooth body: minimum over unit m across the edge of h(-m) - m . (centre - edge),
/// near the way out by the gauge, if it touches between its ends.
template <class Form>
std::optional<FeatureDepth> edge_depth(const PlacedSuper<Form>& body, const Vec3d& from,
                                       const Vec3d& edge, double length) {
  const Vec3d arm = body.position - from;
  const double foot = dot(arm, edge), bound = body.form.bound;
  const double square = bound * bound - (dot(arm, arm) - foot * foot);
  if (!(square > 0)) return {};
  const double half = std::sqrt(square);
  if (foot + half < 0 || foot - half > length) return {};
  Vec3d out = way_out(body, from + foot * edge, edge);
  // This plane separates body and edge for most edges that are only close.
  if (dot(out, out) > 0 && dot(body.support(out) - from, out) <= 0) return {};
  out = way_out(body, from + deepest_on_edge(body, from, edge, foot - half, foot + half) * edge,
                edge);
  if (!(dot(out, out) > 0)) return {};
  const RoundWall wall(from, edge, length, -out, 0);
  auto at = support_at(wall, body, 0, -1);
  for (int k = 0; k < 20; ++k) {
    if (at.beyond >= 0) return {};  // parted
    const double curve = -at.radius_t - at.weight;
    double step = curve < 0 ? -at.slope / curve : std::copysign(0.2, at.slope);
    step = std::clamp(step, -0.2, 0.2);
    const auto next = support_at(wall, body, at.phi + step, -1);
    if (at.slope * next.slope <= 0) {
      const bool up = step > 0;
      at = turning_point(wall, body, up ? at.phi : next.phi, up ? next.phi : at.phi, next.phi, -1);
      break;
    }
    at = next;
    if (std::abs(at.slope) <= 1e-12 * bound) break;
  }
  const double along = dot(at.p, edge);
  if (!(at.beyond < 0 && along >= 0 && along <= length)) return {};
  return FeatureDepth{at.e, -at.beyond, from + along * edge};
}

/// A point in a smooth body, near the way out by the gauge.
template <class Form>
std::optional<FeatureDepth> point_depth(const PlacedSuper<Form>& body, const Vec3d& point) {
  const Vec3d arm = point - body.position;
  const double size = body.form.size, bound = body.form.bound;
  if (!(dot(arm, arm) < bound * bound)) return {};
  const auto g = gauge_slope(body.form, body.axes.to_body(arm));
  if (g.f >= 1) return {};  // contacts use rounded faces, hence a smaller body
  if (!(dot(g.slope, g.slope) > 0)) return {};
  // As a ball around the point, whose radius is subtracted again.
  const PosedPair pair{body.form, SphereForm<double>{size, size}, body.axes,
                       BodyAxes<double>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, arm};
  const auto found = least_depth(pair, normalised(body.axes.to_space(g.slope)), 40, false, 1e-11);
  if (!(found.depth > size)) return {};
  return FeatureDepth{-found.direction, found.depth - size, point};
}

/// A segment in the core of a polyhedron, in its frame: the smallest depth over all ways out, along
/// normals of faces and of edges across it. Negative if they are apart.
struct SegmentDepth {
  Vec3d out{0, 0, 0};  // [-] outward normal of the core at the shortest way out
  double depth = std::numeric_limits<double>::infinity();
  bool by_end = false;  // the way out is that of an end, by a face inclined along the segment
};
inline SegmentDepth segment_depth(const Polyhedron& core, const Vec3d& a, const Vec3d& b,
                                  const Vec3d& edge) {
  constexpr double along = 1e-9;  // a face inclined less than this counts as parallel to the
                                  // segment
  SegmentDepth best;
  const auto look = [&](const Vec3d& out, double depth, bool by_end) {
    if (depth < best.depth) best = {out, depth, by_end};
  };
  for (const auto& face : core.faces()) {
    const double c = dot(face.normal, edge);
    if (std::abs(c) <= along) {
      const Vec3d across = normalised(face.normal - c * edge);
      const Vec3d& corner = core.vertices()[core.support_vertex(across, core.loop(face)[0])];
      look(across, dot(across, corner - a), false);
    } else {
      look(face.normal, face.offset - dot(face.normal, c > 0 ? a : b), true);
    }
  }
  for (const auto& side : core.edges()) {
    const Vec3d &l = core.faces()[side.left].normal, &r = core.faces()[side.right].normal;
    const double cl = dot(l, edge), cr = dot(r, edge);
    if (std::abs(cl) <= along || std::abs(cr) <= along || !(cl * cr < 0)) continue;
    const Vec3d& corner = core.vertices()[side.from];
    Vec3d out = cross(edge, core.vertices()[side.to] - corner);
    if (dot(out, l + r) < 0) out = -out;
    out = normalised(out);
    look(out, dot(out, corner - a), false);
  }
  return best;
}

/// An edge in a polyhedron or nearer than its radius: the middle of its touching part.
inline std::optional<FeatureDepth> edge_depth(const PlacedPolyhedron& body, const Vec3d& from,
                                              const Vec3d& edge, double length) {
  const double r = body.shape->radius();
  const auto& pose = body.pose;
  const Vec3d a = pose.to_body(from), d = pose.turn.back(edge), b = a + length * d;
  for (const auto& face : body.shape->faces())
    if (std::min(dot(face.normal, a), dot(face.normal, b)) >= face.offset + r) return {};
  SegmentDepth found = segment_depth(*body.shape, a, b, d);
  if (found.depth <= -r || (found.depth > 0 && found.by_end)) return {};
  Vec3d normal = -(pose.turn * found.out);
  if (found.depth <= 0) {  // beside the core
    const Vec3d arm = pose.position - from, across = arm - dot(arm, edge) * edge;
    const double distance = norm(across);
    const RoundWall seen(from, edge, length, across * (1 / distance), distance);
    const OuterAngle nearest(seen, body);
    if (nearest.beyond() >= r || nearest.beyond() <= 0) return {};  // or only its line is within
    found.depth = -nearest.beyond(), normal = seen.e(nearest.phi());
  }
  const RoundWall wall(from, edge, length, normal, 0);
  const auto line = touching_line(wall, body, normal, -found.depth);
  const double low = std::max(line.low, 0.0), high = std::min(line.high, length);
  if (!(low <= high)) return {};
  return FeatureDepth{normal, found.depth + r, from + (0.5 * (low + high)) * edge};
}

/// A vertex of a wall with edges to `others` in a polyhedron: over the faces through which all of
/// them leave; the shortest way out must be the vertex's. Next to the core: of a dilated one.
template <class Others>
std::optional<FeatureDepth> vertex_depth(const PlacedPolyhedron& body, const Vec3d& point,
                                         const Others& others) {
  const auto& pose = body.pose;
  const Vec3d p = pose.to_body(point);
  double least = std::numeric_limits<double>::infinity(), outside = -least;
  Vec3d out{0, 0, 0};
  for (const auto& face : body.shape->faces()) {
    const double depth = face.offset - dot(face.normal, p);
    outside = std::max(outside, -depth);
    if (outside >= body.shape->radius()) return {};
    if (depth < least) least = depth, out = face.normal;
  }
  if (outside < 0) {
    least = std::numeric_limits<double>::infinity();
    bool of_vertex = false;
    for (const auto& face : body.shape->faces()) {
      const double depth = face.offset - dot(face.normal, p);
      const Vec3d normal = pose.turn * face.normal;
      double lowest = 0;
      others([&](const Vec3d& other) { lowest = std::min(lowest, dot(normal, other - point)); });
      if (depth - lowest < least) {
        least = depth - lowest, out = normal;
        of_vertex = -lowest <= 1e-9 * bound_of(body);
      }
    }
    if (!of_vertex) return {};
    return FeatureDepth{-out, least + body.shape->radius(), point};
  }
  const auto found = sphere_contact(point, 0, body);
  if (!(found.overlap > 0)) return {};
  return FeatureDepth{-found.normal, found.overlap, point};
}
template <class Form, class Others>
std::optional<FeatureDepth> vertex_depth(const PlacedSuper<Form>& body, const Vec3d& point,
                                         const Others&) {
  return point_depth(body, point);
}

}  // namespace silt::detail
