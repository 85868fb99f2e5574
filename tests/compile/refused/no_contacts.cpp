// silt - BSD-3-Clause, see LICENSE
// refused: Simulation needs one contact law: give silt::Contacts<Law>{material}
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts};
#else
silt::Simulation sim{beads};
#endif
