// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

namespace detail {

/// Total rotation [rad] of a wall about each axis: the sum of its rotations between readings. For a
/// wall with a fixed axis it is the angle about that axis, whole turns included, for any drive.
/// Readings may be more than half a turn apart if the rate is steady; it gives the number of whole
/// turns.
class TurnedAngle {
 public:
  const Vec3d& look(const Pose& now, const Pose& step_ago, double steps_since) {
    const Vec3d step = mean_angular_velocity(step_ago, now, 1);
    Vec3d turn = mean_angular_velocity(last_, now, 1);  // less than half a turn
    const double size = norm(turn), rate = norm(step);
    if (rate > 0) {
      const Vec3d axis = size > 1e-9 ? (1 / size) * turn : (1 / rate) * step;
      const double angle = dot(turn, axis), whole = 2 * std::numbers::pi;
      turn = (angle + whole * std::round((steps_since * dot(step, axis) - angle) / whole)) * axis;
    }
    last_ = now, sum_ += turn;
    return sum_;
  }
  void start(const Pose& now) { last_ = now; }

 private:
  Pose last_{};
  Vec3d sum_{0, 0, 0};
};

}  // namespace detail

/// Writes the motion and load of a wall to a CSV table: time, mean force and torque since the last
/// row (about the wall's reference), impulse and angular impulse since the start, position of its
/// origin, travel [m] or [rad] of a wall driven along a line or about an axis, and the angle of
/// rotation about each axis since the first row. The power of a rotating wall is torque times angle
/// over time, between two rows.
///
///   sim.run(1, silt::wall_series("lid.csv", "lid", silt::every(0.01)));
///
/// After a restart the first row is the mean since the checkpoint.
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
    angle_ = std::make_shared<detail::TurnedAngle>(), last_time_ = sim.time();
    angle_->start(sim.wall(wall).pose);
    static const std::vector<std::string> columns{"time [s]",
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
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    const MeanLoad::Load mean = mean_->read(sim);
    const Wall& wall = sim.wall(number_);
    std::vector<double> row{sim.time()};
    for (const Vec3d& v :
         {mean.force, mean.torque, wall.impulse, wall.angular_impulse, wall.pose.translation})
      row.insert(row.end(), {v.x, v.y, v.z});
    row.push_back(wall.state.way);
    const Vec3d angle =
        angle_->look(wall.pose, wall.last_pose, (sim.time() - last_time_) / sim.step_length());
    last_time_ = sim.time();
    row.insert(row.end(), {angle.x, angle.y, angle.z});
    if (table_) table_->add_row(std::span<const double>(row));
    schedule_.mark(sim);
  }

 private:
  std::string path_, name_;
  std::size_t number_;
  Schedule schedule_;
  std::shared_ptr<CsvTable> table_;
  std::shared_ptr<MeanLoad> mean_;
  std::shared_ptr<detail::TurnedAngle> angle_;
  double last_time_ = 0;  // [s]
};

inline WallSeriesObserver wall_series(std::string path, const WhichWall& which, Schedule schedule) {
  return {std::move(path), std::string(which.by_name() ? which.name() : ""),
          which.by_name() ? 0 : which.number(), schedule};
}

}  // namespace silt
