// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/surface_point.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/contact/kinematics.hpp>
#include <silt/engine/contact/step_times.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Adds the spin of a belt, and what its velocity at the contact was less than now half a step ago.
inline void add_belt(WallVelocity& of_wall, const SurfaceVelocity& belt, const Vec3d& on_wall,
                     const SurfacePoint& point, const Vec3d& change, const Vec3d& of_sphere,
                     const StepTimes& times) {
  of_wall.velocity +=
      belt_before(belt, on_wall, point.normal, change, of_sphere, point.distance, times);
  of_wall.spin += belt.rate;
}

template <class Scalar>
SILT_INLINE Vec3<Scalar> as_scalars(const Vec3d& v) {
  return {static_cast<Scalar>(v.x), static_cast<Scalar>(v.y), static_cast<Scalar>(v.z)};
}

/// Kinematics of a sphere's contact with a wall; `inverse_mass` [1/kg]: of sphere plus wall.
template <class Scalar, bool Rotates>
SILT_INLINE Kinematics<Scalar> kinematics_at_wall(const SurfacePoint& point, const Vec3d& change,
                                                  const PositionRow& sphere,
                                                  const MotionRow<Rotates>& motion,
                                                  const WallVelocity& of_wall,
                                                  double inverse_mass) {
  const auto scalar = [](double x) { return static_cast<Scalar>(x); };
  Kinematics<Scalar> kin;
  kin.normal = as_scalars<Scalar>(point.normal), kin.change = as_scalars<Scalar>(change);
  kin.velocity = as_scalars<Scalar>(motion.velocity() - of_wall.velocity);
  kin.overlap = scalar(sphere.r - point.distance);
  kin.R_eff = scalar(sphere.r);
  kin.m_eff = scalar(1 / inverse_mass), kin.inverse_m_eff = scalar(inverse_mass);
  if constexpr (Rotates) {
    kin.spin = as_scalars<Scalar>(motion.spin_velocity());
    kin.arm = scalar(point.distance * motion.inv_r);
    kin.twist = scalar(dot(of_wall.spin, point.normal));
  }
  return kin;
}

/// Velocity [m/s] and angular velocity [rad/s] of a sphere at a wall, relative to its surface.
struct RelativeToWall {
  Vec3d velocity, turning{0, 0, 0};
};
template <bool Rotates>
RelativeToWall relative_to_wall(const MotionRow<Rotates>& m, const Wall& wall, const Vec3d& on_wall,
                                const Vec3d& normal, double step) {
  RelativeToWall r{m.velocity() - velocity_at_contact(wall, on_wall, normal, step)};
  if constexpr (Rotates)
    r.velocity -= cross(m.spin_velocity(), normal),
        r.turning = m.inv_r * m.spin_velocity() - spin_of_surface(wall, step);
  return r;
}

/// Input of rolling models; `inertia` [-] over m r^2, `inverse_mass` [1/kg] of the sphere or, if it
/// is fixed, of the contact.
template <class Scalar, class Motion>
SILT_INLINE RollingKinematics<Scalar> rolling_at_wall(const PositionRow& sphere,
                                                      const Motion& motion,
                                                      const WallVelocity& of_wall, double inertia,
                                                      double inverse_mass) {
  return {as_scalars<Scalar>(motion.spin_velocity() * motion.inv_r - of_wall.spin),
          static_cast<Scalar>(inertia * sphere.r * sphere.r / inverse_mass)};
}

}  // namespace silt::detail
