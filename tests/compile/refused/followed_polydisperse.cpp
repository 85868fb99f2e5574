// silt - BSD-3-Clause, see LICENSE
// refused: FollowedDrag supports neither oriented bodies nor Polydisperse
#include <silt/fluid.hpp>

#if defined(SILT_MENDED)
using Fluid = silt::CoupledFlow<silt::Gidaspow, silt::Kernel, silt::FollowedDrag>;
#else
using Fluid =
    silt::CoupledFlow<silt::Polydisperse<silt::Gidaspow>, silt::Kernel, silt::FollowedDrag>;
#endif
static_assert(Fluid::follows);
