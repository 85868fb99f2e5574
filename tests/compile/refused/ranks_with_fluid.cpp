// silt - BSD-3-Clause, see LICENSE
// refused: Ranks cannot be coupled to a fluid so far
#include "scene.hpp"

#include <silt/fluid.hpp>
#include <silt/ranks.hpp>

inline void many() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}}};
#else
  silt::Simulation sim{beads, contacts, silt::Ranks{silt::NoRanks{}},
                       silt::PrescribedFlow{silt::Stokes{},
                                            silt::FluidProperties{.density = 1, .viscosity = 1e-5},
                                            [](const silt::Vec3d&, double) {
                                              return silt::Vec3d{0, 0, 0};
                                            }}};
#endif
  sim.run(1);
}
