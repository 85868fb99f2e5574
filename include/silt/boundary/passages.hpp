// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <variant>

#include <silt/boundary/domain.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET::detail {

/// How often a straight path passes a surface: forwards is along its normal.
struct Passages {
  int forwards = 0, backwards = 0;
  double first = 2;             // [-] of the path, where it first passes
  bool first_forwards = false;  // and in which direction

  bool any() const { return forwards + backwards > 0; }
  /// From the side of height `from` [m] to that of `to`: a point on the surface is in front of it,
  /// so that two paths that meet there pass once together.
  void add(double from, double to) {
    if ((from >= 0) == (to >= 0)) return;
    to >= 0 ? ++forwards : ++backwards;
    if (const double at = from / (from - to); at < first) first = at, first_forwards = to >= 0;
  }
};

/// A surface at rest that paths pass: a plane or a triangle mesh.
///
/// A path through an edge or a corner of a mesh passes once: which triangle counts is decided as if
/// the path were shifted by a vanishing amount, the same for all triangles (simulation of
/// simplicity, Edelsbrunner and Muecke, ACM Trans. Graphics 9 (1990) 66, recalled). In a
/// PeriodicBox a mesh repeats with the box; a plane repeats in the direction of its normal.
///
/// Errors: InputError for more than one surface, a cylinder or a cone, an invalid plane; check():
///         a plane oblique to a repeating direction, a mesh longer than the box.
/// Threads: one surface per thread, as it reuses memory.
/// Tests:  tests/boundary/passages.cpp
class PassedSurface {
 public:
  PassedSurface(const char* of, const Surfaces& surface) : of_(of) {
    require(surface.parts.size() == 1, of, ": ", surface.parts.size(),
            " surfaces given, but it takes one: a plane, or a mesh (box_mesh for a box)");
    surface_ = surface.parts.front();
    const auto* plane = std::get_if<Plane>(&surface_);
    if (plane) plane->check();
    require(plane || std::holds_alternative<Mesh>(surface_), of,
            ": a Cylinder or Cone is not counted at; give a plane, or a mesh such as disc(), "
            "rectangle() or capped_cylinder()");
  }

  /// InputError if the surface does not fit this domain.
  template <class Domain>
  void check(const Domain& domain) const {
    if constexpr (Domain::periodic)
      for (int d = 0; d < 3; ++d) {
        const double length = domain.length(d);
        if (length == 0) continue;
        if (const auto* plane = std::get_if<Plane>(&surface_)) {
          const double along = std::abs(along_axis(plane->normal, d));
          require(along < flat || along > 1 - flat, of_, ": the normal ", plane->normal,
                  " of the plane is oblique to ", "xyz"[d],
                  ", which repeats; take a normal along or across it, or a mesh");
        } else {
          const Box box = std::get<Mesh>(surface_)->bounds();
          const double extent = along_axis(box.max, d) - along_axis(box.min, d);
          require(extent <= length * (1 + flat), of_, ": the mesh is ", extent, " m long in ",
                  "xyz"[d], ", more than the PeriodicBox, ", length,
                  " m, with which it repeats: it would count twice; make it at most as long");
        }
      }
  }

  /// Of the path from `from` to the nearest image of `to` [m].
  template <class Domain>
  Passages between(const Vec3d& from, Vec3d to, const Domain& domain) {
    if constexpr (Domain::periodic) {
      const Vec3d way = to - from, nearest = domain.shortest(way);
      if (nearest != way) to = from + nearest;
    }
    Passages all;
    if (const auto* plane = std::get_if<Plane>(&surface_))
      pass(*plane, from, to, domain, all);
    else
      pass(*std::get<Mesh>(surface_), from, to, domain, all);
    return all;
  }

 private:
  using Mesh = std::shared_ptr<const TriangleMesh>;
  static constexpr double flat = 1e-9;  // [-] rounding of normals and lengths

  static double along_axis(const Vec3d& v, int d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }

