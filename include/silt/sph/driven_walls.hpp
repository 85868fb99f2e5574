// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What a liquid does to a driven wall, on average over its last advance(), and how the wall feels
/// it: what a servo's speed follows from beside its contacts (boundary/wall_drive.hpp).
struct LiquidOnWall {
  Vec3d force{0, 0, 0};   // [N]
  Vec3d torque{0, 0, 0};  // [N m] about the drive's centre (centre_of_drive)
  /// The liquid beside a wall that begins to move with v presses by rho c v at once, per area, and
  /// the more by rho c^2/h for each second.
  double stiffness = 0, damping = 0;  // [N/m], [N s/m]; of a torque times arms squared
  /// The same rho c times area along and about the axes of space [N s/m], [N m s].
  Vec3d along{0, 0, 0}, around{0, 0, 0};

  void add(double part, const LiquidOnWall& l) {
    force += part * l.force, torque += part * l.torque;
    stiffness += part * l.stiffness, damping += part * l.damping;
    along += part * l.along, around += part * l.around;
  }
  static constexpr std::size_t numbers = 14;
};
static_assert(sizeof(LiquidOnWall) == LiquidOnWall::numbers * sizeof(double));

/// [m] The point of a driven wall, where it is now, that torques are about and that it turns about.
inline Vec3d centre_of_drive(const Wall& wall) {
  if (const auto* d = std::get_if<ServoTorque>(&wall.drive)) return d->centre;
  if (const auto* d = std::get_if<Hinge>(&wall.drive)) return d->centre;
  if (std::holds_alternative<FreeBody>(wall.drive)) return wall.state.centre;
  return {0, 0, 0};
}
/// [rad/s] of the last half step.
inline Vec3d spin_of_drive(const Wall& wall) {
  const WallState& s = wall.state;
  if (const auto* d = std::get_if<ServoTorque>(&wall.drive)) return s.rate * normalised(d->axis);
  if (const auto* d = std::get_if<Hinge>(&wall.drive)) return s.rate * normalised(d->axis);
  if (std::holds_alternative<FreeBody>(wall.drive)) {
    const Vec3d &l = s.momentum, &I = s.principal;
    return rotate(s.turn, {l.x / I.x, l.y / I.y, l.z / I.z});
  }
  return {0, 0, 0};
}

/// [s] How long a wall with a mass may be held at one velocity while the liquid goes on: a fifth of
/// m/(rho c A). Above twice that it begins to swing (computed, tests/sph/driven_walls.cpp).
inline double longest_hold(const Wall& wall, const LiquidOnWall& load) {
  double rate = 0;  // [1/s]
  if (const auto* d = std::get_if<Slide>(&wall.drive)) rate = load.damping / d->mass;
  if (const auto* d = std::get_if<Hinge>(&wall.drive)) rate = load.damping / d->inertia;
  if (const auto* d = std::get_if<FreeBody>(&wall.drive)) {
    const WallState& s = wall.state;
    const Vec3d &l = load.along, &t = load.around;
    rate = std::max({l.x, l.y, l.z}) / d->mass;
    const auto turning = [&](const Vec3d& axis, double damping) {
      const Vec3d a = rotate(conjugate(s.turn), axis);
      rate = std::max(rate, damping * (a.x * a.x / s.principal.x + a.y * a.y / s.principal.y +
                                       a.z * a.z / s.principal.z));
    };
    turning({1, 0, 0}, t.x), turning({0, 1, 0}, t.y), turning({0, 0, 1}, t.z);
  }
  return rate > 0 ? 0.2 / rate : std::numeric_limits<double>::infinity();
}
/// [-] How a drive's speed moves a point `arm` [m] from its centre along `normal`.
inline double way_of_drive(const WallDrive& drive, const Vec3d& arm, const Vec3d& normal) {
  const auto turns = [&](const Vec3d& axis) { return dot(normalised(axis), cross(arm, normal)); };
  if (const auto* d = std::get_if<ServoForce>(&drive)) return dot(normalised(d->direction), normal);
  if (const auto* d = std::get_if<Slide>(&drive)) return dot(normalised(d->direction), normal);
  if (const auto* d = std::get_if<ServoTorque>(&drive)) return turns(d->axis);
  if (const auto* d = std::get_if<Hinge>(&drive)) return turns(d->axis);
  return 0;
}

/// How a driven wall goes on while the liquid takes its steps: with the velocity of its last half
/// step, as bodies do.
struct DrivenMotion {
  Pose from{};
  Vec3d centre{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};  // [m], [m/s], [rad/s]
  double since = 0;                                         // [s]

  static DrivenMotion of(const Wall& wall, double time) {
    const Vec3d centre = centre_of_drive(wall);
    return {wall.pose, centre, wall.driven_velocity(centre), spin_of_drive(wall), time};
  }
  Vec3d centre_at(double time) const { return centre + (time - since) * velocity; }
  Pose at(double time) const {
    const double rate = norm(spin);
    const Quaternion turn =
        rate > 0 ? rotation_about((1 / rate) * spin, rate * (time - since)) : Quaternion{};
    return {turn * from.rotation, centre_at(time) + rotate(turn, from.translation - centre)};
  }
};

}  // namespace silt::detail
