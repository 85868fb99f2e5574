// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include <silt/simulation.hpp>

#include "near.hpp"

namespace physics_test {

using silt::dot;
using silt::norm;
using silt::Vec3d;

inline constexpr double pi = std::numbers::pi;
inline constexpr double g = 9.81;  // [m/s2]

/// Mass [kg] of a solid sphere.
inline double mass_of(double radius, double density) {
  return density * silt::Sphere::volume(radius);
}

template <class Sim>
Vec3d position_of(const Sim& sim, std::uint32_t id) {
  return sim.position(sim.find(id));
}
template <class Sim>
Vec3d velocity_of(const Sim& sim, std::uint32_t id) {
  return sim.velocity(sim.find(id));
}
template <class Sim>
Vec3d spin_of(const Sim& sim, std::uint32_t id) {
  return sim.angular_velocity(sim.find(id));
}

/// Kinetic energy [J] of all free particles, rotation included where there is one.
template <class Sim>
double kinetic_energy(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k) || !std::isfinite(sim.mass(k))) continue;
    const Vec3d v = sim.velocity(k);
    sum += 0.5 * sim.mass(k) * dot(v, v);
    if constexpr (Sim::rotates) {
      const Vec3d w = sim.angular_velocity(k);
      sum += 0.2 * sim.mass(k) * sim.radius(k) * sim.radius(k) * dot(w, w);
    }
  }
  return sum;
}

}  // namespace physics_test
