// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/particle_files.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/rank_files.hpp>
#include <silt/io/schedule.hpp>
#include <silt/io/wall_files.hpp>

namespace silt::inline SILT_TARGET {

/// Saves a checkpoint to `path` at the times of the schedule, after all other observers. The file
/// is always complete: it is replaced at once. Creates its folder.
inline auto checkpoints(std::string path, Schedule schedule) {
  return at<ActionKind::Saves>(schedule, [path = std::move(path)](const auto& sim) {
    detail::on_all_ranks(sim, "the folder of checkpoints", [&] { make_folder_of(path); });
    save_checkpoint(sim, path);
  });
}

namespace detail {
/// Removes a file if one written before has the same content: a continued series then refers to
/// that, as one that was not interrupted does.
[[gnu::cold]] inline bool replaced_by(const std::string& file, const std::string& before) {
  if (file == before || !file_exists(before) || read_file(file) != read_file(before)) return false;
  return ::unlink(file.c_str()) == 0;
}

/// Opens a table. One that continues (Simulation::continues) keeps the rows of times before
/// `first`, the time of the next row.
template <class Sim>
std::shared_ptr<CsvTable> open_table(const std::string& path, const DynArray<std::string>& columns,
                                     const Sim& sim, double first) {
  return std::make_shared<CsvTable>(
      sim.continues(path) ? CsvTable::resume(path, columns, first - 0.5 * sim.step_length())
                          : CsvTable(path, columns));
}
}  // namespace detail

/// Appends a row of numbers to a CSV table: first the time (or the time since some event), then the
/// numbers that `row(simulation)` returns as an array, a vector or a single number. The table is
/// new, except in a run continued from a checkpoint and in a later run of the same simulation,
/// which keep the earlier rows. On many ranks each rank calls row(simulation), which must return
/// equal numbers on all, as the sums of a Simulation are; rank 0 writes.
template <class Row>
auto table(const std::string& path, const DynArray<std::string>& columns, Schedule schedule,
           Row row) {
  return at<ActionKind::Reads>(schedule,
                               [path, columns, row = std::move(row),
                                open = std::shared_ptr<CsvTable>()](const auto& sim) mutable {
                                 const auto values = detail::row_of(row(sim));
                                 if (sim.rank() != 0) return;
                                 if (!open)
                                   open = detail::open_table(path, columns, sim, values[0]);
                                 open->add_row(std::span<const double>(values));
                               });
}

/// Writes the time series `folder/particles.pvd` and `folder/walls.pvd` for ParaView. For bodies
/// also `folder/parts.pvd`, the spheres of multi-spheres, or `folder/surfaces.pvd`; with a
/// CoupledFlow `folder/flow.pvd`, with an Sph `folder/liquid.pvd`. Walls that did not change since
/// the previous frame are not written again; both frames refer to one file. On several ranks a
/// frame of particles is one file per rank and an index, as in write_particles(); the series lists
/// the indices, and ParaView opens the same `.pvd`. Rank 0 writes the rest. `more` adds fields as
/// in write_particles.
template <class More>
class VtkSeriesObserver {
 public:
  static constexpr bool only_reads = true, reads_contacts = false;

  VtkSeriesObserver(std::string folder, Schedule schedule, More more)
      : folder_(std::move(folder)), schedule_(schedule), more_(std::move(more)) {}

  template <class Sim>
  void begin(const Sim& sim, double);
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim);

 private:
  template <class Sim>
  void write_walls_once(const Sim& sim, const std::string& file);

  std::string folder_;
  Schedule schedule_;
  More more_;
  bool begun_ = false;
  std::optional<VtkSeries> particles_, walls_, parts_, flow_;  // parts or surfaces; of rank 0
  WallTriangles shown_;                                        // of the last frame
  std::string wall_file_;                                      // where they are
};

template <class More>
template <class Sim>
void VtkSeriesObserver<More>::begin(const Sim& sim, double) {
  schedule_.begin(sim, only_reads);
  if (std::exchange(begun_, true) || sim.rank() != 0) return;  // continues in another run
  const double keep = sim.time() + 0.5 * sim.step_length();
  const bool continues = sim.continues(folder_ + "/particles.pvd");
  const auto open = [&](const char* name) {
    return continues ? VtkSeries::resume(folder_, name, keep) : VtkSeries(folder_, name);
  };
  particles_ = open("particles"), walls_ = open("walls");
  if constexpr (Sim::has_surfaces)
    parts_ = open("surfaces");
  else if constexpr (Sim::of_bodies)
    parts_ = open("parts");
  if constexpr (detail::FluidTraits<typename Sim::Fluid>::is_written)
    flow_ = open(detail::FluidTraits<typename Sim::Fluid>::series_name());
}

template <class More>
template <class Sim>
void VtkSeriesObserver<More>::operator()(const Sim& sim) {
  const auto number = std::to_string(sim.step());
  const auto file = [&](const char* name, const char* kind = ".vtp") {
    return text(name, '_', std::string(9 - std::min<std::size_t>(9, number.size()), '0'), number,
                kind);
  };
  const auto list = [&](std::optional<VtkSeries>& series, const std::string& name) {
    if (sim.rank() == 0) series->add(sim.time(), detail::listed_file(sim, name));
  };
  write_particles(text(folder_, '/', file("particles")), sim, more_);
  list(particles_, file("particles"));
  if constexpr (Sim::has_surfaces) {
    write_surfaces(text(folder_, '/', file("surfaces")), sim);
    list(parts_, file("surfaces"));
  } else if constexpr (Sim::of_bodies) {
    write_parts(text(folder_, '/', file("parts")), sim);
    list(parts_, file("parts"));
  }
  using Fluid = detail::FluidTraits<typename Sim::Fluid>;
  if constexpr (Fluid::is_written) {
    const auto name = file(Fluid::series_name(), Sim::Fluid::file_kind);
    sim.fluid().write(text(folder_, '/', name));
    flow_->add(sim.time(), name);
  }
  if (sim.walls() > 0) write_walls_once(sim, file("walls"));
  schedule_.mark(sim);
}

template <class More>
template <class Sim>
void VtkSeriesObserver<More>::write_walls_once(const Sim& sim, const std::string& file) {
  const Box around = detail::wall_region(sim);
  if (sim.rank() != 0 || detail::is_empty(around)) return;
  WallTriangles now = wall_triangles(sim, around);
  if (wall_file_.empty() || now != shown_) {
    const std::string before = wall_file_.empty() ? walls_->last_file() : std::string();
    wall_file_ = file, shown_ = std::move(now);
    write_walls(text(folder_, '/', file), shown_);
    if (!before.empty() &&
        detail::replaced_by(text(folder_, '/', file), text(folder_, '/', before)))
      wall_file_ = before;
  }
  walls_->add(sim.time(), wall_file_);
}

template <class More>
VtkSeriesObserver<More> vtk_series(std::string folder, Schedule schedule, More more) {
  return {std::move(folder), schedule, std::move(more)};
}
inline auto vtk_series(std::string folder, Schedule schedule) {
  return vtk_series(std::move(folder), schedule, [](const auto&, auto&, const auto&) {});
}

}  // namespace silt
