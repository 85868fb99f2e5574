// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {

/// Writes the particles as a CSV file, one line each in the order of their ids: id, x, y, z [m],
/// velocity [m/s], radius [m], material, angular velocity [rad/s] if they rotate, and the fields of
/// modules. An existing file is replaced as a whole. On many ranks rank 0 writes the particles of
/// all and needs the memory for their lines (collective).
template <class Sim>
void write_particle_csv(const std::string& file, const Sim& sim) {
  DynArray<std::string> columns{"id", "x", "y", "z"};
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
  DynArray<detail::SortedLine> lines;
  DynArray<double> row;
  const auto add = [&row](const Vec3d& v) { row.insert(row.end(), {v.x, v.y, v.z}); };
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    std::string line = std::to_string(sim.id(k));
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
    for (const double number : row) line += ',', detail::append(line, number);
    lines.push_back({sim.id(k), 0, std::move(line)});
  }
  lines = detail::gather_lines(sim, std::move(lines));
  detail::on_all_ranks(sim, "a table of particles", [&] {
    if (sim.rank() != 0) return;
    const std::string header = CsvTable::header(file, columns);
    AtomicFile out(file);
    out.write(header);
    for (const auto& line : lines) out.write(line.words + '\n');
    out.commit();
  });
}

/// Writes `folder/particles_<step>.csv` at the times of the schedule.
inline auto csv_series(std::string folder, Schedule schedule) {
  return at<ActionKind::Reads>(schedule, [folder = std::move(folder)](const auto& sim) {
    const auto number = std::to_string(sim.step());
    detail::on_all_ranks(sim, "the folder of a table", [&] { make_folder(folder); });
    write_particle_csv(
        text(folder, "/particles_", std::string(9 - std::min<std::size_t>(9, number.size()), '0'),
             number, ".csv"),
        sim);
  });
}

}  // namespace silt
