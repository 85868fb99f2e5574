// silt - BSD-3-Clause, see LICENSE
// Simulations of silt::precompiled.

#include <silt/precompiled.hpp>

SILT_PRECOMPILED_BODIES(SILT_INSTANTIATE_SIMULATION)
