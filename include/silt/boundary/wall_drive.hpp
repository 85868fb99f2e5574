// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include <silt/boundary/motion.hpp>
#include <silt/core/symmetric3.hpp>

/// Walls that move by the loads on them: the `drive` of a wall. A drive starts at the pose of the
/// wall when the wall is added, or when set_drive is called. Directions, axes and points are in
/// space.
///
/// Two drives are controlled (servo). They have no mass; their speed follows the difference between
/// the prescribed load F and the present load,
///   v = w + u, |v| <= max_speed,  w = gain (F - F_now)/(K dt + C),  du/dt = w/T,
///   T = 40 (K dt + C)/(gain K)                                                               (1)
/// K [N/m] is the sum of the normal stiffnesses of all contacts of the wall, C [N s/m] that of
/// their dashpots. For a torque each is multiplied by the square of its distance from the axis.
///
/// A wall with velocity v changes its load in the next step by (K dt + C) v if all of its contacts
/// are loaded along their normals. w therefore changes the load by at most `gain` times the
/// difference, and approaches F without overshoot, as the bed behind the contacts is softer than K.
/// u compensates a bed that moves the wall, for example by shear. Without u the load would stay off
/// by v (K dt + C)/gain. On a bed of the stiffness K/n, w and u are damped by sqrt(10/n) of
/// critical damping. Until the load has first reached 0.9 F, F - F_now counts in du/dt as at most
/// F/10, which keeps the overshoot at landing small. u is constant while v is at its limit, and 0
/// without contacts. C is needed because forces of dashpots appear and vanish at once; without it
/// the wall would oscillate from step to step. A wall without contacts moves with max_speed.
///
/// Three drives are free: they have a mass and are integrated with the particles (Leapfrog).
///
/// Source: (1) with C = 0 has the form of PFC's servo (recalled: the print was not read), with K
///         for the number of contacts times their mean stiffness.
/// Units:  SI. Errors: check() names type, field and value.
/// Tests:  tests/engine/free_walls.cpp.

namespace silt::inline SILT_TARGET {

/// Applies a force along `direction`: the wall translates along it and does not rotate.
struct ServoForce {
  Vec3d direction;   // [-] any length except 0
  double force;      // [N] >= 0 on the particles along `direction`; for a pressure: times the area
  double max_speed;  // [m/s]
  double max_travel = std::numeric_limits<double>::infinity();  // [m] to either side of the start
  double gain = 0.25;                                           // [-] in (0, 1]

  void check() const;
};

/// Applies a torque to the particles: the wall rotates about an axis.
struct ServoTorque {
  Vec3d centre;     // [m] a point of the axis
  Vec3d axis;       // [-] any length except 0
  double torque;    // [N m] on the particles, of either sign, by the right-hand rule
  double max_rate;  // [rad/s]
  double max_turn = std::numeric_limits<double>::infinity();  // [rad] to either side of the start
  double gain = 0.25;  // [-] in (0, 1]; 1 for a flowing bed (docs/walls.md, Servo)

  void check() const;
};

/// Translates along `direction`, free or with a spring and a dashpot; gravity acts along it.
struct Slide {
  Vec3d direction;       // [-] any length except 0
  double mass;           // [kg]
  double speed = 0;      // [m/s] at the start, along `direction`
  double force = 0;      // [N] on the wall, added to contacts and gravity
  double stiffness = 0;  // [N/m] of a spring that is relaxed at the start
  double damping = 0;    // [N s/m]

  void check() const;
};

/// Rotates about a fixed axis, free or with a spring and a dashpot.
struct Hinge {
  Vec3d centre;            // [m] a point of the axis
  Vec3d axis;              // [-] any length except 0
  double inertia;          // [kg m2] about the axis, at least that of the mass at its centre
  double mass = 0;         // [kg] for gravity
  Vec3d centre_of_mass{};  // [m] at the start; needs a mass
  double rate = 0;         // [rad/s] at the start
  double torque = 0;       // [N m] on the wall, added to contacts and gravity
  double stiffness = 0;    // [N m/rad] of a spring that is relaxed at the start
  double damping = 0;      // [N m s/rad]

