// silt - BSD-3-Clause, see LICENSE
// refused: rolling values need a rolling model: Contacts<Law, RollingEpsd>
// in at most 12 lines of g++
#include "scene.hpp"

using silt::HertzMindlin, silt::SeveralMaterials;
#if defined(SILT_MENDED)
silt::Contacts<HertzMindlin, SeveralMaterials, silt::RollingEpsd> right{{glass, glass},
                                                                        {.rolling_friction = 0.1}};
#else
silt::Contacts<HertzMindlin, SeveralMaterials> wrong{{glass, glass}, {.rolling_friction = 0.1}};
#endif
