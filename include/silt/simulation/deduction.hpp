// silt - BSD-3-Clause, see LICENSE
#pragma once

// Which Simulation a list of policies makes.

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

// The kernels' instruction set is always part of the type, so that translation units with different
// flags do not share a name for different code.
template <class... Args>
requires(detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> > 0) Simulation(Args&&...)
->Simulation<std::remove_cvref_t<Args>...>;
template <class... Args>
requires(detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> == 0) Simulation(Args&&...)
->Simulation<std::remove_cvref_t<Args>..., KernelsFor<DefaultArch>>;

}  // namespace silt
