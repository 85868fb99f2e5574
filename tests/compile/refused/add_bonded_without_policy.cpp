// silt - BSD-3-Clause, see LICENSE
// refused: give the simulation silt::Bonds{model} among its policies
#include "scene.hpp"

inline void add_fibre() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e7}}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  silt::add_bonded(sim, silt::fibre({0, 0, 0}, {1, 0, 0}, 5, {.radius = 1e-3, .density = 1000}));
}
