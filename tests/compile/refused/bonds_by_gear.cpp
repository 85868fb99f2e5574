// silt - BSD-3-Clause, see LICENSE
// refused: Bonds turn particles by the velocities of half steps; take Leapfrog
#include "scene.hpp"

inline void run() {
  const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e7}};
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, glue, silt::Leapfrog{}};
  sim.run(1.0);
#else
  silt::Simulation sim{beads, contacts, glue, silt::Gear{}};
  sim.run(1.0);
#endif
}
