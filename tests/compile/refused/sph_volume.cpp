// silt - BSD-3-Clause, see LICENSE
// refused: Sph: UnresolvedGrains keep volume by the voidage; leave RestoredVolume out
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#if defined(SILT_MENDED)
using Water = silt::Sph<silt::UnresolvedGrains<silt::DiFelice>>;
#else
using Water = silt::Sph<silt::UnresolvedGrains<silt::DiFelice>, silt::RestoredVolume>;
#endif

inline double step_of(Water& water) { return water.longest_step(); }
