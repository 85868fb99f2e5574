// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Rolling resistance of constant size against the relative rolling velocity (model A).
///
///   M = -mu_r R* F_n w/|w|, w = w_i - w_j in the tangent plane                                (1)
///
/// Rotations so slow that the couple would reverse them within a few steps are damped over 8 steps
/// instead. A sphere then comes to rest without chatter, but there is no couple at rest. On a slope
/// it creeps at about 8 dt g sin(th). Spheres that must rest on a slope need RollingEpsd.
///
/// Source: Y. C. Zhou et al., Physica A 269 (1999) 536, eq. 7; J. Ai et al., Powder Technol. 206
///         (2011) 269, model A.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/rolling_models.cpp, tests/physics/rolling_models.cpp.
/// Valid:  spheres that roll; use RollingEpsd for spheres that must rest on a slope.
struct RollingDirectional {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double rolling_friction = 0;  // [-] mu_r >= 0
  };
  template <class Real>
  struct Coefficients {
    Real rolling_friction;  // [-]
  };
  static Coefficients<double> mix(const Pair& p) { return {p.rolling_friction}; }
  template <class Real>
  static SILT_INLINE Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p) {
    return c.against(c.angular_velocity, p.rolling_friction * c.R_eff * c.normal_force);  // (1)
  }
  static void check(const Pair& p) {
    require_not_negative("RollingDirectional.rolling_friction", p.rolling_friction, "-");
  }
};

static_assert(RollingModel<RollingDirectional>);

}  // namespace silt
