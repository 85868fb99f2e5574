// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/kernels.hpp>

namespace silt::inline SILT_TARGET {

/// @name Volume: whether densities are tied to the space of the particles
/// @{

/// Densities follow only the continuity equation.
/// Source: none: the continuity equation of Sph.
/// Valid:  liquids that do not break up and merge again.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/sph/volume.cpp.
struct DriftingVolume {
  static constexpr SphAxis sph_axis = SphAxis::Volume;
  static constexpr bool restores = false;
  static constexpr const char* policy_name = "DriftingVolume";
  void check() const {}
};

/// Densities relax to those of the space of the particles. The continuity equation alone loses this
/// relation where a liquid breaks up and merges again: drops keep their density on impact, and
/// their particles stay too far apart. A liquid poured into a packed bed then takes a third more
/// space than its volume.
///
///   d rho_a/dt = ... + rate c/h rho_a (n_a - 1) f,  n_a = -sum V_b r.grad W over that of a lattice
///
/// n is 1 where the volumes V = m/rho of liquid and solids fill space. f is 0 at a free surface,
/// detected by one-sided neighbours, and in drops:
///
///   f = (2 - 10 h |sum V_b grad W|) (5 n_a - 2.5) 1000 (rho_a/rho_0 - 1), each from 0 to 1
///
/// The last factor excludes liquid without pressure: liquid that is too dilute is not contracted,
/// but settles by its weight. With a tension it would form clumps.
///
/// Source: silt's own.
/// Valid:  with MirroredWalls; DynamicWalls keep the liquid at a distance in any case.
/// Tests:  tests/sph/volume.cpp.
/// Units:  SI.
/// Errors: InputError naming field, value and allowed range.
struct RestoredVolume {
  double rate = 0.02;  // [-]

  static constexpr SphAxis sph_axis = SphAxis::Volume;
  static constexpr bool restores = true;
  static constexpr const char* policy_name = "RestoredVolume";
  void check() const {
    require(std::isfinite(rate) && rate > 0 && rate <= 0.2, "RestoredVolume.rate = ", rate,
            " must be in (0, 0.2]; 0.02 is usual");
  }
  /// [1/s] growth rate of the density; `rho` is that at rest; `slope` [1/m] = sum V grad W, `full`
  /// n.
  double growth(const Vec3d& slope, double full, double rho, double h, double sound) const {
    const double surface = std::clamp(2 - 10 * h * norm(slope), 0.0, 1.0);
    const double drop = std::clamp(5 * full - 2.5, 0.0, 1.0);
    const double pressed = std::clamp(1000 * (rho - 1), 0.0, 1.0);
    return rate * sound / h * (full - 1) * surface * drop * pressed;
  }
};
/// @}

}  // namespace silt
