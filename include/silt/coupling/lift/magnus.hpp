// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Lift by rotation (Magnus), and the fluid's torque on a rotating sphere. With the relative
/// rotation Omega = curl(u)/2 - particle's angular velocity [1/s], Re_R = rho d^2 |Omega|/mu, Re =
/// rho d |W|/mu:
///
///   F = (pi/8) rho d^2 C_L |W| (Omega x W)/|Omega|                                            (1)
///   C_L = 0.45 + (Re_R/Re - 0.45) exp(-0.05684 Re_R^0.4 Re^0.3)                               (2)
///   T = (rho/2) (d/2)^5 C_R |Omega| Omega                                                     (3)
///   C_R = 64 pi/Re_R for Re_R <= 32, 12.9/sqrt(Re_R) + 128.4/Re_R above                       (4)
///
/// Limits: (1) (pi/8) rho d^3 (Omega x W) (Rubinow and Keller), (3) pi mu d^3 Omega (Stokes); (4)
///         jumps by 0.2 % at 32. F [N] and T [N m] act on the particle; both are 0 without slip or
///         rotation.
///
/// Source: B. Oesterle, T. Bui Dinh, Exp. Fluids 25 (1998) 16 (2); S. I. Rubinow, J. B. Keller,
///         J. Fluid Mech. 11 (1961) 447; S. C. R. Dennis, S. N. Singh, D. B. Ingham, J. Fluid Mech.
///         101 (1980) 257 (4).
/// Valid:  (2) Re < 140, (4) Re_R < 1000.
/// Shapes: Real = double, float or a pack, lane = particle. Tests: tests/coupling/lift.cpp.
struct OesterleBuiDinh {
  /// Equation (2).
  template <class Real>
  static Real lift_coefficient(const Real& Re_spin, const Real& Re) {
    using detail::guarded;
    using detail::lanes_of;
    const Real x = exact_exp2(Real(lanes_of<Real>(0.4) * exact_log2(guarded(Re_spin)) +
                                   lanes_of<Real>(0.3) * exact_log2(guarded(Re))));
    const Real E = one_minus_exponential(Real(lanes_of<Real>(0.05684) * x));
    return lanes_of<Real>(0.45) * E + Re_spin / guarded(Re) * (Real(1) - E);
  }
  /// Equation (1).
  template <class Real>
  static Vec3<Real> force(const Real& d, const Real& rho, const Real& mu, const Vec3<Real>& W,
                          const Vec3<Real>& Omega) {
    const Real slip = sqrt(dot(W, W)), spin = sqrt(max(dot(Omega, Omega), smallest<Real>()));
    const Real C = lift_coefficient(Real(rho * d * d * spin / mu), Real(rho * d * slip / mu));
    return cross(Omega, W) *
           (detail::lanes_of<Real>(std::numbers::pi / 8) * rho * d * d * C * slip / spin);
  }
};

/// (4) in a form that stays finite: C_R Re_R/(64 pi), 1 in Stokes flow.
template <class Real>
inline Real rotational_drag(const Real& Re_spin) {
  using detail::lanes_of;
  const Real high = lanes_of<Real>(12.9 / (64 * std::numbers::pi)) * sqrt(Re_spin) +
                    lanes_of<Real>(128.4 / (64 * std::numbers::pi));
  return select(Re_spin <= Real(32), Real(1), high);
}

/// Equation (3) [N m].
template <class Real>
inline Vec3<Real> rotational_torque(const Real& d, const Real& rho, const Real& mu,
                                    const Vec3<Real>& Omega) {
  const Real Re_spin = rho * d * d * sqrt(dot(Omega, Omega)) / mu;
  return Omega *
         (detail::lanes_of<Real>(std::numbers::pi) * mu * d * d * d * rotational_drag(Re_spin));
}

}  // namespace silt
