// silt - BSD-3-Clause, see LICENSE
// refused: DeformingBox is for spheres so far
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}};
#else
silt::Simulation sim{silt::Particles<silt::MultiSphere>{}, contacts,
                     silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}};
#endif
