// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>

#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A rigid body.
struct alignas(32) Body {
  Vec3d centre;            // [m]
  double inv_m;            // [1/kg]; 0: fixed
  Vec3d velocity;          // [m/s] at the last half step
  double radius;           // [m] of the bounding sphere
  Quaternion orientation;  // principal axes to space
  Vec3d momentum;          // [kg m2/s] angular, in principal axes, at the last half step
  double scale;            // [-] of its form
  Vec3d inertia;           // [kg m2] principal moments; 1 for fixed bodies
  ParticleId id;           // no_particle: has left
  std::uint32_t form;
  std::uint32_t first = 0;  // index in `rows` of the row of its first part
  Vec3d lever{0, 0, 0};     // [m] BodyForm::lever times scale

  Vec3d angular_velocity(const Vec3d& of) const {  // [rad/s] in the space frame
    return rotate(orientation, {of.x / inertia.x, of.y / inertia.y, of.z / inertia.z});
  }
  /// Upper bound [m/s] of the normal velocity of its surface due to rotation with the angular
  /// velocity w [rad/s] in principal axes: the speed of its tips. 0 for a ball, and for a disc
  /// rotating about its axis.
  double tip_speed(const Vec3d& w) const {
    return std::abs(w.x) * lever.x + std::abs(w.y) * lever.y + std::abs(w.z) * lever.z;
  }
  /// Speed of its fastest points [m/s], at the last half step.
  double speed() const {
    return norm(velocity) +
           tip_speed({momentum.x / inertia.x, momentum.y / inertia.y, momentum.z / inertia.z});
  }
};
static_assert(sizeof(Body) % sizeof(double) == 0);

}  // namespace silt::detail
