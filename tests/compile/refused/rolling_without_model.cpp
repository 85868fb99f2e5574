// silt - BSD-3-Clause, see LICENSE
// refused: rolling values need a rolling model: Contacts<Law, RollingEpsd>
// in at most 12 lines of g++
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> right{glass, {.rolling_friction = 0.1}};
#else
silt::Contacts<silt::HertzMindlin> wrong{glass, {.rolling_friction = 0.1}};
#endif
