// silt - BSD-3-Clause, see LICENSE
// refused: two modules of one type
#include "scene.hpp"

inline void run() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Field<"kind">{}, silt::Field<"charge">{}};
#else
  silt::Simulation sim{beads, contacts, silt::Field<"kind">{}, silt::Field<"kind">{}};
#endif
}
