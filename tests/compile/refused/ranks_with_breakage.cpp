// silt - BSD-3-Clause, see LICENSE
// refused: Ranks does not go with ContactEvents, Bonds or Breakage so far
// in at most 15 lines of g++
#include "scene.hpp"

#include <silt/ranks.hpp>

inline void many() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}}};
#else
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}}, silt::ContactEvents{}};
#endif
  sim.run(1);
}
