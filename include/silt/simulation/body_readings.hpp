// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What users read of particles that are bodies; a Simulation has these functions as its own.
template <class Sim>
class BodyReadings {
 public:
  /// Turns the frame in which the form was given to space.
  Quaternion orientation(std::size_t k) const requires(Sim::of_bodies) {
    return owner(k).orientation();
  }
  std::size_t form(std::size_t k) const requires(Sim::of_bodies) { return owner(k).form(); }
  /// Size of the particle over that of its form as it was made [-].
  double scale(std::size_t k) const requires(Sim::of_bodies) { return owner(k).scale(); }
  /// All forms, a silt::BodyForm each.
  const auto& forms() const requires(Sim::of_bodies) { return sim().engine_.mover.forms; }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  auto owner(std::size_t k) const { return sim().engine_.owner(sim().known(k)); }
};

}  // namespace silt::detail
