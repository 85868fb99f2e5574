// silt - BSD-3-Clause, see LICENSE
#pragma once

// Liquids with a free surface, by smoothed particle hydrodynamics: silt::Sph.

#include <silt/sph/liquid_at.hpp>
#include <silt/sph/sph.hpp>
#include <silt/sph/unresolved_grains.hpp>
