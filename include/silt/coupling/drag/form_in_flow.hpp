// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/averaged_form.hpp>
#include <silt/coupling/drag/silhouette.hpp>
#include <silt/shape/surface_mesh.hpp>

namespace silt::inline SILT_TARGET {

/// Shape of a body for the flow, made once by form_in_flow(): a table of its projected areas in all
/// directions, its surface, and its resistance to rotation. Directions are in the principal frame,
/// lengths in radii r of the sphere of equal volume: forms of all scales share one table.
///
/// The table contains (projected area/(pi r^2))^2 |v|^2 for v on half a cube around the body, by
/// quadratic pieces that meet at its planes of symmetry: exact for ellipsoids and boxes. A second
/// table contains half the surface minus the mean area across the flow, for the lengthwise
/// sphericity. Error of the areas: below 2 % for a cylinder 5 diameters long and a body of two
/// overlapping spheres; 2.5 % for an octahedron, whose edges are between the pieces.
/// Tests: tests/coupling/form_in_flow.cpp.
struct FormInFlow {
  double sphericity = 1;             // [-]
  Vec3d inertia{0.4, 0.4, 0.4};      // [-] principal moments over m r^2
  Vec3d axes{1, 1, 1};               // [-] semi-axes over r of the ellipsoid with these moments
  Vec3d slip_resistance{1, 1, 1};    // [-] of it in slow flow: force over 6 pi mu r times slip
  Vec3d spin_resistance{1, 1, 1};    // [-] of it: torque over 8 pi mu r^3 times spin
  Vec3d strain_share{0, 0, 0};       // [-] of it: (b^2 - c^2)/(b^2 + c^2) and so on
  DynArray<double> seen, mean_side;  // [-] tables; empty: a sphere

  static constexpr int pieces = 4, nodes = 2 * pieces + 1;

  /// For a flow along the unit vector u. The circularity is not tabulated: 1.
  ShapeInFlow<double> along(const Vec3d& u) const {
    if (seen.empty()) return {};
    const double side = std::sqrt(look_up(mean_side, u));
    return {sphericity, 1 / area(u), 1 / (2 / sphericity - side), 1};
  }
  /// Projected area along the unit vector u, over pi r^2 [-].
  double area(const Vec3d& u) const { return seen.empty() ? 1 : std::sqrt(look_up(seen, u)); }
  /// Axis of equal moments, 0, 1 or 2; -1: none, or all.
  int symmetry_axis() const {
    const double m[] = {inertia.x, inertia.y, inertia.z};
    const auto same = [](double p, double q) { return std::abs(p - q) < 1e-3 * (p + q); };
    for (int k = 0; k < 3; ++k)
      if (same(m[(k + 1) % 3], m[(k + 2) % 3])) return same(m[k], m[(k + 1) % 3]) ? -1 : k;
    return -1;
  }
  /// Length of the ellipsoid along the axis of symmetry over that across it; 1: none.
  double aspect_ratio() const {
    const double a[] = {axes.x, axes.y, axes.z};
    const int k = symmetry_axis();
    return k < 0 ? 1 : a[k] / a[(k + 1) % 3];
  }

 private:
  static double look_up(const DynArray<double>& table, const Vec3d& u) {
    const double c[] = {u.x, u.y, u.z}, m[] = {std::abs(u.x), std::abs(u.y), std::abs(u.z)};
    const auto face = static_cast<std::size_t>(std::max_element(m, m + 3) - m);
    std::size_t first[2];
    double weight[2][3];
    for (std::size_t d = 0; d < 2; ++d) {
      const double s = 0.5 * pieces * (1 + c[(face + 1 + d) % 3] / c[face]);
      const double piece = std::clamp(std::floor(s), 0.0, pieces - 1.0), x = s - piece;
      first[d] = 2 * static_cast<std::size_t>(piece);
      weight[d][0] = (1 - x) * (1 - 2 * x);
      weight[d][1] = 4 * x * (1 - x);
      weight[d][2] = x * (2 * x - 1);
    }
    double sum = 0, least = table[0];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double value = table[(face * nodes + first[0] + i) * nodes + first[1] + j];
        sum += weight[0][i] * weight[1][j] * value;
        if (i + j == 0 || value < least) least = value;
      }
    return std::max(sum, 0.5 * least) * c[face] * c[face];  // may undershoot between steep nodes
  }
};

