// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/concept.hpp>

namespace silt::inline SILT_TARGET {

/// No fluid around the particles (default).
/// Source: none.
/// Valid:  every scene.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/coupling/own_coupling.cpp.
struct NoFluid {
  static constexpr bool active = false;
};

static_assert(FluidCoupling<NoFluid>);

}  // namespace silt
