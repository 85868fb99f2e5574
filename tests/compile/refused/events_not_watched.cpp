// silt - BSD-3-Clause, see LICENSE
// refused: on_contact_begin and on_contact_end need a simulation that watches its contacts
#include "scene.hpp"

inline void watch() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts, silt::ContactEvents{}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  sim.run(1.0, silt::on_contact_end([](const silt::ContactEvent&) {}));
}
