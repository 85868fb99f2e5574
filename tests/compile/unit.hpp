// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <string>
#include <vector>

/// What one translation unit makes of the same scene.
struct UnitResult {
  std::size_t lanes;              // of its kernels in double
  std::string simulation;         // name of the simulation's type
  std::vector<double> positions;  // [m] three a particle
  std::vector<double> mixed;      // [m] the same in mixed precision, by the long tests
};

UnitResult plain_unit();
UnitResult avx2_unit();

/// Each throws the SimulationError of two spheres that overlap at the start.
void plain_unit_fails();
void avx2_unit_fails();
