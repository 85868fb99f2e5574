// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/error.hpp>
#include <silt/files/vtk.hpp>
#include <silt/module/wear.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {
template <class Sim>
const TriangleMesh& worn_mesh(const Sim& sim, const WhichWall& which, std::size_t surface) {
  const auto& surfaces = sim.wall(which).surfaces;
  require(!sim.wall(which).is_removed(), "worn_volumes: ", sim.wall_name(sim.wall_number(which)),
          " was removed, and its facets with it; read its wear before remove_wall()");
  require(surface < surfaces.size() && is_mesh(surfaces[surface]), "worn_volumes: surface ",
          surface, " of ", sim.wall_name(sim.wall_number(which)),
          " is not a triangle mesh; wear is computed for meshes only");
  return *std::get<std::shared_ptr<const TriangleMesh>>(surfaces[surface]);
}
}  // namespace detail

/// Worn volume of each triangle [m3] by a module M since the start, or since set_mesh gave the wall
/// other triangles, in the order of TriangleMesh::triangles(). A contact at an edge or vertex
/// counts for the triangle with the lowest number there. On many ranks it includes the particles of
/// all (collective).
/// Errors: InputError if the surface is not a mesh, or the wall was removed.
template <class M, class Sim>
std::vector<double> worn_volumes(const Sim& sim, const WhichWall& which, std::size_t surface = 0) {
  static_assert(Sim::Modules::template times<M> == 1, "this simulation has no such module");
  static_assert(detail::WearsWalls<M>, "this module does not wear walls");
  const TriangleMesh& mesh = detail::worn_mesh(sim, which, surface);
  const Wall& wall = sim.wall(which);
  std::vector<double> volumes(mesh.triangles().size(), 0);
  if (wall.worn.empty() && !Sim::has_ranks) return volumes;
  const std::size_t first = detail::facets_before(wall, surface);
  for (std::size_t t = 0; t < volumes.size() && !wall.worn.empty(); ++t)
    volumes[t] =
        wall.worn[(first + t) * Sim::Modules::wearing + Sim::Modules::template wear_index<M>];
  sim.sum_over_ranks(std::span<double>(volumes));
  return volumes;
}
/// Total worn volume [m3].
template <class M, class Sim>
double worn_volume(const Sim& sim, const WhichWall& which, std::size_t surface = 0) {
  const auto all = worn_volumes<M>(sim, which, surface);
  return std::accumulate(all.begin(), all.end(), 0.0);
}

/// Writes a mesh wall at its present pose with the wear of each triangle: volume [m3] and mean
/// depth [m], at the three corners of each. Triangles do not share corners in the file. `path`
/// should end in .vtp.
template <class M, class Sim>
void write_wear(const std::string& path, const Sim& sim, const WhichWall& which,
                std::size_t surface = 0) {
  const auto volumes = worn_volumes<M>(sim, which, surface);
  const TriangleMesh& mesh = detail::worn_mesh(sim, which, surface);
  const Wall& wall = sim.wall(which);
  std::vector<Vec3d> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> volume, depth;
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(points.size());
    triangles.push_back({first, first + 1, first + 2});
    const auto& [p, q, r] = mesh.triangles()[t];
    const auto& at = mesh.vertices();
    const double area = 0.5 * norm(cross(at[q] - at[p], at[r] - at[p]));
    for (const auto corner : {p, q, r}) {
      points.push_back(wall.pose.to_space(at[corner]));
      volume.push_back(volumes[t]), depth.push_back(volumes[t] / area);
    }
  }
  VtkFields fields;
  fields.add("worn volume", volume).add("worn depth", depth);
  detail::on_all_ranks(sim, "write_wear", [&] {
    if (sim.rank() == 0) write_vtp_triangles(path, points, triangles, fields);
  });
}

}  // namespace silt
