// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Elastic-plastic spring-dashpot rolling resistance (model C). Holds a particle at rest on a
/// slope.
///
///   M <- M - k_r w dt, |M| <= M_m = mu_r R* F_n,  k_r = 2.25 k_n mu_r^2 R*^2                 (1)
///   M_d = -C_r w while |M| < M_m, C_r = 2 eta_r sqrt(I_r k_r)                                (2)
///
/// When k_r falls, M is reduced in proportion (silt's addition, as in HertzMindlin). Otherwise the
/// spring would gain energy without work.
///
/// Source: J. Ai et al., Powder Technol. 206 (2011) 269, eqs. 20-29; K. Iwashita, M. Oda 1998.
/// Valid:  spheres; w = relative rolling velocity w_i - w_j in the tangent plane.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals [N m].
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/physics/rolling.cpp (rests on an incline up to tan(angle) = mu_r).
struct RollingEpsd {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double rolling_friction = 0;  // [-] mu_r >= 0
    double damping = 0.3;         // [-] eta_r >= 0, share of the critical damping
  };
  template <class Real>
  struct Coefficients {
    Real rolling_friction;  // [-]
    Real twice_damping;     // [-]
  };
  template <class Real>
  struct History {
    Vec3<Real> torque;  // [N m] spring part, on i
  };

  static Coefficients<double> mix(const Pair& p) { return {p.rolling_friction, 2 * p.damping}; }

  template <class Real>
  static SILT_INLINE Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p,
                                       History<Real>& h) {
    const Real arm = p.rolling_friction * c.R_eff;  // [m]
    const Real kr = stiffness(c, arm);
    const Real limit = arm * c.normal_force;
    const Vec3<Real> carried = c.unloading * (h.torque + cross(c.turn, h.torque));
    const Vec3<Real> trial = carried - (kr * c.time_step) * c.angular_velocity;
    const Real size = sqrt(max(dot(trial, trial), smallest<Real>()));
    const auto mobilised = size >= limit;
    h.torque = trial * min(limit / size, Real(1));  // (1)
    const Real Cr = select(mobilised, Real(0), p.twice_damping * sqrt(c.inertia_eff * kr));
    return h.torque - Cr * c.angular_velocity;  // (2)
  }

  template <class Real>
  static SILT_INLINE Real stored(const RollingContact<Real>& c, const Coefficients<Real>& p,
                                 const History<Real>& h) {
    const Real kr = stiffness(c, p.rolling_friction * c.R_eff);
    return dot(h.torque, h.torque) / max(Real(2) * kr, smallest<Real>());
  }

  static void check(const Pair& p) {
    require_not_negative("RollingEpsd.rolling_friction", p.rolling_friction, "-");
    require_not_negative("RollingEpsd.damping", p.damping, "-");
  }

 private:
  template <class Real>
  static SILT_INLINE Real stiffness(const RollingContact<Real>& c, const Real& arm) {  // [N m]
    return Real(2.25) * c.normal_stiffness * arm * arm;
  }
};

static_assert(RollingModel<RollingEpsd>);

}  // namespace silt
