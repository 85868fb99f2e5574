// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Mean load of a wall between two reads: its impulse, summed over every step, divided by the time.
/// With collisions the force of a single step is not representative.
///
///   silt::MeanLoad lid(sim, "lid");
///   sim.run(0.1);
///   const auto mean = lid.read(sim);    // mean.force [N], mean.torque [N m], mean.duration [s]
///
/// Tests: tests/engine/wall_setup.cpp
class MeanLoad {
 public:
  struct Load {
    Vec3d force{}, torque{};  // [N], [N m] on the wall, about its reference
    double duration = 0;      // [s]; 0: no time has passed, and the mean is not known
  };

  template <class Sim>
  MeanLoad(const Sim& sim, const WhichWall& which) : wall_(sim.wall_number(which)) {
    start(sim);
  }
  /// Mean since the last read, or since the start.
  template <class Sim>
  Load read(const Sim& sim) {
    const Wall& wall = sim.wall(wall_);
    Load mean{wall.impulse - impulse_, wall.angular_impulse - angular_, sim.time() - time_};
    if (mean.duration > 0) {
      mean.force *= 1 / mean.duration, mean.torque *= 1 / mean.duration;
      start(sim);
    } else {
      mean = {};
    }
    return mean;
  }
  /// Goes on from a reading at `time` [s] with the impulse [N s] and angular impulse [N m s] that
  /// the wall had then. A wall without any impulse was added since, and has its mean since now.
  template <class Sim>
  void go_on(const Sim& sim, double time, const Vec3d& impulse, const Vec3d& angular) {
    const Vec3d none{0, 0, 0};
    const Wall& wall = sim.wall(wall_);
    if (wall.impulse == none && wall.angular_impulse == none && impulse != none) return;
    impulse_ = impulse, angular_ = angular;
    time_ = time - (time == 0 && impulse == none ? sim.step_length() : 0);
  }

 private:
  template <class Sim>
  void start(const Sim& sim) {
    const Wall& wall = sim.wall(wall_);
    impulse_ = wall.impulse, angular_ = wall.angular_impulse, time_ = sim.time();
    // The load of the first step belongs to a step that ends at time 0.
    if (sim.step() == 0 && impulse_ == Vec3d{0, 0, 0}) time_ -= sim.step_length();
  }
  std::size_t wall_;
  Vec3d impulse_{}, angular_{};
  double time_ = 0;
};

/// Writes the motion and load of a wall to a CSV table: time, mean force and torque since the last
/// row (about the wall's reference), impulse and angular impulse since the start, position of its
/// origin, travel [m] or [rad] of a wall driven along a line or about an axis, and the angle of
/// rotation about each axis since the start. The power of a rotating wall is torque times angle
/// over time, between two rows.
///
///   sim.run(1, silt::wall_series("lid.csv", "lid", silt::every(0.01)));
///
/// A table that continues, after a restart or in a later run, goes on from its last row.
/// Errors: InputError for a wall that does not exist; FileError.
class WallSeriesObserver {
 public:
  WallSeriesObserver(std::string path, std::string name, std::size_t number, Schedule schedule)
      : path_(std::move(path)), name_(std::move(name)), number_(number), schedule_(schedule) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim);
    if (mean_ && (table_ || sim.rank() != 0)) return;
    const std::size_t wall =
        name_.empty() ? sim.wall_number(number_) : sim.wall_number(std::string_view(name_));
    mean_ = std::make_shared<MeanLoad>(sim, wall), number_ = wall;
    static const DynArray<std::string> columns{"time [s]",
                                               "force x [N]",
                                               "force y [N]",
                                               "force z [N]",
                                               "torque x [N m]",
                                               "torque y [N m]",
                                               "torque z [N m]",
                                               "impulse x [N s]",
                                               "impulse y [N s]",
                                               "impulse z [N s]",
                                               "angular impulse x [N m s]",
                                               "angular impulse y [N m s]",
                                               "angular impulse z [N m s]",
                                               "x [m]",
                                               "y [m]",
                                               "z [m]",
                                               "way [m or rad]",
                                               "angle x [rad]",
                                               "angle y [rad]",
                                               "angle z [rad]"};
    if (sim.rank() != 0) return;
    const double keep = sim.time() + 0.5 * sim.step_length();  // the row of now is there already
    table_ = std::make_shared<CsvTable>(
        sim.continues(path_) ? CsvTable::resume(path_, columns, keep) : CsvTable(path_, columns));
    if (const auto& row = table_->kept_row(); !row.empty())
      mean_->go_on(sim, row[0], {row[7], row[8], row[9]}, {row[10], row[11], row[12]});
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    const MeanLoad::Load mean = mean_->read(sim);
    const Wall& wall = sim.wall(number_);
    DynArray<double> row{sim.time()};
    for (const Vec3d& v :
         {mean.force, mean.torque, wall.impulse, wall.angular_impulse, wall.pose.translation})
      row.insert(row.end(), {v.x, v.y, v.z});
    row.push_back(wall.state.way);
    row.insert(row.end(), {wall.turned.x, wall.turned.y, wall.turned.z});
    if (table_) table_->add_row(std::span<const double>(row));
    schedule_.mark(sim);
  }

 private:
  std::string path_, name_;
  std::size_t number_;
  Schedule schedule_;
  std::shared_ptr<CsvTable> table_;
  std::shared_ptr<MeanLoad> mean_;
};

inline WallSeriesObserver wall_series(std::string path, const WhichWall& which, Schedule schedule) {
  return {std::move(path), std::string(which.by_name() ? which.name() : ""),
          which.by_name() ? 0 : which.number(), schedule};
}

}  // namespace silt
