// silt - BSD-3-Clause, see LICENSE
// refused: coordination(), contact_loads(), facet_loads(), ring_loads() and coarse-grained
#include "scene.hpp"

#include <silt/measure/coordination.hpp>
#include <silt/parallel/ranks.hpp>

inline double partners() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts};
#else
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}}};
#endif
  return silt::coordination(sim).mean;
}
