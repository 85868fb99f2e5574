// silt - BSD-3-Clause, see LICENSE
// refused: Field<Name, T>: T must be double or silt::Vec3d
#include "scene.hpp"

inline void run() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::Field<"kind", double>{}};
#else
  silt::Simulation sim{beads, contacts, silt::Field<"kind", int>{}};
#endif
}
