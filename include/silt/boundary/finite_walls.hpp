// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>

/// Walls of finite size, as meshes. Particles touch them from both sides, and touch their edges and
/// corners as those of any mesh. Surfaces bounded by straight lines are exact. A disc and a capped
/// cylinder are polygons of `facets` sides inscribed in the circle. Their rim lies inside the
/// circle by up to R (1 - cos(pi/facets)), 0.12 % of R with 64 facets; their end faces are exact
/// planes. A sphere of 320 facets lies inside by up to 1.8 % of R and has 3.4 % less volume.
/// Units: SI. Errors: InputError for values that make no surface.
/// Tests: tests/boundary/finite_walls.cpp

namespace silt::inline SILT_TARGET {

namespace detail {

using Triangles = DynArray<std::array<Vec3d, 3>>;

inline void add_quad(Triangles& to, const Vec3d& a, const Vec3d& b, const Vec3d& c,
                     const Vec3d& d) {
  to.push_back({a, b, c}), to.push_back({a, c, d});
}

inline DynArray<Vec3d> polygon(const char* name, const Vec3d& centre, const Vec3d& axis,
                               double radius, int facets) {
  require(is_finite(centre), name, ": centre = ", centre, " [m] must be finite");
  const double length = norm(axis);
  require(std::isfinite(length) && length > 0, name, ": the axis ", axis,
          " must be finite and not zero");
  require(std::isfinite(radius) && radius > 0, name, ": radius = ", radius,
          " [m] must be finite and greater than 0");
  require(facets >= 3 && facets <= 100000, name, ": facets = ", facets,
          " [-] must be from 3 to 100000");
  const auto [x, y] = across(axis * (1 / length));
  DynArray<Vec3d> corners;
  for (int k = 0; k < facets; ++k) {
    const double angle = 2 * std::numbers::pi * k / facets;
    corners.push_back(centre + radius * std::cos(angle) * x + radius * std::sin(angle) * y);
  }
  return corners;
}

}  // namespace detail

/// Parallelogram at `corner` [m] with the sides `a` and `b` [m].
inline TriangleMesh rectangle(const Vec3d& corner, const Vec3d& a, const Vec3d& b) {
  require(is_finite(corner) && is_finite(a) && is_finite(b), "rectangle: corner = ", corner,
          ", a = ", a, " and b = ", b, " [m] must be finite");
  require(norm(cross(a, b)) > 1e-9 * norm(a) * norm(b), "rectangle: the sides a = ", a,
          " and b = ", b, " [m] span no area");
  detail::Triangles all;
  detail::add_quad(all, corner, corner + a, corner + a + b, corner + b);
  return TriangleMesh(all);
}

/// A face of a box.
enum class Face { XLow, XHigh, YLow, YHigh, ZLow, ZHigh };

/// Box from `min` to `max` [m] without the faces in `open`. If it is closed, its normals point
/// outwards.
inline TriangleMesh open_box(const Vec3d& min, const Vec3d& max,
                             std::initializer_list<Face> open = {Face::ZHigh}) {
  require(is_finite(min) && is_finite(max) && min.x < max.x && min.y < max.y && min.z < max.z,
          "open_box: min = ", min, " [m] must be less than max = ", max, " [m] in x, y and z");
  const auto at = [&](int corner) {
    return Vec3d{corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y,
                 corner & 4 ? max.z : min.z};
  };
  constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  detail::Triangles all;
  for (int f = 0; f < 6; ++f) {
    bool is_open = false;
    for (const Face face : open) is_open |= static_cast<int>(face) == f;
    if (!is_open)
      detail::add_quad(all, at(faces[f][0]), at(faces[f][1]), at(faces[f][2]), at(faces[f][3]));
  }
  require(!all.empty(), "open_box: all six faces are open; leave at least one closed");
  return TriangleMesh(all);
}
inline TriangleMesh box_mesh(const Vec3d& min, const Vec3d& max) { return open_box(min, max, {}); }

/// Disc with the centre `centre` [m] and the normal `axis`.
inline TriangleMesh disc(const Vec3d& centre, const Vec3d& axis, double radius, int facets = 64) {
  const auto rim = detail::polygon("disc", centre, axis, radius, facets);
  detail::Triangles all;
  for (std::size_t k = 0; k < rim.size(); ++k)
    all.push_back({centre, rim[k], rim[(k + 1) % rim.size()]});
  return TriangleMesh(all);
}

/// Solid cylinder from `from` to `to` [m] with both ends. `open` leaves out the end at `to`, for a
/// bucket. Normals point outwards.
inline TriangleMesh capped_cylinder(const Vec3d& from, const Vec3d& to, double radius,
                                    int facets = 64, bool open = false) {
  const auto low = detail::polygon("capped_cylinder", from, to - from, radius, facets);
  detail::Triangles all;
  for (std::size_t k = 0; k < low.size(); ++k) {
    const Vec3d &a = low[k], &b = low[(k + 1) % low.size()], up = to - from;
    detail::add_quad(all, a, b, b + up, a + up);
    all.push_back({from, b, a});
    if (!open) all.push_back({to, a + up, b + up});
  }
  return TriangleMesh(all);
}

/// Sphere about `centre` [m] of 20 `parts`^2 triangles: an icosahedron with each edge divided into
/// `parts`, and all vertices at `radius` [m]. Normals point outwards.
inline TriangleMesh sphere_mesh(const Vec3d& centre, double radius, int parts = 4) {
  require(is_finite(centre), "sphere_mesh: centre = ", centre, " [m] must be finite");
  require(std::isfinite(radius) && radius > 0, "sphere_mesh: radius = ", radius,
          " [m] must be finite and greater than 0");
  require(parts >= 1 && parts <= 200, "sphere_mesh: parts = ", parts, " [-] must be from 1 to 200");
  // Corners of the icosahedron: two poles and two rings of five.
  DynArray<Vec3d> at{{0, 0, 1}};
  for (int k = 0; k < 10; ++k) {
    const double angle = std::numbers::pi / 5 * k, high = (k % 2 == 0 ? 1 : -1) / std::sqrt(5.0);
    at.push_back(
        {2 * std::cos(angle) / std::sqrt(5.0), 2 * std::sin(angle) / std::sqrt(5.0), high});
  }
  at.push_back({0, 0, -1});
  detail::Triangles all;
  const auto cut = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto corner = [&](int i, int j) {
      const Vec3d p = a + (1.0 / parts) * (i * (b - a) + j * (c - a));
      return centre + (radius / norm(p)) * p;
    };
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j) {
        all.push_back({corner(i, j), corner(i + 1, j), corner(i, j + 1)});
        if (i + j + 2 <= parts)
          all.push_back({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
  };
  const auto ring = [&](int k) { return at[static_cast<std::size_t>(1 + (k % 10))]; };
  for (int k = 0; k < 10; k += 2) {  // even: upper ring
    cut(at[0], ring(k), ring(k + 2)), cut(at[11], ring(k + 3), ring(k + 1));
    cut(ring(k + 1), ring(k + 2), ring(k)), cut(ring(k + 1), ring(k + 3), ring(k + 2));
  }
  return TriangleMesh(all);
}

}  // namespace silt
