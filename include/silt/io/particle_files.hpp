// silt - BSD-3-Clause, see LICENSE
#pragma once

// Files of particles that ParaView opens: as points, as spheres of bodies, or as surfaces.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/rank_files.hpp>
#include <silt/shape/surface_mesh.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

inline std::array<float, 3> in_floats(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
/// Fields of modules; must outlive the file that they are written to.
struct ModuleFields {
  DynArray<DynArray<std::array<double, 3>>> vectors;
  DynArray<DynArray<double>> numbers;

  /// collect(value) returns value(place) for all places that are written.
  template <class Sim, class Collect>
  void add_to(VtkFields& fields, const Sim& sim, const Collect& collect) {
    sim.for_each_field([&]<std::size_t Components>(const std::string& name, const auto& value) {
      if constexpr (Components == 3)
        fields.add(name, vectors.emplace_back(collect(value)));
      else
        fields.add(name, numbers.emplace_back(collect(value)));
    });
  }
};

}  // namespace detail

/// Writes the particles to `file`: radius, velocity, id, material, and angular velocity if they
/// rotate. Bodies also have orientation (w, x, y, z) and form; their radius is that of the bounding
/// sphere. `more(sim, fields, places)` may add fields, with one value for each of the places. On
/// several ranks each rank writes its own particles as `file` with "_r0", "_r1" ... before the
/// ending, and rank 0 writes the index for ParaView: out/bed.pvtp for out/bed.vtp (collective).
template <class Sim, class More>
void write_particles(const std::string& file, const Sim& sim, const More& more) {
  DynArray<std::size_t> places;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) places.push_back(k);
  const auto collect = [&](auto value) {
    DynArray<decltype(value(std::size_t{}))> all;
    all.reserve(places.size());
    for (const auto k : places) all.push_back(value(k));
    return all;
  };
  const auto position = collect([&](std::size_t k) { return sim.position(k); });
  const auto radius = collect([&](std::size_t k) { return static_cast<float>(sim.radius(k)); });
  const auto velocity = collect([&](std::size_t k) { return detail::in_floats(sim.velocity(k)); });
  const auto id = collect([&](std::size_t k) { return sim.id(k); });
  const auto material =
      collect([&](std::size_t k) { return static_cast<std::uint32_t>(sim.material(k)); });
  VtkFields fields;
  fields.add("radius", radius).add("velocity", velocity).add("id", id).add("material", material);
  DynArray<std::array<float, 3>> spin;
  if constexpr (Sim::rotates) {
    spin = collect([&](std::size_t k) { return detail::in_floats(sim.angular_velocity(k)); });
    fields.add("angular_velocity", spin);
  }
  DynArray<std::array<float, 4>> orientation;
  DynArray<std::uint32_t> form;
  if constexpr (Sim::of_bodies) {
    orientation = collect([&](std::size_t k) {
      const Quaternion q = sim.orientation(k);
      return std::array<float, 4>{static_cast<float>(q.w), static_cast<float>(q.x),
                                  static_cast<float>(q.y), static_cast<float>(q.z)};
    });
    form = collect([&](std::size_t k) { return static_cast<std::uint32_t>(sim.form(k)); });
    fields.add("orientation", orientation).add("form", form);
  }
  detail::ModuleFields of_modules;
  of_modules.add_to(fields, sim, collect);
  detail::on_all_ranks(sim, "fields of particles", [&] { more(sim, fields, places); });
  detail::write_in_pieces(sim, file, fields, {},
                          [&](const auto& path) { write_vtp_points(path, position, fields); });
}
/// Writes the spheres of multi-sphere bodies: radius, and the id of the body.
template <class Sim>
void write_parts(const std::string& file, const Sim& sim) requires(Sim::of_bodies) {
  DynArray<Vec3d> position;
  DynArray<float> radius;
  DynArray<ParticleId> id;
  const auto& e = sim.engine();
  for (std::size_t row = 0; row < e.particles.owned(); ++row) {
    if (e.particles.is_parked(row)) continue;
    position.push_back(e.particles.position[row].centre());
    radius.push_back(static_cast<float>(e.particles.position[row].r));
    id.push_back(e.id_of(row));
  }
  VtkFields fields;
  fields.add("radius", radius).add("id", id);
  detail::write_in_pieces(sim, file, fields, {},
                          [&](const auto& path) { write_vtp_points(path, position, fields); });
}
/// Writes the surfaces of convex bodies: at every point id, form, velocity, material and the module
/// fields of the body; in a Mix also the number of its shape.
template <class Sim>
void write_surfaces(const std::string& file, const Sim& sim) requires(Sim::has_surfaces) {
  DynArray<SurfaceMesh> of_forms;
  for (const auto& form : sim.forms()) of_forms.push_back(surface_of(form.shape));
  SurfaceMesh all;
  DynArray<std::size_t> body;  // of each point
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    const SurfaceMesh& mesh = of_forms[sim.form(k)];
    const auto first = static_cast<std::uint32_t>(all.points.size());
    const Quaternion turn = sim.orientation(k);
    const Vec3d centroid = sim.forms()[sim.form(k)].mass.centroid;
    for (const Vec3d& p : mesh.points)
      all.points.push_back(sim.position(k) + rotate(turn, sim.scale(k) * (p - centroid)));
    for (const auto& t : mesh.triangles)
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    body.insert(body.end(), mesh.points.size(), k);
  }
  const auto collect = [&](auto value) {
    DynArray<decltype(value(std::size_t{}))> values;
    values.reserve(body.size());
    for (const std::size_t k : body) values.push_back(value(k));
    return values;
  };
  const auto number = [](auto n) { return static_cast<std::uint32_t>(n); };
  const auto id = collect([&](std::size_t k) { return sim.id(k); });
  const auto form = collect([&](std::size_t k) { return number(sim.form(k)); });
  const auto velocity = collect([&](std::size_t k) { return detail::in_floats(sim.velocity(k)); });
  const auto material = collect([&](std::size_t k) { return number(sim.material(k)); });
  VtkFields fields;
  fields.add("id", id).add("form", form).add("velocity", velocity).add("material", material);
  detail::ModuleFields of_modules;
  of_modules.add_to(fields, sim, collect);
  DynArray<std::uint32_t> shape;
  if constexpr (requires { sim.forms().front().shape.kind(); }) {
    for (const std::uint32_t f : form)
      shape.push_back(static_cast<std::uint32_t>(sim.forms()[f].shape.kind()));
    fields.add("shape", shape);
  }
  detail::write_in_pieces(sim, file, fields, {}, [&](const auto& path) {
    write_vtp_triangles(path, all.points, all.triangles, fields);
  });
}
template <class Sim>
void write_particles(const std::string& file, const Sim& sim) {
  write_particles(file, sim, [](const auto&, auto&, const auto&) {});
}

}  // namespace silt
