// silt - BSD-3-Clause, see LICENSE
// Simulations of silt::precompiled.

#include <silt/precompiled_fluid.hpp>

SILT_PRECOMPILED_COUPLED(SILT_INSTANTIATE_SIMULATION)
