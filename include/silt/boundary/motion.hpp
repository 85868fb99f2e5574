// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <functional>
#include <numbers>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET {

/// Pose of a rigid body: maps body coordinates, in which its surface is given, to space.
struct Pose {
  Quaternion rotation;         // [-] unit
  Vec3d translation{0, 0, 0};  // [m] of the body's origin

  Vec3d to_space(const Vec3d& point) const { return rotate(point) + translation; }
  Vec3d to_body(const Vec3d& point) const { return rotate_back(point - translation); }
  Vec3d rotate(const Vec3d& direction) const { return silt::rotate(rotation, direction); }
  Vec3d rotate_back(const Vec3d& direction) const {
    return silt::rotate(conjugate(rotation), direction);
  }
  friend bool operator==(const Pose&, const Pose&) = default;
};

/// Prescribed motion: the pose at a time [s]. Any function is allowed if it depends on time only. A
/// run restarted from a checkpoint then moves the body exactly as the original run.
using Motion = std::function<Pose(double time)>;

/// Constant velocity [m/s] from the position at time 0.
inline Motion translation(const Vec3d& velocity) {
  require(is_finite(velocity), "translation: velocity = ", velocity, " [m/s] must be finite");
  return [=](double time) { return Pose{{}, velocity * time}; };
}

/// Result of rotation(). The torque of a wall with this motion is taken about `centre`.
struct Rotation {
  Vec3d centre;  // [m]
  Vec3d axis;    // [-] unit
  double rate;   // [rad/s]
  Pose operator()(double time) const {
    const Quaternion turn = rotation_about(axis, rate * time);
    return Pose{turn, centre - rotate(turn, centre)};
  }
};

/// Rotation about the line through `centre` [m] along `axis` (any length) with `rate` [rad/s], by
/// the right-hand rule.
inline Motion rotation(const Vec3d& centre, const Vec3d& axis, double rate) {
  require(is_finite(centre), "rotation: centre = ", centre, " [m] must be finite");
  const double length = norm(axis);
  require(std::isfinite(length) && length > 0, "rotation: axis = ", axis,
          " [-] must be finite and not zero");
  require(std::isfinite(rate), "rotation: rate = ", rate, " [rad/s] must be finite");
  return Rotation{centre, axis * (1 / length), rate};
}

/// Oscillation A sin(2 pi f t + phase) - A sin(phase); the displacement is 0 at time 0. `amplitude`
/// A [m] gives direction and size, `frequency` f is in [Hz], `phase` in [rad].
inline Motion vibration(const Vec3d& amplitude, double frequency, double phase = 0) {
  require(is_finite(amplitude), "vibration: amplitude = ", amplitude, " [m] must be finite");
  require_positive("vibration: frequency", frequency, "Hz");
  require(std::isfinite(phase), "vibration: phase = ", phase, " [rad] must be finite");
  return [=](double time) {
    const double angle = 2 * std::numbers::pi * frequency * time + phase;
    return Pose{{}, amplitude * (std::sin(angle) - std::sin(phase))};
  };
}

/// `first` in a frame that moves with `second`: a point is transformed by `first`, then by
/// `second`.
inline Motion combined(Motion first, Motion second) {
  require(static_cast<bool>(first), "combined: the first motion is empty");
  require(static_cast<bool>(second), "combined: the second motion is empty");
  return [first = std::move(first), second = std::move(second)](double time) {
    const Pose inner = first(time), outer = second(time);
    return Pose{outer.rotation * inner.rotation, outer.to_space(inner.translation)};
  };
}

/// `motion` shifted in time: it begins at `now` [s] as it otherwise does at 0:
///   sim.set_motion("lid", silt::from(sim.time(), silt::translation({0, 0, -0.01})));
inline Motion from(double now, Motion motion) {
  require(std::isfinite(now), "from: now = ", now, " [s] must be finite");
  require(static_cast<bool>(motion), "from: the motion is empty");
  return [now, motion = std::move(motion)](double time) { return motion(time - now); };
}

}  // namespace silt
