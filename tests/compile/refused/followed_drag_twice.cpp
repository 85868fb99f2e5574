// silt - BSD-3-Clause, see LICENSE
// refused: give FollowedDrag once
#include <silt/fluid.hpp>

#if defined(SILT_MENDED)
using Fluid = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag>;
#else
using Fluid =
    silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag, silt::FollowedDrag>;
#endif
static_assert(Fluid::follows);
