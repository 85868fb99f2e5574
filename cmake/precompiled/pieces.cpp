// silt - BSD-3-Clause, see LICENSE
// What scenes compile beside a simulation, in silt::precompiled.

#include <silt/precompiled.hpp>

SILT_PRECOMPILED_PIECES()
