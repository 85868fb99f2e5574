// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// How far modules that act in pairs look around a particle, half from either side: the largest of
/// all modules. With several ranks it decides, beside the reach of contacts, which particles a rank
/// has as ghosts.
struct NearReach {
  double of_surfaces = 0, of_centres = 0;  // [m] cut-offs between surfaces and between centres

  /// Two particles are within a cut-off only if the spheres of this radius [m] around their centres
  /// overlap.
  double around(double radius) const {
    return std::max(radius + 0.5 * of_surfaces, 0.5 * of_centres);
  }
  bool covers(const NearReach& other) const {
    return of_surfaces >= other.of_surfaces && of_centres >= other.of_centres;
  }
};

}  // namespace silt::detail
