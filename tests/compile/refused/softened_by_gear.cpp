// silt - BSD-3-Clause, see LICENSE
// refused: turns a velocity within one step, which Gear spreads over several
#include "scene.hpp"

inline const silt::Contacts<silt::Softened<silt::HertzMindlin>> soft{
    {.solid = glass, .full_radius = 1e-3}};
#if defined(SILT_MENDED)
silt::Simulation sim{beads, soft, silt::Leapfrog{}};
#else
silt::Simulation sim{beads, soft, silt::Gear{}};
#endif
