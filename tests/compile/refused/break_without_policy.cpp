// silt - BSD-3-Clause, see LICENSE
// refused: particles of this simulation do not break: give it the policy silt::Breakage{
#include "scene.hpp"

inline void run() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts,
                       silt::Breakage{silt::VogelPeukertStrength{.f_mat = 1, .least = 0.1},
                                      silt::EnergyEquivalence{},
                                      silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
                                      {.dust_below = 1e-4}}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  sim.break_particle(0);
}
