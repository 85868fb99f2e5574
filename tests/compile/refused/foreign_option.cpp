// silt - BSD-3-Clause, see LICENSE
// refused: an option must be SeveralMaterials or a RollingModel
#include "scene.hpp"

#if defined(SILT_MENDED)
silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> right{glass};
#else
silt::Contacts<silt::HertzMindlin, int> wrong{glass};
#endif
