// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <silt/boundary/outline.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/rank_files.hpp>
#include <silt/shape/surface_mesh.hpp>

namespace silt::inline SILT_TARGET {

/// Due at every multiple of `interval` [s] of simulated time, at the nearest step.
class Schedule {
 public:
  explicit Schedule(double interval) : interval_(interval) {
    require_positive("every: interval", interval, "s");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return number(sim) > last_;
  }
  template <class Sim>
  void mark(const Sim& sim) {
    last_ = number(sim);
  }
  /// Start of a run. The observer is due at once if its time has come and observers were not called
  /// at this instant yet. An observer that only reads is due even if they were, except in a run
  /// continued from a checkpoint. In several runs in turn the schedule continues. A run ends up to
  /// one step after its duration; for observers that only read this counts as the end.
  template <class Sim>
  void begin(const Sim& sim, bool only_reads = false) {
    const bool done = only_reads ? sim.continued() : sim.observed();
    if (!begun_) last_ = number(sim) - (on_time(sim, only_reads ? 1.0 : 0.5) && !done ? 1 : 0);
    begun_ = true;
  }

 private:
  template <class Sim>
  std::int64_t number(const Sim& sim) const {
    return static_cast<std::int64_t>(
        std::floor((sim.time() + 0.5 * sim.step_length()) / interval_ * (1 + 1e-12)));
  }
  /// Whether the last instant is at most `steps` steps ago, or half a step ahead.
  template <class Sim>
  bool on_time(const Sim& sim, double steps) const {
    const double since = sim.time() - static_cast<double>(number(sim)) * interval_;
    return since <= steps * (1 + 1e-9) * sim.step_length();
  }

  double interval_;  // [s]
  std::int64_t last_ = -1;
  bool begun_ = false;
};

inline Schedule every(double interval) { return Schedule(interval); }

/// Effect of an action on the simulation: any; reads it only; saves it.
enum class ActionKind { Any, Reads, Saves };

/// Calls `action(simulation)` at the times of its schedule:
///   sim.run(1.0, silt::at(every(0.1), [&](const auto& s) { ... }));
template <class Action, ActionKind Kind = ActionKind::Any>
class TimedAction {
 public:
  static constexpr bool only_reads = Kind != ActionKind::Any, saves = Kind == ActionKind::Saves;

  TimedAction(Schedule schedule, Action action) : schedule_(schedule), action_(std::move(action)) {}
  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim, only_reads);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(Sim& sim) {
    action_(sim);
    schedule_.mark(sim);
  }

 private:
  Schedule schedule_;
  Action action_;
};

template <ActionKind Kind = ActionKind::Any, class Action>
TimedAction<Action, Kind> at(Schedule schedule, Action action) {
  return {schedule, std::move(action)};
}

/// Saves a checkpoint to `path` at the times of the schedule, after all other observers. The file
/// is always complete: it is replaced at once. Creates its folder.
inline auto checkpoints(std::string path, Schedule schedule) {
  return at<ActionKind::Saves>(schedule, [path = std::move(path)](const auto& sim) {
    detail::on_all_ranks(sim, "the folder of checkpoints", [&] { make_folder_of(path); });
    save_checkpoint(sim, path);
  });
}

namespace detail {
/// Opens a new table. A run continued from a checkpoint keeps the rows of times before `first`, the
/// time of the next row.
template <class Sim>
std::shared_ptr<CsvTable> open_table(const std::string& path,
                                     const std::vector<std::string>& columns, const Sim& sim,
                                     double first) {
  return std::make_shared<CsvTable>(
      sim.continued() ? CsvTable::resume(path, columns, first - 0.5 * sim.step_length())
                      : CsvTable(path, columns));
}
}  // namespace detail

