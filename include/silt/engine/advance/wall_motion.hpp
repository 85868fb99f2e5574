// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/motion/rotation.hpp>

/// Integration of driven walls (boundary/wall_drive.hpp) with the leapfrog of the particles:
/// positions at the steps, velocities half a step behind, loads evaluated at the positions.
///
///   v(t + dt/2) = [(m - c dt/2) v(t - dt/2) + dt (F + m g - k s)]/(m + c dt/2),  s += v dt   (1)
///   L(t + dt/2) = L(t - dt/2) + dt T, orientation by NoSquish                                (2)
///
/// (1) for Slide, and for Hinge with inertia, torque and angle; (2) for free rotation. The dashpot
/// c is implicit and stable for any value. Momentum and angular momentum of particles and free
/// walls are conserved to rounding, as contact forces act at one point on both. Units: SI. Tests:
/// tests/engine/free_walls.cpp.

namespace silt::inline SILT_TARGET::detail {

/// Moves a driven wall for `elapsed` [s]: updates its pose and the state that depends on it.
inline void drift_wall(Wall& wall, double elapsed) {
  WallState& s = wall.state;
  if (std::holds_alternative<FreeBody>(wall.drive)) {
    s.centre += elapsed * s.velocity;
    NoSquish::drift(s.turn, s.momentum, s.principal, elapsed);
  } else {
    s.way += elapsed * s.rate;
  }
  wall.pose = pose_of(wall.drive, s);
}

/// Torque [N m] on the wall about `point` [m].
inline Vec3d torque_about(const Wall& wall, const Vec3d& point) {
  return wall.torque + cross(wall.reference - point, wall.force);
}

/// Torque about the centre of its drive, `point`, including that of a liquid.
inline Vec3d torque_on_drive(const Wall& wall, const Vec3d& point) {
  return torque_about(wall, point) + wall.liquid_torque;
}

/// One translational or angular velocity by (1).
inline double kicked(double rate, double inertia, double damping, double force, double time) {
  const double half = 0.5 * damping * time;
  return ((inertia - half) * rate + time * force) / (inertia + half);
}

/// The speed of a servo, (1) of wall_drive.hpp.
inline double servo_rate(WallState& s, double wanted, double now, double gain, double most,
                         double most_way, double time_step) {
  constexpr double settles = 40;     // [-] T over the time in which the load approaches its target
  const double miss = wanted - now;  // [N] or [N m]
  double rate = std::copysign(miss == 0 ? 0 : most, miss);
  if (s.stiffness > 0) {
    const double stiff = s.stiffness * time_step + s.damping;
    rate = gain * miss / stiff + s.drift;
    if (now * wanted >= 0.9 * wanted * wanted) s.has_landed = 1;
    if (std::abs(rate) < most) {
      const double share = s.has_landed == 1 ? 1 : std::min(1.0, 0.1 * std::abs(wanted / miss));
      const double time = settles * stiff / (gain * s.stiffness);  // [s] T
      s.drift += time_step / time * gain * share * miss / stiff;
    }
    rate = std::clamp(rate, -most, most);
  } else {
    s.drift = s.has_landed = 0;
  }
  // Limited to its travel.
  return std::clamp(rate, (-most_way - s.way) / time_step, (most_way - s.way) / time_step);
}

/// Updates the wall's velocity from the loads of this step, gravity and the forces of the drive,
/// over `kick_time` [s], which is shorter than the step for the first one.
inline void push_wall(Wall& wall, const Vec3d& gravity, double kick_time, double time_step,
                      bool first) {
  WallState& s = wall.state;
  const double before = s.rate;
  if (const auto* servo = std::get_if<ServoForce>(&wall.drive)) {
    s.rate = servo_rate(s, servo->force,
                        -dot(wall.force + wall.liquid_force, normalised(servo->direction)),
                        servo->gain, servo->max_speed, servo->max_travel, time_step);
  } else if (const auto* turner = std::get_if<ServoTorque>(&wall.drive)) {
    s.rate = servo_rate(s, turner->torque,
                        -dot(torque_on_drive(wall, turner->centre), normalised(turner->axis)),
                        turner->gain, turner->max_rate, turner->max_turn, time_step);
  } else if (const auto* slide = std::get_if<Slide>(&wall.drive)) {
    const double force =
        dot(wall.force + wall.liquid_force + slide->mass * gravity, normalised(slide->direction)) +
        slide->force - slide->stiffness * s.way;
    s.rate = kicked(s.rate, slide->mass, slide->damping, force, kick_time);
  } else if (const auto* hinge = std::get_if<Hinge>(&wall.drive)) {
    const Vec3d axis = normalised(hinge->axis);
    Vec3d torque = torque_on_drive(wall, hinge->centre);
    if (hinge->mass > 0)
      torque += cross(rotate(rotation_about(axis, s.way), hinge->centre_of_mass - hinge->centre),
                      hinge->mass * gravity);
    s.rate = kicked(s.rate, hinge->inertia, hinge->damping,
                    dot(torque, axis) + hinge->torque - hinge->stiffness * s.way, kick_time);
  } else if (const auto* body = std::get_if<FreeBody>(&wall.drive)) {
    const Vec3d velocity = s.velocity, momentum = s.momentum;
    s.velocity += kick_time * ((1 / body->mass) * (wall.force + wall.liquid_force) + gravity);
    s.momentum += kick_time * rotate(conjugate(s.turn), torque_on_drive(wall, s.centre));
    s.velocity_now = first ? velocity : 0.5 * (velocity + s.velocity);
    s.momentum_now = first ? momentum : 0.5 * (momentum + s.momentum);
  }
  s.rate_now = first ? before : 0.5 * (before + s.rate);
}

/// Call after an observed state: the step becomes `ratio` times as long.
inline void change_wall_step(Wall& wall, double ratio) {
  if (!is_free(wall.drive)) return;  // a servo's speed follows from the load
  WallState& s = wall.state;
  s.rate = s.rate_now + ratio * (s.rate - s.rate_now);
  s.velocity = s.velocity_now + ratio * (s.velocity - s.velocity_now);
  s.momentum = s.momentum_now + ratio * (s.momentum - s.momentum_now);
}

/// Energy of a wall with a mass at the last step [J].
struct WallEnergy {
  double kinetic = 0, gravity = 0, spring = 0;
  double sum() const { return kinetic + gravity + spring; }
};
inline WallEnergy energy_of(const Wall& wall, const Vec3d& gravity) {
  const WallState& s = wall.state;
  WallEnergy e;
  if (const auto* slide = std::get_if<Slide>(&wall.drive)) {
    e.kinetic = 0.5 * slide->mass * s.rate_now * s.rate_now;
    e.gravity = -slide->mass * dot(gravity, s.way * normalised(slide->direction));
    e.spring = 0.5 * slide->stiffness * s.way * s.way - slide->force * s.way;
  } else if (const auto* hinge = std::get_if<Hinge>(&wall.drive)) {
    const Vec3d arm = hinge->centre_of_mass - hinge->centre;
    e.kinetic = 0.5 * hinge->inertia * s.rate_now * s.rate_now;
    e.gravity =
        -hinge->mass * dot(gravity, rotate(rotation_about(normalised(hinge->axis), s.way), arm));
    e.spring = 0.5 * hinge->stiffness * s.way * s.way - hinge->torque * s.way;
  } else if (const auto* body = std::get_if<FreeBody>(&wall.drive)) {
    const Vec3d &v = s.velocity_now, &l = s.momentum_now, &I = s.principal;
    e.kinetic =
        0.5 * (body->mass * dot(v, v) + l.x * l.x / I.x + l.y * l.y / I.y + l.z * l.z / I.z);
    e.gravity = -body->mass * dot(gravity, s.centre);
  }
  return e;
}

/// Moves walls to their positions at `time` [s]; `elapsed` [s] since the last step, 0 before the
/// first.
inline void move_walls(std::span<Wall> walls, double time, double elapsed) {
  for (Wall& wall : walls) {
    if (wall.deforming > 0) --wall.deforming;
    if (!wall.moves()) continue;
    wall.last_pose = wall.pose;
    if (wall.is_driven())
      drift_wall(wall, elapsed);
    else
      wall.pose = wall.pose_at(time);
    wall.turned += mean_angular_velocity(wall.last_pose, wall.pose, 1);
  }
}

/// Called before the very first step: sets the last pose as if a step had preceded, so that walls
/// have their velocity from the start. (Motions need not be defined before time 0.)
inline void start_walls(std::span<Wall> walls, double time, double time_step) {
  for (Wall& wall : walls) {
    if (!wall.moves()) continue;
    if (wall.is_driven()) {
      Wall before = wall;
      drift_wall(before, -time_step);
      wall.last_pose = before.pose;
      continue;
    }
    const Pose next = wall.pose_at(time + time_step);
    const Quaternion back = wall.pose.rotation * conjugate(next.rotation);
    wall.last_pose = {
        back * wall.pose.rotation,
        wall.pose.translation + silt::rotate(back, wall.pose.translation - next.translation)};
  }
}

/// Power [W] of surface velocities on particles; call before the loads are integrated.
inline double power_of_belts(std::span<const Wall> walls) {
  double power = 0;
  for (const Wall& wall : walls) power += wall.belt_power;
  return power;
}

}  // namespace silt::detail
