// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What users read of particles that are bodies; a Simulation has these functions as its own.
/// (Templates, as clang 14 looks at what a member requires before Sim is complete.)
template <class Sim>
class BodyReadings {
 public:
  /// Turns the frame in which the form was given to space; of spheres with bonds that which they
  /// had when they came, or when the first bond of the simulation was made, if that was later.
  template <class S = Sim>
  Quaternion orientation(std::size_t k) const requires(S::of_bodies || S::has_bonds) {
    return owner(k).orientation();
  }
  template <class S = Sim>
  std::size_t form(std::size_t k) const requires(S::of_bodies) {
    return owner(k).form();
  }
  /// Size of the particle over that of its form as it was made [-].
  template <class S = Sim>
  double scale(std::size_t k) const requires(S::of_bodies) {
    return owner(k).scale();
  }
  /// All forms, a silt::BodyForm each: those that were added, then those of fragments of polyhedra,
  /// whose numbers are given again as fragments go.
  template <class S = Sim>
  const auto& forms() const requires(S::of_bodies) {
    return sim().engine_.mover.forms;
  }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  auto owner(std::size_t k) const { return sim().engine_.owner(sim().known(k)); }
};

}  // namespace silt::detail
