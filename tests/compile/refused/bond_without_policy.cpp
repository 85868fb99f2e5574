// silt - BSD-3-Clause, see LICENSE
// refused: give the simulation silt::Bonds{model} among its policies
// in at most 15 lines of g++
#include "scene.hpp"

inline void glue_two() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e7}}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  sim.bond(0, 1);
}
