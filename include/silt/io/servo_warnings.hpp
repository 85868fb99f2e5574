// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// State and limits of a servo, along its direction [m] or about its axis [rad].
struct ServoWay {
  const char* what;     // the drive
  const char* turn;     // the field that gives the sign
  const char* way;      // its unit
  double wanted, most;  // [N] or [N m], [1/s] of the way
  double most_way;      // [m] or [rad]
};
inline ServoWay servo_way(const WallDrive& drive) {
  if (const auto* d = std::get_if<ServoForce>(&drive))
    return {"ServoForce", "direction", "m", d->force, d->max_speed, d->max_travel};
  const auto& d = std::get<ServoTorque>(drive);
  return {"ServoTorque", "axis", "rad", d.torque, d.max_rate, d.max_turn};
}

/// Whether it moved with its greatest speed since it was released, or to the end of its travel, and
/// has no load now. 1 %: the first step, and rounding.
inline bool never_met_its_load(const Wall& wall, double time) {
  const ServoWay servo = servo_way(wall.drive);
  const double free_way = servo.most * (time - wall.state.since);
  const double way = std::copysign(1.0, servo.wanted) * wall.state.way;
  return servo.wanted != 0 && time > wall.state.since && norm(wall.force) == 0 &&
         norm(wall.liquid_force) == 0 && way >= 0.99 * std::min(free_way, servo.most_way);
}

}  // namespace detail

/// Warnings after a run: servos without contact since they were released. They use only the
/// position of the wall: a wall that met its load and lost it at once counts as one that never did.
/// Tests:   tests/io/servo_warnings.cpp.
template <class Sim>
[[gnu::cold]] DynArray<std::string> servo_warnings(const Sim& sim) {
  DynArray<std::string> out;
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    if (!detail::is_servo(wall.drive) || !detail::never_met_its_load(wall, sim.time())) continue;
    const detail::ServoWay servo = detail::servo_way(wall.drive);
    out.push_back(
        text(sim.wall_name(w), ": its ", servo.what, " has moved it by ", wall.state.way, " ",
             servo.way, " in ", sim.time() - wall.state.since,
             " s without meeting a load; if it moves away from the particles, reverse its ",
             servo.turn, ", else run longer or raise its greatest speed"));
  }
  return out;
}

}  // namespace silt
