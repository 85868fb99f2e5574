// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Read access to the fluid; member functions of Simulation.
template <class Sim>
class FluidAccess {
 public:
  /// The fluid with its counters.
  template <class S = Sim>
  auto& fluid() requires(S::Fluid::active) {
    return sim().fluid_;
  }
  template <class S = Sim>
  const auto& fluid() const requires(S::Fluid::active) {
    return sim().fluid_;
  }
  /// The force of the fluid on particle k at present [N].
  template <class S = Sim>
  Vec3d fluid_force(std::size_t k) const requires(S::Fluid::active) {
    return sim().engine_.fluid_loads().force[sim().known(k)].vector();
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
