// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/kernels.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {
/// [-] 1 for neighbours all around, 0 for neighbours on one side only, as at a free surface or at a
/// wall. h |slope| is 0.75 at a flat surface with a half-full kernel, 0.57 at 0.7, and below 0.05
/// in spray. `slope` [1/m] = sum V grad W.
inline double sph_is_surrounded(const Vec3d& slope, double h) {
  return std::clamp(2 - 10 * h * norm(slope), 0.0, 1.0);
}
/// [-] 0 for a kernel that is half full or less, 1 from 0.7 on. `full` = 1: space is filled.
inline double sph_is_packed(double full) { return std::clamp(5 * full - 2.5, 0.0, 1.0); }

/// [1/s] Rate at which the density of spray decreases, in parts of it, until it is that at rest.
/// Spray: particles that are
/// surrounded by neighbours with voids in between. When they approach, voids close and nothing is
/// compressed, but the continuity equation raises the density as in a continuous liquid. The
/// pressure of a few per cent of density would hold spray above a floor permanently.
///
///   0.02 c/h (1 - n) f (1 - p),  f: is surrounded, p: is packed
///
/// An excess of 1 to 2 % of density is gone in the time of sound across h: fast compared with free
/// fall. What is packed, the inside of a drop, loses nothing.
inline double sph_spray_loss(const Vec3d& slope, double full, double h, double sound) {
  return 0.02 * sound / h * (1 - full) * sph_is_surrounded(slope, h) * (1 - sph_is_packed(full));
}
}  // namespace detail

/// @name Volume: whether densities are tied to the space of the particles
/// @{

/// Densities follow only the continuity equation, except in spray and where a particle has few
/// neighbours (time_step.hpp). The default with NoShifting and with UnresolvedGrains.
/// Source: none: the continuity equation of Sph.
/// Valid:  liquids that do not break up and merge again, else they take too much space.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/sph/volume.cpp.
struct DriftingVolume {
  static constexpr SphAxis sph_axis = SphAxis::Volume;
  static constexpr bool restores = false;
  static constexpr const char* policy_name = "DriftingVolume";
  void check() const {}
};

/// Densities relax to those of the space of the particles, where they differ from it by more than
/// `band`. The continuity equation alone loses this relation where a liquid breaks up and merges
/// again: drops keep their density on impact, and their particles stay too far apart. A liquid
/// poured into a packed bed then takes a third more space than its volume.
///
///   d rho_a/dt = ... + rate c/h rho_a b(n_a - 1) f
///
///   n_a = -sum V_b r.grad W over that of a lattice
///
///   b(x) = x - band for x > band, x + band for x < -band, 0 between
///
/// The band leaves a liquid alone that keeps its volume: n of particles in no order differs from 1
/// by up to 0.03. Without it, pressures follow this disorder, and a liquid never comes to rest.
///
/// n is 1 where the volumes V = m/rho of liquid and solids fill space. f is 0 at a free surface,
/// detected by one-sided neighbours, and in drops:
///
///   f = (2 - 10 h |sum V_b grad W|) (5 n_a - 2.5) 1000 (rho_a/rho_0 - 1), each from 0 to 1
///
/// For n < 1 also (1 - |sum V grad W| over that below a flat surface with the same n): two or three
/// rows below a surface n is up to 0.1 less than 1 without a void. The third factor of f excludes
/// liquid without pressure: liquid that is too dilute is not contracted, but settles by its weight.
/// With a tension it would form clumps.
///
/// Source: silt's own.
/// Valid:  with MirroredWalls; DynamicWalls keep the liquid at a distance in any case.
/// Tests:  tests/sph/volume.cpp.
/// Units:  SI.
/// Errors: InputError naming field, value and allowed range.
struct RestoredVolume {
  double rate = 0.02;  // [-]
  double band = 0.03;  // [-]

  static constexpr SphAxis sph_axis = SphAxis::Volume;
  static constexpr bool restores = true;
  static constexpr const char* policy_name = "RestoredVolume";
  void check() const {
    require(std::isfinite(rate) && rate > 0 && rate <= 0.2, "RestoredVolume.rate = ", rate,
            " must be in (0, 0.2]; 0.02 is usual");
    require(band >= 0 && band <= 0.2, "RestoredVolume.band = ", band,
            " must be in [0, 0.2]; 0.03 is usual");
  }
  /// [1/s] growth rate of the density; `rho` is over that at rest; `slope` [1/m] = sum V grad W,
  /// `full` n, `flat` [-] h |slope| of a flat surface where the kernel is as full.
  double growth(const Vec3d& slope, double full, double flat, double rho, double h,
                double sound) const {
    const double pressed = std::clamp(1000 * (rho - 1), 0.0, 1.0);
    double beyond = full - std::clamp(full, 1 - band, 1 + band);
    const double steep = h * norm(slope);
    if (beyond < 0) beyond *= steep < flat ? 1 - steep / flat : 0;
    return rate * sound / h * beyond * detail::sph_is_surrounded(slope, h) *
           detail::sph_is_packed(full) * pressed;
  }
};
/// @}

}  // namespace silt
