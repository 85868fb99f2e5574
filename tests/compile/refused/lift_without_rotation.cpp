// silt - BSD-3-Clause, see LICENSE
// refused: a force of the fluid depends on the rotation of particles (SpinLift)
#include <silt/fluid.hpp>

#include "scene.hpp"

inline void run() {
  const auto still = [](const silt::Vec3d&, double) { return silt::Vec3d{0, 0, 0}; };
#if defined(SILT_MENDED)
  const silt::LinearSpring::Material spring{.stiffness = 100};
  silt::Simulation sim{beads, silt::Contacts<silt::LinearSpring>{spring},
                       silt::PrescribedFlow{silt::Stokes{}, {1.2, 1.8e-5}, still}};
#else
  const silt::LinearSpring::Material spring{.stiffness = 100};
  silt::Simulation sim{
      beads, silt::Contacts<silt::LinearSpring>{spring},
      silt::PrescribedFlow{silt::Stokes{}, {1.2, 1.8e-5}, still, silt::SpinLift{}}};
#endif
  sim.run(1.0);
}
