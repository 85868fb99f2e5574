// silt - BSD-3-Clause, see LICENSE
// refused: DeformingBox changes velocities at each step, which Gear spreads over several
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}, silt::Leapfrog{}};
#else
silt::Simulation sim{beads, contacts, silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}, silt::Gear{}};
#endif
