// silt - BSD-3-Clause, see LICENSE
// refused: Sph: UnresolvedGrains conserves volume by the void fraction; leave out RestoredVolume
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#if defined(SILT_MENDED)
using Water = silt::Sph<silt::UnresolvedGrains<silt::DiFelice>>;
#else
using Water = silt::Sph<silt::UnresolvedGrains<silt::DiFelice>, silt::RestoredVolume>;
#endif

inline double step_of(Water& water) { return water.longest_step(); }
