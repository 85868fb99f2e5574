// silt - BSD-3-Clause, see LICENSE
// refused: FollowedDrag does not support a virtual mass
#include <silt/fluid.hpp>

#if defined(SILT_MENDED)
using Fluid = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag>;
#else
using Fluid =
    silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag, silt::VirtualMass>;
#endif
static_assert(Fluid::follows);
