// silt - BSD-3-Clause, see LICENSE
#pragma once

// Coupled simulations of silt::precompiled (silt/precompiled.hpp); included by silt/fluid.hpp where
// SILT_PRECOMPILED is defined.

#include <silt/fluid.hpp>
#include <silt/precompiled.hpp>

namespace silt::inline SILT_TARGET::detail {
template <class Drag>
using FlowOfCells =
    decltype(CoupledFlow(std::declval<Drag>(), std::declval<Kernel>(), std::declval<FlowSolver>()));
}  // namespace silt::detail

#define SILT_PRECOMPILED_COUPLED(FOR_EACH)                                    \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, \
           silt::detail::FlowOfCells<silt::Gidaspow>)

SILT_PRECOMPILED_COUPLED(SILT_DECLARE_SIMULATION)