  void check() const;
};

/// Rigid body with six degrees of freedom. free_body(mesh, density) (silt/shape/mesh_body.hpp)
/// makes one from a closed mesh.
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

/// Position and velocity of a driven wall; for a wall whose Motion was changed, the pose from which
/// it continues. Only numbers: checkpoints store it unchanged.
struct WallState {
  Pose start;                     // when it was released or its motion changed
  double since = 0;               // [s] then
  double changed = 0;             // 1: the motion was changed at `since`
  double way = 0;                 // [m] or [rad] travelled since the start
  double rate = 0, rate_now = 0;  // [1/s] its rate, at the last half step and at the step
  Quaternion axes, turn;          // of a FreeBody: principal axes to surfaces, and to space
  Vec3d principal{1, 1, 1};       // [kg m2]
  Vec3d centre{}, velocity{}, velocity_now{};  // [m], [m/s] half step, step
  Vec3d momentum{}, momentum_now{};            // [kg m2/s] angular, in principal axes
  double stiffness = 0;                        // [N/m] or [N m/rad] K of (1), last value
  double damping = 0;                          // [N s/m] or [N m s/rad] C of (1)
  double load_at_look = 0;                     // [N] or [N m]
  double steps_since_look = 0;
  double drift = 0;       // [m/s] or [rad/s] u of (1)
  double has_landed = 0;  // 1: the load has come near the prescribed one
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

/// Default reference point [m] of a wall's torque: a point of its axis if it has one, else the
/// origin.
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

/// Pose of the mesh in a state.
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

/// State of a wall released from `pose` at `time` [s].
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

/// A servo that gets another load, speed or gain along the same direction, or about the same axis,
/// goes on: returns true, with its state for the new drive. Its end stops are still those about its
/// start; u is kept, as the bed is the same.
inline bool goes_on(const WallDrive& now, const WallDrive& next, WallState& state) {
  const auto same = [](const Vec3d& a, const Vec3d& b) {
    return norm(normalised(a) - normalised(b)) < 1e-12;
  };
  const auto keeps = [&state](double before, double after, double most) {
    if (std::abs(state.way) > most) return false;
    if (!(std::abs(after) <= 1.1 * std::abs(before)) || after * before < 0) state.has_landed = 0;
    return true;
  };
  if (const auto* a = std::get_if<ServoForce>(&now), *b = std::get_if<ServoForce>(&next); a && b)
    return same(a->direction, b->direction) && keeps(a->force, b->force, b->max_travel);
  if (const auto* a = std::get_if<ServoTorque>(&now), *b = std::get_if<ServoTorque>(&next); a && b)
    return same(a->axis, b->axis) && a->centre == b->centre &&
           keeps(a->torque, b->torque, b->max_turn);
  return false;
}

/// 1/mass [1/kg] that resists a force along `normal` at `point` [m]; 0 for walls without a mass.
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

/// 1/mass [1/kg] of a contact with a fixed particle of radius `R` [m], for its dashpots: that of
/// the wall, which alone moves. It is finite where the wall cannot move along the normal (Slide) or
/// at all (at the axis of a Hinge). A servo has no mass: 1/mass is so large that dashpots vanish.
inline double inverse_mass_at_fixed(const WallDrive& drive, const WallState& s, const Vec3d& point,
                                    const Vec3d& normal, double R) {
  if (const auto* d = std::get_if<Slide>(&drive)) return 1 / d->mass;
  if (const auto* d = std::get_if<Hinge>(&drive)) {
    const Vec3d arm = cross(normalised(d->axis), point - d->centre);
    return std::max(dot(arm, arm), 1e-4 * R * R) / d->inertia;
  }
  if (std::holds_alternative<FreeBody>(drive)) return inverse_mass_of(drive, s, point, normal);
  return 1e30;
}

/// Smallest effective mass [kg] of a wall at its contacts, if no point is farther than `size` [m]
/// from its centre or axis; infinite for walls without a mass.
inline double least_mass_of(const WallDrive& drive, const WallState& s, double size) {
  const double size2 = size * size;
  if (const auto* d = std::get_if<Slide>(&drive)) return d->mass;
  if (const auto* d = std::get_if<Hinge>(&drive)) return d->inertia / size2;
  if (const auto* d = std::get_if<FreeBody>(&drive))
    return 1 / (1 / d->mass + size2 / std::min({s.principal.x, s.principal.y, s.principal.z}));
  return std::numeric_limits<double>::infinity();
}

/// 1/20 of half a period of the wall's spring [s]; infinite without a spring.
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
          " [N] must not be negative: reverse `direction` instead");
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
  const Vec3d arm = cross(normalised(axis), centre_of_mass - centre);
  const double least = mass * dot(arm, arm);  // [kg m2] of all the mass at its centre
  require(inertia >= least * (1 - 1e-9), "Hinge.inertia = ", inertia,
          " [kg m2] about the axis must be at least mass times the square of the distance of the "
          "centre of mass from the axis, ",
          least, " kg m2");
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
