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
  Vec3d inertia;           // [kg m2] principal moments; of fixed ones 1
  ParticleId id;           // no_particle: has left
  std::uint32_t form;
  std::uint32_t first = 0;  // place of the row of its first part in `rows`
  Vec3d lever{0, 0, 0};     // [m] BodyForm::lever in its size

  Vec3d angular_velocity(const Vec3d& of) const {  // [rad/s] in space
    return rotate(orientation, {of.x / inertia.x, of.y / inertia.y, of.z / inertia.z});
  }
  /// How fast [m/s] its surface moves along its normal, at most, by the angular velocity w [rad/s]
  /// in principal axes: that of its tips. 0 for a ball, and for a disc that turns about its axis.
  double tip_speed(const Vec3d& w) const {
    return std::abs(w.x) * lever.x + std::abs(w.y) * lever.y + std::abs(w.z) * lever.z;
  }
  /// Of its fastest points [m/s], at the last half step.
  double speed() const {
    return norm(velocity) +
           tip_speed({momentum.x / inertia.x, momentum.y / inertia.y, momentum.z / inertia.z});
  }
};
static_assert(sizeof(Body) % sizeof(double) == 0);

}  // namespace silt::detail
