// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include <silt/boundary/motion.hpp>
#include <silt/core/symmetric3.hpp>

/// Walls that move by what acts on them: the `drive` of a wall. Each is given where the wall is
/// when it is added, or when set_drive gives it the drive; directions, axes and points in space.
///
/// Two are controlled (servo): without mass, their speed follows the difference between the wanted
/// load and the present one,
///   v = w + u, |v| <= max_speed,  w = gain (F - F_now)/(K dt + C),  du/dt = w/T,
///   T = 40 (K dt + C)/(gain K)                                                               (1)
/// K [N/m] is the sum of the stiffnesses of all contacts of the wall along their normals, C [N s/m]
/// of their dashpots; of a torque each times the square of its distance from the axis. A wall that
/// begins to move with v changes its load in the next step by (K dt + C) v, if all of its contacts
/// are pressed along their normals, which is at most `gain` of the difference: w approaches the
/// wanted load without overshoot; the bed behind is softer than K. u follows a bed that moves the
/// wall, as one that shears does: w alone would stay off its load by v (K dt + C)/gain. On a bed of
/// the stiffness K/n, w and u are damped by sqrt(10/n) of the critical damping. Until the load has
/// come to 0.9 F once, F - F_now counts as a tenth of F at most in du/dt, so that a wall that lands
/// hardly overshoots; u rests while v is at its limit, and is 0 where nothing is touched. (Without
/// C, dashpots, whose force comes and goes at once, would make the wall swing from step to step.) A
/// wall that touches nothing moves with max_speed. Three are free: they have a mass, and are
/// integrated with the particles (Leapfrog). Source: (1) with C = 0 has the form of PFC's servo
/// (recalled, the print was not read), with the
///         number of contacts times their mean stiffness for K.
/// Units:  SI. Errors: check() names type, field and value.
/// Tests:  tests/engine/free_walls.cpp.

namespace silt::inline SILT_TARGET {

/// Presses along `direction` with a force: the wall moves along it, and does not turn.
struct ServoForce {
  Vec3d direction;   // [-] of any length but 0
  double force;      // [N] >= 0 on the particles along `direction`; of a pressure: times the area
  double max_speed;  // [m/s]
  double max_travel = std::numeric_limits<double>::infinity();  // [m] to either side of the start
  double gain = 0.25;                                           // [-] in (0, 1]

  void check() const;
};

/// Turns about an axis with a torque on the particles.
struct ServoTorque {
  Vec3d centre;     // [m] a point of the axis
  Vec3d axis;       // [-] of any length but 0
  double torque;    // [N m] on the particles, of either sign, by the right-hand rule
  double max_rate;  // [rad/s]
  double max_turn = std::numeric_limits<double>::infinity();  // [rad] to either side of the start
  double gain = 0.25;  // [-] in (0, 1]; 1 in a bed that flows (docs/walls.md, Servo)

  void check() const;
};

/// Slides along `direction`, free or between a spring and a dashpot; gravity acts along it.
struct Slide {
  Vec3d direction;       // [-] of any length but 0
  double mass;           // [kg]
  double speed = 0;      // [m/s] at the start, along `direction`
  double force = 0;      // [N] that acts on the wall beside contacts and gravity
  double stiffness = 0;  // [N/m] of a spring that is relaxed at the start
  double damping = 0;    // [N s/m]

  void check() const;
};

/// Turns about a fixed axis, free or with a spring and a dashpot.
struct Hinge {
  Vec3d centre;            // [m] a point of the axis
  Vec3d axis;              // [-] of any length but 0
  double inertia;          // [kg m2] about the axis
  double mass = 0;         // [kg] for gravity
  Vec3d centre_of_mass{};  // [m] at the start; only with a mass
  double rate = 0;         // [rad/s] at the start
  double torque = 0;       // [N m] that acts on the wall beside contacts and gravity
  double stiffness = 0;    // [N m/rad] of a spring that is relaxed at the start
  double damping = 0;      // [N m s/rad]

  void check() const;
};

/// A rigid body with six degrees of freedom. free_body(mesh, density) (silt/shape/mesh_body.hpp)
/// makes one of a closed mesh.
struct FreeBody {
  double mass;                      // [kg]
  Symmetric3 inertia;               // [kg m2] about `centre`, in the axes of the surfaces
  Vec3d centre;                     // [m] of mass, in the coordinates of the surfaces
  Vec3d velocity{0, 0, 0};          // [m/s] of the centre, at the start
  Vec3d angular_velocity{0, 0, 0};  // [rad/s] in space, at the start

