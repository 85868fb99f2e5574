// silt - BSD-3-Clause, see LICENSE
// refused: Ranks does not go with polyhedra that break so far
#include <silt/shape/laguerre_cells.hpp>

#include "scene.hpp"

#include <silt/ranks.hpp>

inline const silt::Breakage breaking{silt::VogelPeukertStrength{.f_mat = 1, .least = 0.1},
                                     silt::EnergyEquivalence{},
                                     silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
                                     {.dust_below = 1e-4}};
inline const silt::Particles<silt::Polyhedron> stones;
inline void many() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, breaking, silt::Ranks{silt::NoRanks{}}};
#else
  silt::Simulation sim{stones, contacts, breaking, silt::Ranks{silt::NoRanks{}}};
#endif
  sim.run(1);
}
