// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/drag/non_spherical.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/poly_super_ellipsoid.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/sphere.hpp>

/// Projection of a body along the flow: area and outline, and the shape numbers of drag laws.
/// Directions are unit vectors in the body's frame.
/// Errors: InputError for a direction that is not of length 1.
/// Tests:  tests/coupling/silhouette.cpp.
namespace silt::inline SILT_TARGET {

/// The projection of a body along a direction.
struct Silhouette {
  double area;       // [m2]
  double perimeter;  // [m]
};

namespace detail {
inline void check_direction(const Vec3d& u) {
  require(std::abs(norm(u) - 1) < 1e-6, "silhouette: the direction ", u,
          " must be a unit vector; divide it by its length ", norm(u));
}

/// For a convex body, by its support points around u. The polygon of the points is too small, that
/// of the tangents too large; their means are used, in which second order errors of a smooth
/// outline cancel. Steps are halved until the corners between the polygons are below 1e-5 of the
/// square of the body's size; flat sides and sharp edges need most points.
template <class S>
class ConvexOutline {
 public:
  ConvexOutline(const S& body, const Vec3d& u) : body_(body), axes_(across(u)) {
    constexpr int steps = 16;
    const Point first = at(0);
    Point p = first;
    const double size = std::hypot(p.x, p.y) + std::hypot(at(0.25).x, at(0.25).y);
    smallest_ = 0.25e-5 * size * size;
    for (int k = 1; k <= steps; ++k) {
      Point q = at(static_cast<double>(k) / steps);
      if (k == steps) q = first, q.turn = 1;  // a flat side may have another point for that normal
      add(p, q, 0);
      p = q;
    }
  }
  Silhouette seen() const {
    return {(chords_.area + 2 * tangents_.area) / 3,
            (2 * chords_.perimeter + tangents_.perimeter) / 3};
  }

 private:
  struct Point {
    double turn, nx, ny, x, y;  // [-] of the normal, the normal, the position
  };
  Point at(double turn) const {
    const double angle = 2 * std::numbers::pi * turn, c = std::cos(angle), s = std::sin(angle);
    const Vec3d p = body_.support(axes_[0] * c + axes_[1] * s);
    return {turn, c, s, dot(p, axes_[0]), dot(p, axes_[1])};
  }
  void add(const Point& p, const Point& q, int halvings) {
    const double dx = q.x - p.x, dy = q.y - p.y, sine = p.nx * q.ny - p.ny * q.nx;
    // Intersection of the tangents at p and q: distances from p and from q.
    const double from_p = std::max((dx * q.nx + dy * q.ny) / sine, 0.0);
    const double from_q = std::max(-(dx * p.nx + dy * p.ny) / sine, 0.0);
    const double chord = 0.5 * (p.x * q.y - q.x * p.y), corner = 0.5 * from_p * from_q * sine;
    if (corner > smallest_ && halvings < 20) {
      const Point middle = at(0.5 * (p.turn + q.turn));
      add(p, middle, halvings + 1), add(middle, q, halvings + 1);
      return;
    }
    chords_.area += chord, chords_.perimeter += std::hypot(dx, dy);
    tangents_.area += chord + corner, tangents_.perimeter += from_p + from_q;
  }