  void check() const;
};

/// What moves a wall, if it is not a Motion; monostate: nothing.
using WallDrive = std::variant<std::monostate, ServoForce, ServoTorque, Slide, Hinge, FreeBody>;

/// Where a driven wall is and how it moves; of a wall with a Motion that was changed on the way,
/// from where it goes on. Numbers alone: checkpoints write it as it is.
struct WallState {
  Pose start;                     // when it was released, or its motion was changed
  double since = 0;               // [s] then
  double changed = 0;             // 1: the motion was changed at `since`
  double way = 0;                 // [m] or [rad] since the start
  double rate = 0, rate_now = 0;  // [1/s] of it, at the last half step and at the step
  Quaternion axes, turn;          // of a FreeBody: principal axes to surfaces, and to space
  Vec3d principal{1, 1, 1};       // [kg m2]
  Vec3d centre{}, velocity{}, velocity_now{};  // [m], [m/s] half step, step
  Vec3d momentum{}, momentum_now{};            // [kg m2/s] angular, in principal axes
  double stiffness = 0;                        // [N/m] or [N m/rad] K of (1) at the last look
  double damping = 0;                          // [N s/m] or [N m s/rad] C of (1)
  double load_at_look = 0;                     // [N] or [N m]
  double steps_since_look = 0;
  double drift = 0;       // [m/s] or [rad/s] u of (1)
  double has_landed = 0;  // 1: the load has come near to the wanted one
};
static_assert(sizeof(WallState) % sizeof(double) == 0);

namespace detail {

inline void require_direction(const char* name, const Vec3d& v) {
  const double length = norm(v);
  require(std::isfinite(length) && length > 0, name, " = ", v, " [-] must be finite and not zero");
}
inline void require_number(const char* name, double x, const char* unit) {
  require(std::isfinite(x), name, " = ", x, " [", unit, "] must be finite");
}
inline void require_some(const char* name, double x, const char* unit) {  // infinite: no limit
  require(x > 0, name, " = ", x, " [", unit, "] must be greater than 0");
}
inline void require_gain(const char* name, double gain) {
  require(gain > 0 && gain <= 1, name, " = ", gain, " [-] must be in (0, 1]");
}

/// The point [m] that a wall's torque is about unless another is set: one of its axis, if it has
/// one, else the origin.
inline Vec3d turns_about(const Motion& motion, const WallDrive& drive) {
  if (const auto* const turning = motion.target<Rotation>()) return turning->centre;
  if (const auto* const servo = std::get_if<ServoTorque>(&drive)) return servo->centre;
  if (const auto* const hinge = std::get_if<Hinge>(&drive)) return hinge->centre;
  return {0, 0, 0};
}
inline bool is_servo(const WallDrive& drive) {
  return std::holds_alternative<ServoForce>(drive) || std::holds_alternative<ServoTorque>(drive);
}
inline bool is_free(const WallDrive& drive) { return drive.index() != 0 && !is_servo(drive); }

/// Where the mesh's frame is, of a state.
inline Pose pose_of(const WallDrive& drive, const WallState& s) {
  const auto slid = [&](const Vec3d& direction) {
    return Pose{s.start.rotation, s.start.translation + s.way * normalised(direction)};
  };
  const auto turned = [&](const Vec3d& centre, const Vec3d& axis) {
    const Quaternion turn = rotation_about(normalised(axis), s.way);
    return Pose{turn * s.start.rotation, centre + rotate(turn, s.start.translation - centre)};
  };
  if (const auto* d = std::get_if<ServoForce>(&drive)) return slid(d->direction);
  if (const auto* d = std::get_if<Slide>(&drive)) return slid(d->direction);
  if (const auto* d = std::get_if<ServoTorque>(&drive)) return turned(d->centre, d->axis);
  if (const auto* d = std::get_if<Hinge>(&drive)) return turned(d->centre, d->axis);
  if (const auto* d = std::get_if<FreeBody>(&drive)) {
    const Quaternion q = s.turn * conjugate(s.axes);
    return {q, s.centre - rotate(q, d->centre)};
  }
  return s.start;
}

/// The state of a wall that is released from `pose` at `time` [s].
inline WallState released(const WallDrive& drive, const Pose& pose, double time) {
  WallState s;
  s.start = pose, s.since = time;
  if (const auto* d = std::get_if<Slide>(&drive)) s.rate = s.rate_now = d->speed;
  if (const auto* d = std::get_if<Hinge>(&drive)) s.rate = s.rate_now = d->rate;
  if (const auto* d = std::get_if<FreeBody>(&drive)) {
    const Principal p = silt::principal(d->inertia);
    s.axes = p.axes, s.principal = p.values;
    s.turn = pose.rotation * p.axes;
    s.centre = pose.to_space(d->centre);
    s.velocity = s.velocity_now = d->velocity;
    const Vec3d w = rotate(conjugate(s.turn), d->angular_velocity);
    s.momentum = s.momentum_now = {p.values.x * w.x, p.values.y * w.y, p.values.z * w.z};
  }
  return s;
}

/// 1/mass [1/kg] that a push along `normal` at `point` [m] meets; 0 of walls without a mass.
inline double inverse_mass_of(const WallDrive& drive, const WallState& s, const Vec3d& point,
                              const Vec3d& normal) {
  if (const auto* d = std::get_if<Slide>(&drive)) {
    const double along = dot(normalised(d->direction), normal);
    return along * along / d->mass;
  }
  if (const auto* d = std::get_if<Hinge>(&drive)) {
    const double arm = dot(normalised(d->axis), cross(point - d->centre, normal));
    return arm * arm / d->inertia;
  }
  if (const auto* d = std::get_if<FreeBody>(&drive)) {
    const Vec3d t = rotate(conjugate(s.turn), cross(point - s.centre, normal));
    return 1 / d->mass + t.x * t.x / s.principal.x + t.y * t.y / s.principal.y +
           t.z * t.z / s.principal.z;
  }
  return 0;
}

/// The least mass [kg] that contacts of a wall meet, none of whose points is farther than `size`
/// [m] from its centre or axis; infinite of walls without a mass.
inline double least_mass_of(const WallDrive& drive, const WallState& s, double size) {
  const double size2 = size * size;
  if (const auto* d = std::get_if<Slide>(&drive)) return d->mass;
  if (const auto* d = std::get_if<Hinge>(&drive)) return d->inertia / size2;
  if (const auto* d = std::get_if<FreeBody>(&drive))
    return 1 / (1 / d->mass + size2 / std::min({s.principal.x, s.principal.y, s.principal.z}));
  return std::numeric_limits<double>::infinity();
}

/// In which a spring of the wall makes a 20th of half a swing [s]; infinite without one.
inline double spring_step(const WallDrive& drive) {
  const auto of = [](double stiffness, double inertia) {
    return stiffness > 0 ? std::numbers::pi / 20 * std::sqrt(inertia / stiffness)
                         : std::numeric_limits<double>::infinity();
  };
  if (const auto* d = std::get_if<Slide>(&drive)) return of(d->stiffness, d->mass);
  if (const auto* d = std::get_if<Hinge>(&drive)) return of(d->stiffness, d->inertia);
  return std::numeric_limits<double>::infinity();
}

inline void check_drive(const WallDrive& drive) {
  std::visit(
      [](const auto& d) {
        if constexpr (requires { d.check(); }) d.check();
      },
      drive);
}

}  // namespace detail

inline void ServoForce::check() const {
  detail::require_direction("ServoForce.direction", direction);
  detail::require_number("ServoForce.force", force, "N");
  require(force >= 0, "ServoForce.force = ", force,
          " [N] must not be negative: `direction` gives the sense, turn it");
  require_positive("ServoForce.max_speed", max_speed, "m/s");
  detail::require_some("ServoForce.max_travel", max_travel, "m");
  detail::require_gain("ServoForce.gain", gain);
}
inline void ServoTorque::check() const {
  require(is_finite(centre), "ServoTorque.centre = ", centre, " [m] must be finite");
  detail::require_direction("ServoTorque.axis", axis);
  detail::require_number("ServoTorque.torque", torque, "N m");
  require_positive("ServoTorque.max_rate", max_rate, "rad/s");
  detail::require_some("ServoTorque.max_turn", max_turn, "rad");
  detail::require_gain("ServoTorque.gain", gain);
}
inline void Slide::check() const {
  detail::require_direction("Slide.direction", direction);
  require_positive("Slide.mass", mass, "kg");
  detail::require_number("Slide.speed", speed, "m/s");
  detail::require_number("Slide.force", force, "N");
  require_not_negative("Slide.stiffness", stiffness, "N/m");
  require_not_negative("Slide.damping", damping, "N s/m");
}
inline void Hinge::check() const {
  require(is_finite(centre), "Hinge.centre = ", centre, " [m] must be finite");
  detail::require_direction("Hinge.axis", axis);
  require_positive("Hinge.inertia", inertia, "kg m2");
  require_not_negative("Hinge.mass", mass, "kg");
  require(is_finite(centre_of_mass), "Hinge.centre_of_mass = ", centre_of_mass,
          " [m] must be finite");
  detail::require_number("Hinge.rate", rate, "rad/s");
  detail::require_number("Hinge.torque", torque, "N m");
  require_not_negative("Hinge.stiffness", stiffness, "N m/rad");
  require_not_negative("Hinge.damping", damping, "N m s/rad");
}
inline void FreeBody::check() const {
  require_positive("FreeBody.mass", mass, "kg");
  const auto& I = inertia;
  require(std::isfinite(I.xx + I.yy + I.zz + I.xy + I.yz + I.zx),
          "FreeBody.inertia [kg m2] must be finite");
  const Vec3d p = principal(I).values;
  const double least = std::min({p.x, p.y, p.z}), sum = p.x + p.y + p.z;
  require(least > 0 && std::max({p.x, p.y, p.z}) <= 0.5 * sum * (1 + 1e-9),
          "FreeBody.inertia has the principal moments ", p,
          " [kg m2]; each must be greater than 0 and no greater than the sum of the others");
  require(is_finite(centre), "FreeBody.centre = ", centre, " [m] must be finite");
  require(is_finite(velocity), "FreeBody.velocity = ", velocity, " [m/s] must be finite");
  require(is_finite(angular_velocity), "FreeBody.angular_velocity = ", angular_velocity,
          " [rad/s] must be finite");
}

}  // namespace silt
