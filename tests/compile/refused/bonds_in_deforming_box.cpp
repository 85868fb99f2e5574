// silt - BSD-3-Clause, see LICENSE
// refused: Bonds do not follow the flow of a DeformingBox; take PeriodicBox
#include "scene.hpp"

inline void run() {
  const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e7}};
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts,
                       silt::PeriodicBox{{{0, 0, 0}, {1, 1, 1}}, {true, true, true}}, glue};
  sim.run(1.0);
#else
  silt::Simulation sim{beads, contacts, silt::DeformingBox{{{0, 0, 0}, {1, 1, 1}}}, glue};
  sim.run(1.0);
#endif
}
