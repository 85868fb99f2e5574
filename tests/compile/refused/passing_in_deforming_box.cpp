// silt - BSD-3-Clause, see LICENSE
// refused: need a domain at rest: particles in a DeformingBox move with it past any surface
#include "scene.hpp"

#include <silt/io/passing_series.hpp>

inline void pass(silt::PassingCounter& counter) {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts,
                       silt::PeriodicBox{{{0, 0, 0}, {1, 1, 1}}, {true, true, true}}};
#else
  silt::Simulation sim{beads, contacts, silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}};
#endif
  counter.look(sim);
}
