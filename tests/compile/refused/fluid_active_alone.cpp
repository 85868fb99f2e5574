// silt - BSD-3-Clause, see LICENSE
// refused: a fluid given to Simulation (active = true) has no member `FluidClock clock`
#include "scene.hpp"

struct Wind {
#if defined(SILT_MENDED)
  static constexpr bool active = false;
#else
  static constexpr bool active = true;
#endif
};
silt::Simulation sim{beads, contacts, Wind{}};
