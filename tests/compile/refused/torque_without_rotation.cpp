// silt - BSD-3-Clause, see LICENSE
// refused: a module's force has a torque, but these spheres do not rotate
#include "scene.hpp"

inline void run() {
  const silt::LinearSpring::Material spring{.stiffness = 100};
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, silt::Contacts<silt::LinearSpring>{spring},
                       silt::BodyForce{[](const silt::Seen&) {
                         return silt::Vec3d{1, 0, 0};
                       }}};
#else
  silt::Simulation sim{beads, silt::Contacts<silt::LinearSpring>{spring},
                       silt::BodyForce{[](const silt::Seen&) { return silt::Push{}; }}};
#endif
  sim.run(1.0);
}