  template <class Domain>
  static void pass(const Plane& plane, const Vec3d& from, const Vec3d& to,
                   [[maybe_unused]] const Domain& domain, Passages& all) {
    double low = dot(from - plane.point, plane.normal), high = dot(to - plane.point, plane.normal);
    if constexpr (Domain::periodic)
      for (int d = 0; d < 3; ++d)
        if (const double length = domain.length(d);
            length > 0 && std::abs(along_axis(plane.normal, d)) > flat) {
          const double image =
              length * std::max(std::floor(low / length), std::floor(high / length));
          low -= image, high -= image;
        }
    all.add(low, high);
  }

  template <class Domain>
  void pass(const TriangleMesh& mesh, const Vec3d& from, const Vec3d& to,
            [[maybe_unused]] const Domain& domain, Passages& all) {
    Box path;
    path.include(from), path.include(to);
    const Box box = mesh.bounds();
    int least[3], most[3];  // number of the images that the path may meet
    for (int d = 0; d < 3; ++d) {
      const double behind = along_axis(path.min, d) - along_axis(box.max, d),
                   ahead = along_axis(path.max, d) - along_axis(box.min, d);
      double length = 0;
      if constexpr (Domain::periodic) length = domain.length(d);
      least[d] = length > 0 ? static_cast<int>(std::ceil(behind / length)) : behind <= 0 ? 0 : 1;
      most[d] = length > 0 ? static_cast<int>(std::floor(ahead / length)) : ahead >= 0 ? 0 : -1;
    }
    for (int i = least[0]; i <= most[0]; ++i)
      for (int j = least[1]; j <= most[1]; ++j)
        for (int k = least[2]; k <= most[2]; ++k) {
          Vec3d image{0, 0, 0};
          if constexpr (Domain::periodic)
            image = {i * domain.length(0), j * domain.length(1), k * domain.length(2)};
          pass_triangles(mesh, from - image, to - image, all);
        }
  }

  void pass_triangles(const TriangleMesh& mesh, const Vec3d& from, const Vec3d& to, Passages& all) {
    const Vec3d way = to - from;
    const double reach = 0.5 * norm(way) * (1 + 1e-9) + 2 * mesh.round_off();
    mesh.triangles_near(from + 0.5 * way, reach, near_);
    for (const auto t : near_) {
      const Vec3d &corner = mesh.vertices()[mesh.triangles()[t][0]], &normal = mesh.normals()[t];
      const double low = dot(from - corner, normal), high = dot(to - corner, normal);
      if ((low >= 0) != (high >= 0) && is_through(mesh, t, from, way)) all.add(low, high);
    }
  }

  /// Whether the line from `from` along `way` passes the triangle. The corners are projected along
  /// the line onto two axes; the line is on the same side of all three edges.
  static bool is_through(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3d& from,
                         const Vec3d& way) {
    const double x = std::abs(way.x), y = std::abs(way.y), z = std::abs(way.z);
    const int main = x >= y && x >= z ? 0 : y >= z ? 1 : 2, a = (main + 1) % 3, b = (main + 2) % 3;
    const double slope_a = along_axis(way, a) / along_axis(way, main),
                 slope_b = along_axis(way, b) / along_axis(way, main);
    const auto projected = [&](std::uint32_t v) {
      const Vec3d p = mesh.vertices()[v] - from;
      const double height = along_axis(p, main);
      return std::array{along_axis(p, a) - height * slope_a, along_axis(p, b) - height * slope_b};
    };
    // In the order of the corners' numbers: both triangles of an edge compute the same.
    const auto is_left = [&](std::uint32_t i, std::uint32_t j) {
      const auto p = projected(std::min(i, j)), q = projected(std::max(i, j));
      const double area = p[0] * q[1] - p[1] * q[0];
      const bool left = area != 0 ? area > 0 : p[1] != q[1] ? q[1] < p[1] : q[0] > p[0];
      return left == (i < j);
    };
    const auto& [i, j, k] = mesh.triangles()[triangle];
    const bool left = is_left(i, j);
    return left == is_left(j, k) && left == is_left(k, i);
  }

  const char* of_;  // who counts, in messages
  Surface surface_;
  DynArray<std::uint32_t> near_;
};

}  // namespace silt::detail
