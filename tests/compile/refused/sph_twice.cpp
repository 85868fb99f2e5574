// silt - BSD-3-Clause, see LICENSE
// refused: Sph: two precisions are given; give one
#include <silt/sph.hpp>

#if defined(SILT_MENDED)
using Water = silt::Sph<silt::Mixed, silt::WendlandC2>;
#else
using Water = silt::Sph<silt::Mixed, silt::Double, silt::WendlandC2>;
#endif

inline double step_of(Water& water) { return water.longest_step(); }
