// silt - BSD-3-Clause, see LICENSE
#pragma once

// Files of walls that ParaView opens: as triangles.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <silt/boundary/outline.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/rank_files.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Region [m] of the particles of a simulation, of all ranks (collective).
template <class Sim>
Box occupied(const Sim& sim) {
  Box around;
  double largest = 0;  // [m]
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) {
      around.include(sim.position(k));
      largest = std::max(largest, sim.radius(k));
    }
  if constexpr (Sim::has_ranks) {
    sim.engine().ranks.meet("the region of particles");
    around = sim.engine().ranks.union_of(around);
    largest = sim.engine().ranks.max_of(largest);
  }
  return around.grown(largest);
}

}  // namespace detail

/// Triangles that show a wall at its present pose; planes only within `around`.
struct WallTriangles {
  std::vector<Vec3d> points;  // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> wall;  // number of the wall, for each point

  bool operator==(const WallTriangles&) const = default;
};
/// The walls of a simulation as triangles; infinite ones are cut at the box [m].
template <class Sim>
WallTriangles wall_triangles(const Sim& sim, const Box& around) {
  WallTriangles out;
  for (std::size_t w = 0; w < sim.walls(); ++w)
    for (const auto& surface : sim.wall(w).surfaces)
      detail::visit_surface(surface, [&](const auto& s) {
        const auto first = static_cast<std::uint32_t>(out.points.size());
        const Pose& pose = sim.wall(w).pose;
        Box seen;  // `around` in the wall's coordinates
        for (int c = 0; c < 8; ++c)
          seen.include(pose.to_body({c & 1 ? around.max.x : around.min.x,
                                     c & 2 ? around.max.y : around.min.y,
                                     c & 4 ? around.max.z : around.min.z}));
        const auto [points, triangles] = detail::outline(s, seen);
        for (const auto& p : points)
          out.points.push_back(pose.to_space(p)), out.wall.push_back(static_cast<std::uint32_t>(w));
        for (const auto& t : triangles)
          out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      });
  return out;
}

inline void write_walls(const std::string& file, const WallTriangles& walls) {
  VtkFields fields;
  fields.add("wall", walls.wall);
  write_vtp_triangles(file, walls.points, walls.triangles, fields);
}
/// Writes the walls at their present poses as triangles, with their numbers as the field `wall`.
/// Planes are drawn within `around`, by default the region of the particles. InputError if there is
/// nothing to write.
template <class Sim>
void write_walls(const std::string& file, const Sim& sim, const Box& around) {
  require(sim.walls() > 0, "write_walls: the simulation has no walls; add one, or leave this out");
  detail::on_all_ranks(sim, "a file of walls", [&] {
    if (sim.rank() == 0) write_walls(file, wall_triangles(sim, around));
  });
}
template <class Sim>
void write_walls(const std::string& file, const Sim& sim) {
  require(sim.size() > 0,
          "write_walls: there are no particles whose region limits the planes; give a box as "
          "the third argument");
  write_walls(file, sim, detail::occupied(sim));
}

}  // namespace silt
