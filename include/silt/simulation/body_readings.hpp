// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Read access to particles that are bodies; these are member functions of Simulation. (Templates,
/// because clang 14 evaluates the constraints of members before Sim is complete.)
template <class Sim>
class BodyReadings {
 public:
  /// Rotation from the frame of its form to the space frame. For spheres with bonds, the reference
  /// is the orientation at creation, or when the first bond of the simulation was made, if that was
  /// later.
  template <class S = Sim>
  Quaternion orientation(std::size_t k) const requires(S::of_bodies || S::has_bonds) {
    return owner(k).orientation();
  }
  template <class S = Sim>
  std::size_t form(std::size_t k) const requires(S::of_bodies) {
    return owner(k).form();
  }
  /// Size of the particle relative to its form as it was defined [-].
  template <class S = Sim>
  double scale(std::size_t k) const requires(S::of_bodies) {
    return owner(k).scale();
  }
  /// All forms (silt::BodyForm): those that were added, then those of fragments of polyhedra, whose
  /// numbers are reused after the fragments have left.
  template <class S = Sim>
  const auto& forms() const requires(S::of_bodies) {
    return sim().engine_.mover.forms;
  }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  auto owner(std::size_t k) const { return sim().engine_.owner(sim().known(k)); }
};

}  // namespace silt::detail
