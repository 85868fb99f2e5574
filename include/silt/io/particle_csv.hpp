// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <silt/files/csv_table.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {

/// Writes the particles that are there as a CSV file, a line each in the order of their ids: id, x,
/// y, z [m], velocity [m/s], radius [m], material, angular velocity [rad/s] if they rotate, and the
/// fields of modules. A file that is there is replaced as a whole.
template <class Sim>
void write_particle_csv(const std::string& file, const Sim& sim) {
  std::vector<std::string> columns{"id", "x", "y", "z"};
  const auto name_vector = [&](const std::string& name) {
    for (const char* axis : {" x", " y", " z"}) columns.push_back(name + axis);
  };
  name_vector("velocity");
  columns.push_back("radius"), columns.push_back("material");
  if constexpr (Sim::rotates) name_vector("angular velocity");
  sim.for_each_field([&]<std::size_t Components>(const std::string& name, const auto&) {
    if constexpr (Components == 3)
      name_vector(name);
    else
      columns.push_back(name);
  });
  std::vector<std::pair<ParticleId, std::size_t>> places;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) places.push_back({sim.id(k), k});
  std::sort(places.begin(), places.end());

  std::string all;
  for (const auto& name : columns) {
    if (!all.empty()) all += ',';
    all += name;
  }
  std::vector<double> row;
  const auto add = [&row](const Vec3d& v) { row.insert(row.end(), {v.x, v.y, v.z}); };
  for (const auto& [id, place] : places) {
    const std::size_t k = place;
    all += '\n';
    all += std::to_string(id);
    row.clear();
    add(sim.position(k)), add(sim.velocity(k));
    row.insert(row.end(), {sim.radius(k), static_cast<double>(sim.material(k))});
    if constexpr (Sim::rotates) add(sim.angular_velocity(k));
    sim.for_each_field([&]<std::size_t Components>(const std::string&, const auto& value) {
      if constexpr (Components == 3) {
        const auto v = value(k);
        add({v[0], v[1], v[2]});
      } else {
        row.push_back(value(k));
      }
    });
    for (const double number : row) all += ',', detail::append(all, number);
  }
  all += '\n';
  AtomicFile out(file);
  out.write(all);
  out.commit();
}

/// Writes `folder/particles_<step>.csv` at the times of the schedule.
inline auto csv_series(std::string folder, Schedule schedule) {
  return at<ActionKind::Reads>(schedule, [folder = std::move(folder)](const auto& sim) {
    const auto number = std::to_string(sim.step());
    make_folder(folder);
    write_particle_csv(
        text(folder, "/particles_", std::string(9 - std::min<std::size_t>(9, number.size()), '0'),
             number, ".csv"),
        sim);
  });
}

}  // namespace silt
