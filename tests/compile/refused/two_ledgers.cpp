// silt - BSD-3-Clause, see LICENSE
// refused: Simulation takes one KernelsFor, one EnergyLedger and one ContactEvents
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::EnergyLedger{}};
#else
silt::Simulation sim{beads, contacts, silt::EnergyLedger{}, silt::EnergyLedger{}};
#endif
