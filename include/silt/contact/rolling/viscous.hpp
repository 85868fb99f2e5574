// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Rolling resistance proportional to the rolling speed (model B); zero at rest.
///
///   M = -mu_v R* F_n |v_w| w/|w|, v_w = (R_i w_i + R_j w_j) x n, w = w_i - w_j in the tangent
///   plane                                                                                     (1)
///
/// v_w is the source's w_i x R_i n - w_j x R_j n_j with n_j = -n. It is 0 for two equal spheres
/// that roll on each other like gears, which are not braked. It does not include the rotation of a
/// wall.
///
/// Source: Y. C. Zhou et al., Physica A 269 (1999) 536, eq. 8; J. Ai et al., Powder Technol. 206
///         (2011) 269, model B.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/rolling_models.cpp, tests/physics/rolling_models.cpp.
/// Valid:  spheres that roll; no particle is held at rest.
struct RollingViscous {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double rolling_viscosity = 0;  // [s/m] mu_v >= 0
  };
  template <class Real>
  struct Coefficients {
    Real rolling_viscosity;  // [s/m]
  };
  static Coefficients<double> mix(const Pair& p) { return {p.rolling_viscosity}; }
  template <class Real>
  static SILT_INLINE Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p) {
    const Vec3<Real> v = cross(c.spin_velocity, c.normal);
    const Real speed = sqrt(dot(v, v));
    return c.against(c.angular_velocity,
                     p.rolling_viscosity * c.R_eff * c.normal_force * speed);  // (1)
  }
  static void check(const Pair& p) {
    require_not_negative("RollingViscous.rolling_viscosity", p.rolling_viscosity, "s/m");
  }
};

static_assert(RollingModel<RollingViscous>);

}  // namespace silt
