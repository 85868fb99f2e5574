// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A particle: a sphere, which owns one row, or a body, which owns the rows of its parts. Both have
/// the same interface, so that users of particles need not distinguish them. Velocities are those
/// that the integrator stores (Leapfrog: of the last half step).
template <class Composition, class State, class Mover>
class Owner {
  static constexpr bool of_bodies = Composition::of_bodies;

 public:
  Owner(const State& state, const Mover& mover, std::size_t k)
      : state_(state), mover_(mover), k_(k) {}

  static std::size_t count(const State& state, const Mover& mover) {
    if constexpr (of_bodies)
      return mover.owned();
    else
      return state.owned();
  }

  ParticleId id() const {
    if constexpr (of_bodies)
      return mover_.bodies[k_].id;
    else
      return state_.id[k_];
  }
  bool is_there() const { return id() != no_particle; }
  Vec3d centre() const {  // [m]
    if constexpr (of_bodies)
      return mover_.bodies[k_].centre;
    else
      return state_.position[k_].centre();
  }
  double radius() const {  // [m] for bodies, of the bounding sphere
    if constexpr (of_bodies)
      return mover_.bodies[k_].radius;
    else
      return state_.position[k_].r;
  }
  double inverse_mass() const {  // [1/kg]; 0: fixed
    if constexpr (of_bodies)
      return mover_.bodies[k_].inv_m;
    else
      return state_.motion[k_].inv_m;
  }
  double mass() const {  // [kg] infinite if fixed
    const double inv_m = inverse_mass();
    return inv_m > 0 ? 1 / inv_m : INFINITY;
  }
  Vec3d velocity() const {  // [m/s]
    if constexpr (of_bodies)
      return mover_.bodies[k_].velocity;
    else
      return state_.motion[k_].velocity();
  }
  Vec3d angular_velocity() const {  // [rad/s]; 0 for spheres that do not rotate
    if constexpr (of_bodies) {
      const auto& b = mover_.bodies[k_];
      return b.angular_velocity(b.momentum);
    } else if constexpr (Composition::rotates) {
      const auto& m = state_.motion[k_];
      return m.spin_velocity() * m.inv_r;
    } else {
      return {0, 0, 0};
    }
  }
  // The same at the whole step, as an observer sees it.
  Vec3d velocity_now() const { return mover_.synchronous[k_].velocity; }
  Vec3d angular_velocity_now() const {
    if constexpr (of_bodies)
      return mover_.synchronous[k_].angular_velocity;
    else if constexpr (Composition::rotates)
      return mover_.synchronous[k_].spin_velocity * state_.motion[k_].inv_r;
    else
      return {0, 0, 0};
  }
  double rotational_energy(const Vec3d& w) const {  // [J] at the angular velocity w [rad/s]
    if constexpr (of_bodies) {
      const auto& b = mover_.bodies[k_];
      const Vec3d v = rotate(conjugate(b.orientation), w);
      return 0.5 * (b.inertia.x * v.x * v.x + b.inertia.y * v.y * v.y + b.inertia.z * v.z * v.z);
    } else {
      return 0.5 * Composition::Shape::inertia_factor() * mass() * radius() * radius() * dot(w, w);
    }
  }
  /// Speed of its tips [m/s] due to the angular velocity w [rad/s]; 0 for spheres.
  double tip_speed([[maybe_unused]] const Vec3d& w) const {
    if constexpr (of_bodies)
      return mover_.bodies[k_].tip_speed(rotate(conjugate(mover_.bodies[k_].orientation), w));
    else
      return 0;
  }
  Quaternion principal_axes() const {  // rotation to the space frame
    if constexpr (of_bodies)
      return mover_.bodies[k_].orientation;
    else
      return {};
  }
  std::uint32_t form() const {
    if constexpr (of_bodies)
      return mover_.bodies[k_].form;
    else
      return 0;
  }
  double scale() const {  // [-] of its form
    if constexpr (of_bodies)
      return mover_.bodies[k_].scale;
    else
      return 1;
  }
  Quaternion orientation() const {  // rotation from the frame of its form to the space frame
    if constexpr (of_bodies) {
      const auto& b = mover_.bodies[k_];
      return b.orientation * conjugate(mover_.forms[b.form].mass.axes);
    } else if constexpr (Composition::has_bonds) {
      return state_.orientation[k_];
    } else {
      return {};
    }
  }
  /// The row of a sphere, or of the first part of a body.
  std::size_t first_row() const {
    if constexpr (of_bodies)
      return mover_.rows[mover_.bodies[k_].first];
    else
      return k_;
  }
  std::size_t material() const {
    if constexpr (Composition::several_materials)
      return state_.material[first_row()];
    else
      return 0;
  }
  double volume() const {  // [m3]
    if constexpr (of_bodies) {
      const auto& b = mover_.bodies[k_];
      return mover_.forms[b.form].mass.volume * b.scale * b.scale * b.scale;
    } else {
      return Composition::Shape::volume(radius());
    }
  }

 private:
  const State& state_;
  const Mover& mover_;
  std::size_t k_;
};

}  // namespace silt::detail
