// silt - BSD-3-Clause, see LICENSE
// refused: liquid_probes and liquid_levels need a simulation with an Sph
#include <silt/sph.hpp>

#include "scene.hpp"

inline void measure() {
#if defined(SILT_MENDED)
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 20},
                  silt::SphSetup{.spacing = 0.1, .region = {{0, 0, 0}, {1, 1, 1}}}};
  silt::Simulation sim{beads, contacts, std::move(water)};
#else
  silt::Simulation sim{beads, contacts};
#endif
  sim.run(1.0, silt::liquid_levels("levels.csv", {{"left", {0.5, 0.5, 0.5}}}, silt::every(0.1)));
}
