// silt - BSD-3-Clause, see LICENSE
// refused: Simulation takes one neighbour search (silt/search/concept.hpp)
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::BruteForce{}};
#else
silt::Simulation sim{beads, contacts, silt::BruteForce{}, silt::VerletList<>{}};
#endif
