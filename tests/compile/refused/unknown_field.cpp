// silt - BSD-3-Clause, see LICENSE
// refused: this simulation has no Field of this name
#include "scene.hpp"

inline double charge() {
  silt::Simulation sim{beads, contacts, silt::Field<"charge">{}};
#if defined(SILT_MENDED)
  return sim.field<"charge">(0);
#else
  return sim.field<"Charge">(0);
#endif
}
