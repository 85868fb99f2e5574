// silt - BSD-3-Clause, see LICENSE
// refused: give the simulation silt::EnergyLedger{} among its policies
// in at most 15 lines of g++
#include "scene.hpp"

inline double energy() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::EnergyLedger{}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  return sim.energy().kinetic();
}
