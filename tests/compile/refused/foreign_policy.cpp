// silt - BSD-3-Clause, see LICENSE
// refused: a policy given to Simulation belongs to no axis
// refused: PolicyOfAnAxis<double
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts, silt::KernelsFor<silt::OneLane>{}};
#else
silt::Simulation sim{beads, contacts, 0.001};
#endif
