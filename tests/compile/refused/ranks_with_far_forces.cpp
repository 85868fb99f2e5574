// silt - BSD-3-Clause, see LICENSE
// refused: Ranks does not go with modules that act between particles at a distance so far
#include "scene.hpp"

#include <silt/ranks.hpp>

inline void many() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Charge{.cutoff = 1e-3}};
#else
  silt::Simulation sim{beads, contacts, silt::Charge{.cutoff = 1e-3}, silt::Ranks{silt::NoRanks{}}};
#endif
  sim.run(1);
}
