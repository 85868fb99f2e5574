// silt - BSD-3-Clause, see LICENSE
// refused: Simulation takes one domain (silt/boundary/domain.hpp)
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::OpenDomain{}};
#else
silt::Simulation sim{beads, contacts, silt::OpenDomain{}, silt::OpenDomain{}};
#endif
