// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/kernels.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {
/// [-] 1 where neighbours stand all around, 0 where on one side alone, as at a free surface, a wall
/// or both: a flat surface has 0.75 where a kernel is half full, 0.57 where it is to 0.7, and spray
/// below 0.05. `slope` [1/m] = sum V grad W.
inline double sph_is_surrounded(const Vec3d& slope, double h) {
  return std::clamp(2 - 10 * h * norm(slope), 0.0, 1.0);
}
/// [-] 0 where a kernel is half full or less, 1 from 0.7 on. `full` is 1 where all space is filled.
inline double sph_is_packed(double full) { return std::clamp(5 * full - 2.5, 0.0, 1.0); }

/// [1/s] at which the density of spray falls to that of rest: particles that neighbours surround,
/// but with voids between. As they come together the voids close, and nothing is compressed; the
/// continuity equation alone raises the density as if all space were liquid, and spray that falls
/// on a floor would stay above it for good, held up by the pressure of a few per cent of density.
///
///   0.02 c/h (1 - n) f (1 - p),  f: is surrounded, p: is packed
///
/// That is slow beside sound, so that drops rebound as before, and fast beside a fall.
inline double sph_spray_loss(const Vec3d& slope, double full, double h, double sound) {
  return 0.02 * sound / h * (1 - full) * sph_is_surrounded(slope, h) * (1 - sph_is_packed(full));
}
}  // namespace detail

/// @name Volume: whether densities are kept to the room that particles take
/// @{

/// Densities follow the continuity equation alone.
/// Source: none: the continuity equation of Sph.
/// Valid:  liquids that do not break up and join again.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/sph/volume.cpp.
struct DriftingVolume {
  static constexpr SphAxis sph_axis = SphAxis::Volume;
  static constexpr bool restores = false;
  static constexpr const char* policy_name = "DriftingVolume";
  void check() const {}
};

/// Densities go back to those of the room that particles take. The continuity equation alone
/// forgets it where a liquid breaks up and joins again: drops have the density of the liquid as
/// they fall in, and stay too far apart. A liquid that was poured into a packed bed takes a third
/// more room there than it has.
///
///   d rho_a/dt = ... + rate c/h rho_a (n_a - 1) f,  n_a = -sum V_b r.grad W over that of a lattice
///
/// n is 1 where volumes V = m/rho, of liquid and of what is solid, fill space. At a free surface,
/// by how far neighbours stand on one side alone, and of drops f is 0:
///
///   f = (2 - 10 h |sum V_b grad W|) (5 n_a - 2.5) 1000 (rho_a/rho_0 - 1), each from 0 to 1
///
/// The last factor leaves alone what is under no pressure: liquid that stands too far apart is not
/// drawn together, but sinks by its weight. With a tension it breaks up into clumps.
///
/// Source: ours.
/// Valid:  with MirroredWalls; DynamicWalls keep the liquid off whatever its volume.
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
  /// [1/s] of the density, which is `rho` of that at rest; `slope` [1/m] = sum V grad W, `full` n.
  double growth(const Vec3d& slope, double full, double rho, double h, double sound) const {
    const double pressed = std::clamp(1000 * (rho - 1), 0.0, 1.0);
    return rate * sound / h * (full - 1) * detail::sph_is_surrounded(slope, h) *
           detail::sph_is_packed(full) * pressed;
  }
};
/// @}

}  // namespace silt
