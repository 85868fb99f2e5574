// silt - BSD-3-Clause, see LICENSE
#pragma once

// Files of walls that ParaView opens: as triangles.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <silt/boundary/outline.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/rank_files.hpp>
#include <silt/io/wall_region.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Region [m] in which the planes of a simulation are drawn, by the particles of all ranks
/// (collective); empty if there is nothing to be seen.
template <class Sim>
Box wall_region(const Sim& sim) {
  Box centres;
  double largest = 0;  // [m]
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) {
      centres.include(sim.position(k));
      largest = std::max(largest, sim.radius(k));
    }
  if constexpr (Sim::has_ranks) {
    sim.engine().ranks.meet("the region of particles");
    centres = sim.engine().ranks.union_of(centres);
    largest = sim.engine().ranks.max_of(largest);
  }
  return region_of_scene(sim, centres, largest);
}

/// The part of a plane within `around` that is not behind other planes of its wall.
[[gnu::cold]] inline Outline outline(const Plane& plane, const Box& around,
                                     const DynArray<Plane>& of_wall) {
  const Outline whole = outline(plane, around);
  Outline part = whole;
  const double tolerance = 1e-9 * norm(around.extent());  // [m]
  for (const Plane& other : of_wall) {
    DynArray<Vec3d> kept;
    const auto height = [&](const Vec3d& p) { return dot(p - other.point, other.normal); };
    for (std::size_t k = 0; k < part.points.size(); ++k) {
      const Vec3d &p = part.points[k], &q = part.points[(k + 1) % part.points.size()];
      const double hp = height(p), hq = height(q);
      if (hp >= -tolerance) kept.push_back(p);
      if ((hp > tolerance && hq < -tolerance) || (hp < -tolerance && hq > tolerance))
        kept.push_back(p + (hp / (hp - hq)) * (q - p));
    }
    part.points = std::move(kept);
  }
  if (part.points.size() < 3) return whole;  // behind: drawn all the same, to be seen
  part.triangles.clear();
  for (std::uint32_t k = 1; k + 1 < part.points.size(); ++k)
    part.triangles.push_back({0, k, k + 1});
  return part;
}

/// The widest cylinder that a plane of wall `w` closes and moves with, as the end of a drum does,
/// in the wall's coordinates; none if there is none.
template <class Sim>
std::optional<Cylinder> closed_cylinder(const Sim& sim, std::size_t w, const Plane& plane) {
  std::optional<Cylinder> widest;
  if (!sim.wall(w).moves()) return widest;
  for (std::size_t v = 0; v < sim.walls(); ++v) {
    if (!sim.wall(v).moves() || !(sim.wall(v).pose == sim.wall(w).pose)) continue;
    for (const Surface& surface : sim.wall(v).surfaces) {
      const auto* c = std::get_if<Cylinder>(&surface);
      if (c == nullptr || c->side != Side::Inside || (widest && c->radius <= widest->radius))
        continue;
      const Vec3d axis = c->to - c->from;
      const double length = norm(axis), tolerance = 1e-6 * length,  // [m]
          place = dot(plane.point - c->from, axis) / length;
      if (norm(cross(plane.unit().normal, axis)) <= tolerance && place >= -tolerance &&
          place <= length + tolerance)
        widest = *c;
    }
  }
  return widest;
}

}  // namespace detail

/// Triangles that show a wall at its present pose; planes only within `around`.
struct WallTriangles {
  DynArray<Vec3d> points;  // [m]
  DynArray<std::array<std::uint32_t, 3>> triangles;
  DynArray<std::uint32_t> wall;       // number of the wall, for each point
  DynArray<std::uint32_t> unbounded;  // 1: of a plane, which goes on; for each point

  bool operator==(const WallTriangles&) const = default;
};
/// The walls of a simulation as triangles. Planes are cut at the box [m], and where they go behind
/// another plane of the same wall. Those that close a cylinder and move with it, as the ends of a
/// drum, are circles.
template <class Sim>
WallTriangles wall_triangles(const Sim& sim, const Box& around) {
  WallTriangles out;
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Pose& pose = sim.wall(w).pose;
    const DynArray<Plane> planes = detail::planes_of(sim.wall(w));
    std::size_t plane = 0;
    const auto add = [&](const detail::Outline& seen, const auto& place, bool unbounded) {
      const auto first = static_cast<std::uint32_t>(out.points.size());
      for (const auto& p : seen.points)
        out.points.push_back(place(p)), out.wall.push_back(static_cast<std::uint32_t>(w)),
            out.unbounded.push_back(unbounded);
      for (const auto& t : seen.triangles)
        out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    };
    const auto in_space = [&](const Vec3d& p) { return pose.to_space(p); };
    for (const auto& surface : sim.wall(w).surfaces)
      if (const auto* flat = std::get_if<Plane>(&surface)) {
        const detail::Outline cut = detail::outline(planes[plane++], around, planes);
        if (const auto round = detail::closed_cylinder(sim, w, *flat))
          add(detail::circular_outline(*flat, *round), in_space, false);
        else
          add(
              cut, [](const Vec3d& p) { return p; }, true);
      } else
        detail::visit_surface(
            surface, [&](const auto& s) { add(detail::outline(s, around), in_space, false); });
  }
  return out;
}

inline void write_walls(const std::string& file, const WallTriangles& walls) {
  VtkFields fields;
  fields.add("wall", walls.wall);
  fields.add("unbounded", walls.unbounded);
  write_vtp_triangles(file, walls.points, walls.triangles, fields);
}
/// Writes the walls at their present poses as triangles, with their numbers as the field `wall` and
/// `unbounded`, which is 1 on planes.
/// Planes are drawn within `around`, by default the region of the scene: of the particles, inlets
/// and finite walls, with planes that face each other in one wall, as those of box(), and with
/// planes across an axis that are at most two extents of all this away. Periodic directions are
/// drawn whole. InputError if there is nothing to write.
template <class Sim>
void write_walls(const std::string& file, const Sim& sim, const Box& around) {
  require(sim.walls() > 0, "write_walls: the simulation has no walls; add one, or leave this out");
  detail::on_all_ranks(sim, "a file of walls", [&] {
    if (sim.rank() == 0) write_walls(file, wall_triangles(sim, around));
  });
}
template <class Sim>
void write_walls(const std::string& file, const Sim& sim) {
  const Box around = detail::wall_region(sim);
  require(sim.walls() == 0 || !detail::is_empty(around),
          "write_walls: there are no particles and no finite walls whose region limits the planes; "
          "give a box as the third argument");
  write_walls(file, sim, around);
}

}  // namespace silt
