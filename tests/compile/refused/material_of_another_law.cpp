// silt - BSD-3-Clause, see LICENSE
// refused: the material is of another law than that of Contacts<Law>: give a Law::Material
// in at most 12 lines of g++
#include "scene.hpp"

// Catches "no matching function" for the plain material of a law with cohesion.
using Sticky = silt::Cohesive<silt::HertzMindlin, silt::Dmt>;
#if defined(SILT_MENDED)
silt::Contacts<Sticky> right{Sticky::Material{.body = glass, .cohesion = {}}};
#else
silt::Contacts<Sticky> wrong{glass};
#endif