  const S& body_;
  std::array<Vec3d, 2> axes_;
  double smallest_ = 0;
  Silhouette chords_{0, 0}, tangents_{0, 0};
};

/// A disc in a plane figure.
struct Disc {
  double x, y, r;
};

/// Arcs of disc i that no other disc covers, as pairs of angles.
inline DynArray<std::pair<double, double>> free_arcs(const DynArray<Disc>& discs, std::size_t i) {
  constexpr double pi = std::numbers::pi;
  DynArray<std::pair<double, double>> covered;
  const Disc& a = discs[i];
  for (std::size_t j = 0; j < discs.size(); ++j) {
    if (j == i) continue;
    const Disc& b = discs[j];
    const double dx = b.x - a.x, dy = b.y - a.y, distance = std::hypot(dx, dy);
    if (distance >= a.r + b.r || distance + b.r < a.r) continue;
    if (distance + a.r <= b.r) {
      if (distance + b.r <= a.r && j > i) continue;  // the same disc twice: the first counts
      return {};
    }
    const double cosine = (distance * distance + a.r * a.r - b.r * b.r) / (2 * distance * a.r);
    const double half = std::acos(std::clamp(cosine, -1.0, 1.0)), middle = std::atan2(dy, dx);
    const double from = middle - half, to = middle + half;
    if (from < -pi) {
      covered.push_back({from + 2 * pi, pi}), covered.push_back({-pi, to});
    } else if (to > pi) {
      covered.push_back({from, pi}), covered.push_back({-pi, to - 2 * pi});
    } else {
      covered.push_back({from, to});
    }
  }
  std::sort(covered.begin(), covered.end());
  DynArray<std::pair<double, double>> left;
  double reached = -pi;
  for (const auto& [from, to] : covered) {
    if (from > reached) left.push_back({reached, from});
    reached = std::max(reached, to);
  }
  if (reached < pi) left.push_back({reached, pi});
  return left;
}
}  // namespace detail

/// Projected area [m2] of an ellipsoid with semi-axes a, b, c [m] along the unit vector t: pi
/// sqrt((b c tx)^2 + (a c ty)^2 + (a b tz)^2).
inline double ellipsoid_projected_area(double a, double b, double c, const Vec3d& t) {
  return std::numbers::pi * norm(Vec3d{b * c * t.x, a * c * t.y, a * b * t.z});
}

/// @name Silhouettes
/// @{

/// Ellipsoids: the area in closed form. Others with an error of about 1e-4.
inline Silhouette silhouette(const SuperEllipsoid& s, const Vec3d& u) {
  detail::check_direction(u);
  Silhouette seen = detail::ConvexOutline(s, u).seen();
  if (s.s1 == 2 && s.s2 == 2) seen.area = ellipsoid_projected_area(s.a, s.b, s.c, u);
  return seen;
}
inline Silhouette silhouette(const PolySuperEllipsoid& s, const Vec3d& u) {
  detail::check_direction(u);
  return detail::ConvexOutline(s, u).seen();
}
/// Exact: half the faces' areas times |n.u|, and the edges between faces upstream and downstream;
/// dilated polyhedra by Steiner's formulas in the plane.
inline Silhouette silhouette(const Polyhedron& s, const Vec3d& u) {
  detail::check_direction(u);
  const auto& v = s.vertices();
  const auto up = [&](std::uint32_t face) { return dot(s.faces()[face].normal, u) > 1e-12; };
  double area = 0, outline = 0;
  for (const auto& face : s.faces()) {
    const auto corner = s.loop(face);
    Vec3d twice{0, 0, 0};
    for (std::size_t k = 2; k < corner.size(); ++k)
      twice += cross(v[corner[k - 1]] - v[corner[0]], v[corner[k]] - v[corner[0]]);
    area += 0.25 * std::abs(dot(twice, u));
  }
  for (const auto& edge : s.edges())
    if (up(edge.left) != up(edge.right)) outline += norm(cross(v[edge.to] - v[edge.from], u));
  const double r = s.radius(), pi = std::numbers::pi;
  return {area + r * outline + pi * r * r, outline + 2 * pi * r};
}
/// Exact: the union of discs by its arcs; the outline includes holes.
inline Silhouette silhouette(const MultiSphere& s, const Vec3d& u) {
  detail::check_direction(u);
  const auto [e, f] = detail::across(u);
  DynArray<detail::Disc> discs;
  for (const Ball& b : s.balls) discs.push_back({dot(b.centre, e), dot(b.centre, f), b.radius});
  Silhouette seen{0, 0};
  for (std::size_t i = 0; i < discs.size(); ++i)
    for (const auto& [from, to] : detail::free_arcs(discs, i)) {
      const auto& a = discs[i];
      seen.perimeter += a.r * (to - from);
      seen.area += 0.5 * a.r *
                   (a.x * (std::sin(to) - std::sin(from)) - a.y * (std::cos(to) - std::cos(from)) +
                    a.r * (to - from));
    }
  return seen;
}
/// @}

/// @name Surface [m2] of a body of each kind
/// @{
inline double surface_of_body(const SuperEllipsoid& s) { return s.surface_area(); }
inline double surface_of_body(const PolySuperEllipsoid& s) {
  double sum = 0;
  for (int k = 0; k < 8; ++k)
    sum += s.octant({k & 1 ? -1. : 1., k & 2 ? -1. : 1., k & 4 ? -1. : 1.}).surface_area() / 8;
  return sum;
}
inline double surface_of_body(const Polyhedron& s) { return s.area(); }
/// Of the union, by its free arcs in 400 slices of each ball; error about 1e-4.
inline double surface_of_body(const MultiSphere& s) {
  constexpr int slices = 400;
  double sum = 0;
  DynArray<detail::Disc> discs;
  for (const Ball& b : s.balls)
    for (int k = 0; k < slices; ++k) {
      const double height = b.centre.z + b.radius * ((2 * k + 1.0) / slices - 1);
      std::size_t own = 0;
      discs.clear();
      for (const Ball& o : s.balls) {
        const double h = height - o.centre.z, r2 = o.radius * o.radius - h * h;
        if (&o == &b) own = discs.size();
        if (r2 > 0) discs.push_back({o.centre.x, o.centre.y, std::sqrt(r2)});
      }
      for (const auto& [from, to] : detail::free_arcs(discs, own))
        sum += b.radius * (to - from) * 2 * b.radius / slices;
    }
  return sum;
}
/// @}

/// pi d^2/S [-], d of the sphere of equal volume: 1 for a sphere.
template <class S>
double sphericity_of(const S& body) {
  const double d = std::cbrt(6 * body.mass_properties().volume / std::numbers::pi);
  return std::numbers::pi * d * d / surface_of_body(body);
}

/// All shape numbers of a body for a flow along the unit vector u; the mean area across the flow
/// over `turns` directions. For a rotating body use a table: one call takes 0.01 ms (polyhedra) to
/// 10 ms (super-ellipsoids near boxes).
template <class S>
ShapeInFlow<double> shape_in_flow(const S& body, const Vec3d& u, int turns = 48) {
  require(turns >= 2, "shape_in_flow: turns = ", turns, " [-] must be at least 2");
  constexpr double pi = std::numbers::pi;
  const double d = std::cbrt(6 * body.mass_properties().volume / pi), disc = pi * d * d / 4;
  const double S_body = surface_of_body(body);
  const Silhouette seen = silhouette(body, u);
  const auto [e, f] = detail::across(u);
  double mean = 0;
  for (int k = 0; k < turns; ++k) {
    const double angle = pi * (k + 0.5) / turns;
    mean += silhouette(body, normalised(e * std::cos(angle) + f * std::sin(angle))).area / turns;
  }
  const double seen_diameter = std::sqrt(4 * seen.area / pi);
  return {4 * disc / S_body, disc / seen.area, disc / (0.5 * S_body - mean),
          pi * seen_diameter / seen.perimeter};
}

/// All 1 for a sphere.
inline ShapeInFlow<double> shape_in_flow(const Sphere&, const Vec3d&) { return {}; }

}  // namespace silt
