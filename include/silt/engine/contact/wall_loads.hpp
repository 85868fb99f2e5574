// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/boundary/wall.hpp>
#include <silt/core/lanes.hpp>
#include <silt/engine/contact/step_times.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The load of spheres on a wall.
struct WallLoad {
  Vec3d force{0, 0, 0}, torque{0, 0, 0};  // [N], [N m] about the wall's reference
  double power = 0;                       // [W] of the surface velocity, on particles
};

/// A sphere, by its place, with too many contacts at a wall.
struct CrowdedContact {
  std::uint32_t particle, wall;
};

/// Mean angular velocity [rad/s] from one pose to the next.
inline Vec3d mean_angular_velocity(const Pose& from, const Pose& to, double time_step) {
  const Quaternion d = to.rotation * conjugate(from.rotation);
  const Vec3d axis{d.x, d.y, d.z};
  const double sine = norm(axis);
  if (sine == 0) return {0, 0, 0};
  const double angle = 2 * std::atan2(d.w < 0 ? -sine : sine, std::abs(d.w));
  return axis * (angle / (sine * time_step));
}

/// Angular velocity [rad/s] of a wall's surface: of its motion over the last step, and of a belt.
inline Vec3d spin_of_surface(const Wall& wall, double step) {
  if (!wall.moves()) return {0, 0, 0};
  const Vec3d of_motion = mean_angular_velocity(wall.last_pose, wall.pose, step);
  return wall.has_belt() ? of_motion + wall.belt.rate : of_motion;
}

/// As mean_velocity() [m/s], plus the velocity of a belt.
inline Vec3d velocity_at_contact(const Wall& wall, const Vec3d& place, const Vec3d& normal,
                                 double step) {
  const Vec3d v = mean_velocity(wall, place, step);
  return wall.has_belt() ? v + wall.belt.at(place, normal) : v;
}

/// Motion of a wall at a contact.
struct WallVelocity {
  Vec3d velocity{0, 0, 0}, spin{0, 0, 0};  // [m/s], [rad/s]
};

/// The mean velocity over the last step, consistent with the particles' half-step velocities, of
/// the wall point that was under the contact half a step ago; if the particle slides, this is not
/// the present point. `change` of the normal over the step; `velocity` [m/s] of the particle's
/// centre, at a `distance` [m] that follows the normal.
SILT_INLINE WallVelocity velocity_of_wall(const Wall& wall, const Vec3d& on_wall,
                                          const Vec3d& change, const Vec3d& velocity,
                                          double distance, const StepTimes& times) {
  WallVelocity w;
  if (!wall.moves()) return w;
  w.velocity = mean_velocity(wall, on_wall, times.step);
  w.spin = mean_angular_velocity(wall.last_pose, wall.pose, times.step);
  w.velocity += cross(
      w.spin, times.lag * times.step * (w.velocity - velocity) + times.lag * distance * change);
  return w;
}

/// Velocity [m/s] of a belt at a contact at the time of the particles' velocities, half a step ago
/// with Leapfrog, less that of now. Without it, a ball that rolls on a turntable would lose
/// (2 W/7)^2 dt/2 of its speed per time. `change` of the normal over the step; `velocity` [m/s] of
/// the particle's centre, at a `distance` [m] that follows the normal.
inline Vec3d belt_before(const SurfaceVelocity& belt, const Vec3d& place, const Vec3d& normal,
                         const Vec3d& change, const Vec3d& velocity, double distance,
                         const StepTimes& times) {
  const Vec3d turned = times.lag * change, n = normal - turned;
  const Vec3d moved = times.lag * times.worked * velocity - distance * turned;
  return belt.at(place - moved, n * (1 / norm(n))) - belt.at(place, normal);
}

/// Sets force and torque of the walls and adds to their impulse, from the loads of the threads:
/// each of the `parts` has one load per wall.
inline void sum_wall_loads(std::span<Wall> walls, std::span<const WallLoad> loads,
                           std::size_t parts, double time_step) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    walls[w].force = walls[w].torque = {0, 0, 0};
    walls[w].belt_power = 0;
    for (std::size_t b = 0; b < parts; ++b) {
      walls[w].force += loads[b * walls.size() + w].force;
      walls[w].torque += loads[b * walls.size() + w].torque;
      walls[w].belt_power += loads[b * walls.size() + w].power;
    }
    walls[w].impulse += walls[w].force * time_step;
    walls[w].angular_impulse += walls[w].torque * time_step;
  }
}

}  // namespace silt::detail
