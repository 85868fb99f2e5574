// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/contact/cohesion/cohesive.hpp>

namespace silt::inline SILT_TARGET {

/// Cohesion in proportion to the area of the contact, as LIGGGHTS' `sjkr` and `sjkr2`: a
/// calibrated number for sticky bulk solids, not a surface energy. While two spheres touch, they
/// attract each other with
///
///   F = k A,   A = 2 pi R* d                                                                 (1)
///
/// A is the circle in which the spheres intersect, to first order in the overlap d. `sjkr` takes
/// the circle itself, which is smaller by a share of d/(8 R*) for equal spheres and d/(2 R) at a
/// wall; `sjkr2` takes twice the area between spheres (give twice its k) and (1) at walls. On
/// Hertz's spring two spheres are in equilibrium at d = (3 pi k/(2 E*))^2 R*, and the force that
/// separates them slowly is
///
///   F_max = 2/3 pi^3 k^3 R*^2/E*^2                                                           (2)
///
/// It depends on the stiffness: calibrate k anew for another modulus (F_max stays the same with
/// k ~ E*^(2/3)). For fine powders of known w use Jkr or Dmt.
///
/// Source: manual of LIGGGHTS, "gran cohesion sjkr" (recalled); its program gives (1) with the
///         differences above (tests/contact/cohesion.cpp). (2) is derived.
/// Valid:  overlaps of some per cent of R*, where the circle is that of (1).
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
struct AreaCohesion {
  struct Pair {
    double energy_density = 0;  // [J/m3] k >= 0; LIGGGHTS' cohesionEnergyDensity
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real pressure;  // [Pa] 2 pi k
  };
  static Coefficients<double> mix(const Pair& p) {
    return {2 * std::numbers::pi * p.energy_density};
  }
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p) {
    return p.pressure * c.R_eff * c.overlap;  // (1)
  }
  static void check(const Pair& p) {
    require_not_negative("AreaCohesion.energy_density", p.energy_density, "J/m3");
  }
};

static_assert(CohesionModel<AreaCohesion>);

}  // namespace silt
