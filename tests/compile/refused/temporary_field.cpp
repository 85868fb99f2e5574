// silt - BSD-3-Clause, see LICENSE
// refused: pass a named array or a span of one, not a temporary
#include "scene.hpp"

#if defined(SILT_MENDED)
void add(silt::VtkFields& fields, const std::vector<double>& radii) { fields.add("radius", radii); }
#else
void add(silt::VtkFields& fields) { fields.add("radius", std::vector<double>{1, 2}); }
#endif