/// Appends a row of numbers to a CSV table: first the time (or the time since some event), then the
/// numbers that `row(simulation)` returns as an array, a vector or a single number. The table is
/// new, except in a run continued from a checkpoint, which keeps the earlier rows. On many ranks
/// each rank calls row(simulation), which must return equal numbers on all, as the sums of a
/// Simulation are; rank 0 writes.
template <class Row>
auto table(const std::string& path, const std::vector<std::string>& columns, Schedule schedule,
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

namespace detail {

inline std::array<float, 3> in_floats(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
/// Fields of modules; must outlive the file that they are written to.
struct ModuleFields {
  std::vector<std::vector<std::array<double, 3>>> vectors;
  std::vector<std::vector<double>> numbers;

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
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) places.push_back(k);
  const auto collect = [&](auto value) {
    std::vector<decltype(value(std::size_t{}))> all;
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
  std::vector<std::array<float, 3>> spin;
  if constexpr (Sim::rotates) {
    spin = collect([&](std::size_t k) { return detail::in_floats(sim.angular_velocity(k)); });
    fields.add("angular_velocity", spin);
  }
  std::vector<std::array<float, 4>> orientation;
  std::vector<std::uint32_t> form;
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
  std::vector<Vec3d> position;
  std::vector<float> radius;
  std::vector<ParticleId> id;
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
  std::vector<SurfaceMesh> of_forms;
  for (const auto& form : sim.forms()) of_forms.push_back(surface_of(form.shape));
  SurfaceMesh all;
  std::vector<std::size_t> body;  // of each point
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
    std::vector<decltype(value(std::size_t{}))> values;
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
  std::vector<std::uint32_t> shape;
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

/// Writes the time series `folder/particles.pvd` and `folder/walls.pvd` for ParaView. For bodies
/// also `folder/parts.pvd`, the spheres of multi-spheres, or `folder/surfaces.pvd`; with a fluid
/// `folder/flow.pvd`. Walls that did not change since the previous frame are not written again;
/// both frames refer to one file. On several ranks a frame of particles is one file per rank and an
/// index, as in write_particles(); the series lists the indices, and ParaView opens the same
/// `.pvd`. Rank 0 writes the rest. `more` adds fields as in write_particles.
template <class More>
class VtkSeriesObserver {
 public:
  static constexpr bool only_reads = true, reads_contacts = false;

  VtkSeriesObserver(std::string folder, Schedule schedule, More more)
      : folder_(std::move(folder)), schedule_(schedule), more_(std::move(more)) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim, only_reads);
    if (std::exchange(begun_, true) || sim.rank() != 0) return;  // continues in another run
    const double keep = sim.time() + 0.5 * sim.step_length();
    const auto open = [&](const char* name) {
      return sim.continued() ? VtkSeries::resume(folder_, name, keep) : VtkSeries(folder_, name);
    };
    particles_ = open("particles"), walls_ = open("walls");
    if constexpr (Sim::has_surfaces)
      parts_ = open("surfaces");
    else if constexpr (Sim::of_bodies)
      parts_ = open("parts");
    if constexpr (detail::FluidTraits<typename Sim::Fluid>::is_written) flow_ = open("flow");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
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
    if constexpr (detail::FluidTraits<typename Sim::Fluid>::is_written) {
      const auto name = file("flow", Sim::Fluid::file_kind);
      sim.fluid().write(text(folder_, '/', name));
      flow_->add(sim.time(), name);
    }
    if (sim.size() > 0 && sim.walls() > 0) write_walls_once(sim, file("walls"));
    schedule_.mark(sim);
  }

 private:
  template <class Sim>
  void write_walls_once(const Sim& sim, const std::string& file) {
    const Box around = detail::occupied(sim);
    if (sim.rank() != 0) return;
    WallTriangles now = wall_triangles(sim, around);
    if (wall_file_.empty() || now != shown_) {
      wall_file_ = file, shown_ = std::move(now);
      write_walls(text(folder_, '/', wall_file_), shown_);
    }
    walls_->add(sim.time(), wall_file_);
  }

  std::string folder_;
  Schedule schedule_;
  More more_;
  bool begun_ = false;
  std::optional<VtkSeries> particles_, walls_, parts_, flow_;  // parts or surfaces; of rank 0
  WallTriangles shown_;                                        // of the last frame
  std::string wall_file_;                                      // where they are
};

template <class More>
VtkSeriesObserver<More> vtk_series(std::string folder, Schedule schedule, More more) {
  return {std::move(folder), schedule, std::move(more)};
}
inline auto vtk_series(std::string folder, Schedule schedule) {
  return vtk_series(std::move(folder), schedule, [](const auto&, auto&, const auto&) {});
}

}  // namespace silt
