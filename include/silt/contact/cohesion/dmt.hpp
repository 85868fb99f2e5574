// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/contact/cohesion/cohesive.hpp>

namespace silt::inline SILT_TARGET {

/// Adhesion of small, stiff spheres (DMT). While they touch, they attract each other with
///
///   F = 2 pi w R*                                                                            (1)
///
/// which is also the pull-off force. For large, soft spheres use Jkr.
///
/// Source: B. V. Derjaguin, V. M. Muller, Yu. P. Toporov, J. Colloid Interface Sci. 53 (1975) 314.
/// Valid:  Tabor parameter (R* w^2/(E*^2 z0^3))^(1/3) < 0.1, z0 about 0.3 nm: tabor_parameter().
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
struct Dmt {
  struct Pair {
    double work_of_adhesion = 0;  // [J/m2] w >= 0: 2 gamma for two like surfaces
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real tension;  // [N/m] 2 pi w
  };
  static Coefficients<double> mix(const Pair& p) {
    return {2 * std::numbers::pi * p.work_of_adhesion};
  }
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p) {
    return p.tension * c.R_eff;  // (1)
  }
  static void check(const Pair& p) {
    require_not_negative("Dmt.work_of_adhesion", p.work_of_adhesion, "J/m2");
  }
};

static_assert(CohesionModel<Dmt>);

}  // namespace silt
