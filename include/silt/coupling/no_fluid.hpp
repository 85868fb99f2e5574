// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// The coupling of particles with a fluid: NoFluid, or CoupledFlow (coupling/coupled_flow.hpp).
/// Needs `static constexpr bool active`; if it is false, the fluid stage of the time loop compiles
/// to nothing. If it is true, `turns` says whether there are torques, and a simulation asks, every
/// few steps, for the loads of CoupledFlow::advance().
template <class F>
concept FluidCoupling = requires {
  { F::active } -> std::convertible_to<bool>;
};

/// No fluid around the particles (default).
struct NoFluid {
  static constexpr bool active = false;
};

static_assert(FluidCoupling<NoFluid>);

}  // namespace silt
