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

/// Load of the liquid on a driven wall, averaged over its last advance(), and its stiffness and
/// damping, which a servo needs in addition to those of its contacts (boundary/wall_drive.hpp).
struct LiquidOnWall {
  Vec3d force{0, 0, 0};   // [N]
  Vec3d torque{0, 0, 0};  // [N m] about the drive's centre (centre_of_drive)
  /// When a wall starts to move with v, the pressure of the liquid beside it changes at once by rho
  /// c v, and then by rho c^2/h v per second.
  double stiffness = 0, damping = 0;  // [N/m], [N s/m]; for a torque times arms squared
  /// rho c times area along and about the axes of space [N s/m], [N m s].
  Vec3d along{0, 0, 0}, around{0, 0, 0};

  void add(double part, const LiquidOnWall& l) {
    force += part * l.force, torque += part * l.torque;
    stiffness += part * l.stiffness, damping += part * l.damping;
    along += part * l.along, around += part * l.around;
  }
  static constexpr std::size_t numbers = 14;
};
static_assert(sizeof(LiquidOnWall) == LiquidOnWall::numbers * sizeof(double));

/// [m] Present position of the reference point and axis of a driven wall.
inline Vec3d centre_of_drive(const Wall& wall) {
  if (const auto* d = std::get_if<ServoTorque>(&wall.drive)) return d->centre;
  if (const auto* d = std::get_if<Hinge>(&wall.drive)) return d->centre;
  if (std::holds_alternative<FreeBody>(wall.drive)) return wall.state.centre;
  return {0, 0, 0};
}
/// [rad/s] at the last half step.
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

/// [s] Longest time for which the velocity of a wall with a mass may be constant while the liquid
/// advances: a fifth of m/(rho c A). Above twice this value it begins to oscillate (computed,
/// tests/sph/driven_walls.cpp).
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
/// [-] Velocity along `normal` of a point at `arm` [m] from the drive's centre, over the drive's
/// speed.
inline double way_of_drive(const WallDrive& drive, const Vec3d& arm, const Vec3d& normal) {
  const auto turns = [&](const Vec3d& axis) { return dot(normalised(axis), cross(arm, normal)); };
  if (const auto* d = std::get_if<ServoForce>(&drive)) return dot(normalised(d->direction), normal);
  if (const auto* d = std::get_if<Slide>(&drive)) return dot(normalised(d->direction), normal);
  if (const auto* d = std::get_if<ServoTorque>(&drive)) return turns(d->axis);
  if (const auto* d = std::get_if<Hinge>(&drive)) return turns(d->axis);
  return 0;
}

/// Motion of a driven wall during the steps of the liquid: with the velocity of its last half step,
/// as bodies.
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
