// silt - BSD-3-Clause, see LICENSE
// refused: Simulation needs the particles: give one silt::Particles<Shape>
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts};
#else
silt::Simulation sim{contacts};
#endif
