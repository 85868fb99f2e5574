// silt - BSD-3-Clause, see LICENSE
// refused: remove() on many ranks does not go with Bonds or ContactEvents so far
#include "scene.hpp"

#include <silt/ranks.hpp>

inline void many() {
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}}, silt::ContactEvents{}};
#if defined(SILT_MENDED)
  sim.add_outlet({{0, 0, 0}, {1, 1, 1}});
#else
  sim.remove(0);
#endif
  sim.run(1);
}
