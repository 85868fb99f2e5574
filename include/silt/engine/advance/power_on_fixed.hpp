// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/vec3.hpp>
#include <silt/engine/contact/load_rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Chunk c of the load on a row: force, torque, rolling torque.
template <std::size_t chunks, class Scalar>
Vec3d load_part(const Scalar* sums, std::size_t row, std::size_t c) {
  const Scalar* const load = sums + (row * chunks + c) * 4;
  return {double(load[0]), double(load[1]), double(load[2])};
}

/// Power [W] of the contacts on prescribed (fixed) particles that move, from the loads of a step
/// before they are integrated.
template <class ContactsType, class State, class Scalar>
double power_on_fixed(const State& particles, const Scalar* sums) {
  constexpr std::size_t chunks = load_chunks<ContactsType>;
  double power = 0;
  for (std::size_t k = 0; particles.some_fixed && k < particles.owned(); ++k) {
    const auto& m = particles.motion[k];
    if (m.inv_m != 0 || particles.is_parked(k)) continue;
    const auto part = [&](std::size_t c) { return load_part<chunks>(sums, k, c); };
    power += dot(part(0), m.velocity());
    if constexpr (ContactsType::rotates) power += dot(part(1), m.spin_velocity());
    if constexpr (ContactsType::has_rolling) power += m.inv_r * dot(part(2), m.spin_velocity());
  }
  return power;
}

}  // namespace silt::detail
