// silt - BSD-3-Clause, see LICENSE
// refused: Bonds join spheres that rotate: take Particles<Sphere>
#include "scene.hpp"

inline void run() {
  const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e7}};
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, glue};
  sim.run(1.0);
#else
  silt::Simulation sim{silt::Particles<silt::MultiSphere>{}, contacts, glue};
  sim.run(1.0);
#endif
}
