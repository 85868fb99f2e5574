// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/silt.hpp>

inline const silt::HertzMindlin::Material glass{.youngs_modulus = 5e7, .poisson_ratio = 0.25};
inline const silt::Particles<silt::Sphere> beads;
inline const silt::Contacts<silt::HertzMindlin> contacts{glass};
