// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// A particle that was in the fluid in its last step and is there no more, or a part of it.
struct LeftParticle {
  Vec3d position;               // [m] of the centre of mass in that step
  double radius;                // [m] of the sphere, or of the sphere of equal volume
  double volume;                // [m3]
  Quaternion orientation = {};  // of bodies: principal axes to space
  std::uint32_t form = 0;       // of bodies: index in the forms of the next step
};

namespace detail {

/// A volume [m3] of the owner of a place, `ago` [s] before it leaves the fluid.
template <bool Bodies, class Owner>
LeftParticle left_particle(const Owner& owner, const Vec3d& position, double volume, double ago) {
  LeftParticle left{position - ago * owner.velocity(), 0, volume};
  if constexpr (Bodies) {
    left.radius = std::cbrt(owner.volume() * (0.75 / std::numbers::pi));
    left.orientation = owner.principal_axes(), left.form = owner.form();
  } else {
    left.radius = owner.radius();
  }
  return left;
}

}  // namespace detail
}  // namespace silt
