// silt - BSD-3-Clause, see LICENSE
// refused: Simulation takes one fluid coupling (silt/coupling/concept.hpp)
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::NoFluid{}};
#else
silt::Simulation sim{beads, contacts, silt::NoFluid{}, silt::NoFluid{}};
#endif
