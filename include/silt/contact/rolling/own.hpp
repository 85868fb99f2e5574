// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Rolling resistance against each partner's own rotation (model D), for comparison with codes that
/// use it.
///
///   M_i = -mu_r F_n R_i w_i/|w_i|, M_j = -mu_r F_n R_j w_j/|w_j|                              (1)
///
/// The couples are neither opposite nor objective: two spheres that rotate together as one body are
/// braked, and angular momentum is lost. Slow rotations are damped over 8 steps as in
/// RollingDirectional. Use RollingDirectional unless you compare with another code.
///
/// Source: EDEM's standard rolling friction, as in the table of document 001 (the unit vector is
///         missing there); J. Ai et al., Powder Technol. 206 (2011) 269, model D.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/rolling_models.cpp, tests/physics/rolling_models.cpp.
/// Valid:  spheres, for comparison with codes that use this model.
struct RollingOwn {
  static constexpr bool is_rolling_model = true;
  static constexpr bool of_own_rotation = true;
  struct Pair {
    double rolling_friction = 0;  // [-] mu_r >= 0
  };
  template <class Real>
  struct Coefficients {
    Real rolling_friction;  // [-]
  };
  static Coefficients<double> mix(const Pair& p) { return {p.rolling_friction}; }
  template <class Real>
  static SILT_INLINE OwnCouples<Real> torque(const RollingContact<Real>& c,
                                             const OwnRotations<Real>& own,
                                             const Coefficients<Real>& p) {
    const Real force = p.rolling_friction * c.normal_force;
    return {c.against(own.of_i, force * own.radius_i),
            c.against(own.of_j, force * own.radius_j)};  // (1)
  }
  static void check(const Pair& p) {
    require_not_negative("RollingOwn.rolling_friction", p.rolling_friction, "-");
  }
};

static_assert(RollingModel<RollingOwn>);

}  // namespace silt