namespace detail {

/// Carlson's R_D(x, y, z) = 3/2 int_0^inf dt/((t + z) sqrt((t + x)(t + y)(t + z))), by duplication.
/// Source: B. C. Carlson, Numer. Math. 33 (1979) 1.
inline double carlson_rd(double x, double y, double z) {
  double sum = 0, factor = 1;
  for (;;) {
    const double mean = (x + y + 3 * z) / 5;
    const double X = 1 - x / mean, Y = 1 - y / mean, Z = 1 - z / mean;
    if (std::max({std::abs(X), std::abs(Y), std::abs(Z)}) < 1e-3) {
      const double A = X * Y, B = Z * Z, C = A - B, D = A - 6 * B, E = D + C + C;
      const double series = 1 + D * (-3.0 / 14 + 9.0 / 88 * D - 9.0 / 52 * Z * E) +
                            Z * (E / 6 + Z * (-9.0 / 22 * C + Z * 3.0 / 26 * A));
      return 3 * sum + factor * series / (mean * std::sqrt(mean));
    }
    const double p = std::sqrt(x), q = std::sqrt(y), r = std::sqrt(z), l = p * (q + r) + q * r;
    sum += factor / (r * (z + l)), factor *= 0.25;
    x = 0.25 * (x + l), y = 0.25 * (y + l), z = 0.25 * (z + l);
  }
}

/// Union of convex parts, by the outlines of their silhouettes on many lines; error about 1e-3.
template <class S>
double area_seen(const Compound<S>& body, const Vec3d& u) {
  constexpr int corners = 96, lines = 256;
  struct Point {
    double x, y;
  };
  const auto [e, f] = across(u);
  DynArray<std::array<Point, corners>> outlines;
  double low = INFINITY, high = -INFINITY;
  for (const auto& part : body.parts) {
    auto& outline = outlines.emplace_back();
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      const Vec3d n = rotate(conjugate(part.axes), e * std::cos(angle) + f * std::sin(angle));
      Vec3d p = part.shape.support(n);
      if constexpr (std::is_same_v<S, Polyhedron>) p += part.shape.radius() * n;
      p = part.centre + rotate(part.axes, p);
      outline[static_cast<std::size_t>(k)] = {dot(p, e), dot(p, f)};
      low = std::min(low, dot(p, f)), high = std::max(high, dot(p, f));
    }
  }
  double length = 0;
  DynArray<Point> spans;
  for (int line = 0; line < lines; ++line) {
    const double y = low + (high - low) * (line + 0.5) / lines;
    spans.clear();
    for (const auto& outline : outlines) {
      Point span{INFINITY, -INFINITY};
      for (std::size_t k = 0; k < corners; ++k) {
        const Point &a = outline[k], &b = outline[(k + 1) % corners];
        if ((a.y <= y) == (b.y <= y)) continue;
        const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
        span = {std::min(span.x, x), std::max(span.y, x)};
      }
      if (span.x < span.y) spans.push_back(span);
    }
    std::sort(spans.begin(), spans.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    double reached = -INFINITY;
    for (const auto& s : spans)
      length += std::max(0.0, s.y - std::max(s.x, reached)), reached = std::max(reached, s.y);
  }
  return length * (high - low) / lines;
}
template <class S>
double area_seen(const S& body, const Vec3d& u) {
  return silhouette(body, u).area;
}

/// Surface of each part outside all others, by the centres of small triangles; error about 1e-2.
template <class S>
double surface_of_any(const Compound<S>& body) {
  double sum = 0;
  for (const auto& part : body.parts) {
    const SurfaceMesh mesh = surface_of(part.shape, 24);
    const int cuts = mesh.triangles.size() < 1000 ? 24 : 2;
    double all = 0, free = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3d &a = mesh.points[t[0]], p = mesh.points[t[1]] - a, q = mesh.points[t[2]] - a;
      const Vec3d normal = cross(p, q);
      const double area = 0.5 * norm(normal) / (cuts * cuts);
      if (area == 0) continue;
      const Vec3d out = rotate(part.axes, (1e-6 * std::sqrt(area) / norm(normal)) * normal);
      for (int i = 0; i < cuts; ++i)
        for (int j = 0; j < 2 * (cuts - i) - 1; ++j) {  // pairs of small triangles, the last one
                                                        // alone
          const double s = (i + (j % 2 ? 2.0 : 1.0) / 3) / cuts;
          const double w = (j / 2 + (j % 2 ? 2.0 : 1.0) / 3) / cuts;
          const Vec3d x = part.centre + rotate(part.axes, a + s * p + w * q);
          const auto held_by = [&](const auto& other, const Vec3d& at) {
            return holds_point(other.shape, rotate(conjugate(other.axes), at - other.centre));
          };
          bool covered = false;  // where faces of two parts coincide, the first counts
          for (const auto& other : body.parts)
            covered = covered || (&other != &part && held_by(other, x + out)) ||
                      (&other < &part && held_by(other, x - out));
          all += area;
          if (!covered) free += area;
        }
    }
    sum += surface_of_body(part.shape) * free / all;
  }
  return sum;
}
template <class S>
double surface_of_any(const S& body) {
  return surface_of_body(body);
}

}  // namespace detail

