// silt - BSD-3-Clause, see LICENSE
// refused: give each force once
#include <silt/fluid.hpp>

#if defined(SILT_MENDED)
using Fluid = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::VirtualMass>;
#else
using Fluid = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::VirtualMass, silt::VirtualMass>;
#endif
static_assert(Fluid::has_added_mass);
