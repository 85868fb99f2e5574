// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/error.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Load of a part of a wall.
struct WallPart {
  Vec3d force{0, 0, 0};  // [N] on the part
  double normal = 0;     // [N] sum of the normal forces of its contacts
  double area = 0;       // [m2]
  std::size_t contacts = 0;
  double pressure() const { return area > 0 ? normal / area : 0; }  // [Pa]

  void add(const ContactSeen& c) { force -= c.force, normal += c.normal_force, ++contacts; }
};

/// Load of each triangle of surface `surface`, a mesh, of a wall, by number or name, in the order
/// of TriangleMesh::triangles(). A contact at an edge or vertex counts for the triangle with the
/// lowest number there. The sum is the force on the wall. Errors: InputError if the surface is not
/// a mesh.
template <class Sim>
std::vector<WallPart> facet_loads(const Sim& sim, const WhichWall& which, std::size_t surface = 0) {
  detail::need_one_process<Sim>();
  const std::size_t wall = sim.wall_number(which);
  const auto& surfaces = sim.wall(wall).surfaces;
  require(surface < surfaces.size() && detail::is_mesh(surfaces[surface]), "facet_loads: surface ",
          surface, " of ", sim.wall_name(wall),
          " is not a triangle mesh; for a cylinder use ring_loads");
  const TriangleMesh& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(surfaces[surface]);
  std::vector<WallPart> parts(mesh.triangles().size());
  for (std::size_t t = 0; t < parts.size(); ++t) {
    const auto& [p, q, r] = mesh.triangles()[t];
    const auto& at = mesh.vertices();
    parts[t].area = 0.5 * norm(cross(at[q] - at[p], at[r] - at[p]));
  }
  sim.for_each_contact([&](const ContactSeen& c) {
    if (c.wall == wall && c.surface == surface && c.facet < parts.size()) parts[c.facet].add(c);
  });
  return parts;
}

/// Writes a mesh wall at its present pose with the load of each triangle: force [N], pressure [Pa]
/// and number of contacts, at the three corners of each. Triangles do not share corners in the
/// file. `path` should end in .vtp.
template <class Sim>
void write_facet_loads(const std::string& path, const Sim& sim, const WhichWall& which,
                       std::size_t surface = 0) {
  const auto parts = facet_loads(sim, which, surface);
  const Wall& w = sim.wall(which);
  const TriangleMesh& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(w.surfaces[surface]);
  std::vector<Vec3d> points, force;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> pressure;
  std::vector<std::uint32_t> contacts;
  for (std::size_t t = 0; t < parts.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(points.size());
    triangles.push_back({first, first + 1, first + 2});
    for (const auto corner : mesh.triangles()[t]) {
      points.push_back(w.pose.to_space(mesh.vertices()[corner]));
      force.push_back(parts[t].force), pressure.push_back(parts[t].pressure());
      contacts.push_back(static_cast<std::uint32_t>(parts[t].contacts));
    }
  }
  VtkFields fields;
  fields.add("force", force).add("pressure", pressure).add("contacts", contacts);
  write_vtp_triangles(path, points, triangles, fields);
}

/// Loads of rings of equal height along the axis of a cylindrical surface, from its start. Contacts
/// beyond an end count for the last ring there; the sum of the rings is the force on the surface.
/// For a moving wall in its own coordinates.
/// Errors: InputError if the surface is not a Cylinder, or rings = 0.
template <class Sim>
std::vector<WallPart> ring_loads(const Sim& sim, const WhichWall& which, std::size_t rings,
                                 std::size_t surface = 0) {
  detail::need_one_process<Sim>();
  const std::size_t wall = sim.wall_number(which);
  const Wall& w = sim.wall(wall);
  require(surface < w.surfaces.size() && std::holds_alternative<Cylinder>(w.surfaces[surface]),
          "ring_loads: surface ", surface, " of ", sim.wall_name(wall),
          " is not a Cylinder; for a mesh use facet_loads");
  require(rings > 0, "ring_loads: rings = 0 [-] must be at least 1");
  const auto& cylinder = std::get<Cylinder>(w.surfaces[surface]);
  const double length = norm(cylinder.to - cylinder.from);
  const Vec3d axis = normalised(cylinder.to - cylinder.from);
  std::vector<WallPart> parts(rings);
  for (WallPart& part : parts)
    part.area = 2 * std::numbers::pi * cylinder.radius * length / static_cast<double>(rings);
  sim.for_each_contact([&](const ContactSeen& c) {
    if (c.wall != wall || c.surface != surface) return;
    const Vec3d point = w.moves() ? w.pose.to_body(c.wall_point) : c.wall_point;
    const double along =
        dot(point - cylinder.from, axis) / length * static_cast<double>(rings);  // [rings]
    const double last = static_cast<double>(rings - 1);
    parts[static_cast<std::size_t>(std::clamp(std::floor(along), 0.0, last))].add(c);
  });
  return parts;
}

}  // namespace silt