/// For any of silt's shapes; computes 243 silhouettes.
template <class S>
FormInFlow form_in_flow(const S& shape) {
  FormInFlow form;
  if constexpr (requires { shape.shape.index(); }) {  // a Mix
    return std::visit([](const auto& one) { return form_in_flow(one); }, shape.shape);
  } else if constexpr (!std::is_same_v<S, Sphere>) {
    constexpr double pi = std::numbers::pi;
    constexpr auto nodes = static_cast<std::size_t>(FormInFlow::nodes);
    const MassProperties mass = shape.mass_properties();
    const double r = std::cbrt(0.75 * mass.volume / pi), disc = pi * r * r;
    form.sphericity = 4 * disc / detail::surface_of_any(shape);
    form.inertia = (1 / (mass.volume * r * r)) * mass.inertia;
    const auto axis = [](double u, double v, double w) {
      return std::sqrt(std::max(2.5 * (v + w - u), 1e-6));
    };
    const Vec3d& I = form.inertia;
    form.axes = {axis(I.x, I.y, I.z), axis(I.y, I.z, I.x), axis(I.z, I.x, I.y)};
    form.axes *= 1 / std::cbrt(form.axes.x * form.axes.y * form.axes.z);
    const Vec3d a2{form.axes.x * form.axes.x, form.axes.y * form.axes.y, form.axes.z * form.axes.z};
    // alpha = int dl/((a^2 + l) D) = 2/3 R_D(b^2, c^2, a^2), and a^2 alpha + b^2 beta + c^2 gamma =
    // int dl/D = chi; 8/3/(chi + a^2 alpha), and 2/3 (b^2 + c^2)/(b^2 beta + c^2 gamma).
    const double A = 2.0 / 3 * a2.x * detail::carlson_rd(a2.y, a2.z, a2.x),
                 B = 2.0 / 3 * a2.y * detail::carlson_rd(a2.z, a2.x, a2.y),
                 C = 2.0 / 3 * a2.z * detail::carlson_rd(a2.x, a2.y, a2.z), chi = A + B + C;
    form.slip_resistance = {8.0 / 3 / (chi + A), 8.0 / 3 / (chi + B), 8.0 / 3 / (chi + C)};
    form.spin_resistance = {2.0 / 3 * (a2.y + a2.z) / (B + C), 2.0 / 3 * (a2.z + a2.x) / (C + A),
                            2.0 / 3 * (a2.x + a2.y) / (A + B)};
    form.strain_share = {(a2.y - a2.z) / (a2.y + a2.z), (a2.z - a2.x) / (a2.z + a2.x),
                         (a2.x - a2.y) / (a2.x + a2.y)};
    form.seen.resize(3 * nodes * nodes), form.mean_side.resize(3 * nodes * nodes);
    const auto for_nodes = [&](DynArray<double>& table, const auto& area_along) {
      for (std::size_t face = 0; face < 3; ++face)
        for (std::size_t i = 0; i < nodes; ++i)
          for (std::size_t j = 0; j < nodes; ++j) {
            double v[3];
            v[face] = 1, v[(face + 1) % 3] = static_cast<double>(i) / FormInFlow::pieces - 1;
            v[(face + 2) % 3] = static_cast<double>(j) / FormInFlow::pieces - 1;
            const Vec3d at{v[0], v[1], v[2]};
            const double area = area_along(normalised(at)) * norm(at);
            table[(face * nodes + i) * nodes + j] = area * area;
          }
    };
    for_nodes(form.seen, [&](const Vec3d& u) {
      return detail::area_seen(shape, normalised(rotate(mass.axes, u))) / disc;
    });
    for_nodes(form.mean_side, [&](const Vec3d& u) {
      constexpr int turns = 48;
      const auto [e, f] = detail::across(u);
      double sum = 0;
      for (int k = 0; k < turns; ++k) {
        const double angle = pi * (k + 0.5) / turns;
        sum += form.area(e * std::cos(angle) + f * std::sin(angle));
      }
      return sum / turns;
    });
  }
  return form;
}

}  // namespace silt
