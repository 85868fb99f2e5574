// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Lift by shear: a sphere slower than a sheared flow moves towards the faster fluid, a faster one
/// towards the slower fluid.
///
///   F = 1.615 d^2 sqrt(rho mu/|w|) f (W x w)                                                  (1)
///   f = (1 - 0.3314 sqrt b) exp(-Re/10) + 0.3314 sqrt b  for Re <= 40                         (2)
///     = 0.0524 sqrt(b Re) above,  b = d |w|/(2 |W|),  Re = rho d |W|/mu
///
/// W [m/s] fluid's velocity minus the particle's, w = curl u [1/s] of the fluid, d [m], rho
/// [kg/m3], mu [Pa s]; F [N]. 0 without slip or without shear.
///
/// Source: P. G. Saffman, J. Fluid Mech. 22 (1965) 385 and 31 (1968) 624; R. Mei, Int. J.
///         Multiphase Flow 18 (1992) 145.
/// Valid:  0.005 < b < 0.4, Re < 100, far from walls.
/// Shapes: Real = double, float or a pack, lane = particle. Tests: tests/coupling/lift.cpp.
struct SaffmanMei {
  /// f of (2) [-].
  template <class Real>
  static Real factor(const Real& Re, const Real& b) {
    using detail::lanes_of;
    const Real root = sqrt(b), part = lanes_of<Real>(0.3314) * root;
    const Real low = (Real(1) - part) * exponential(Real(lanes_of<Real>(-0.1) * Re)) + part;
    return select(Re <= Real(40), low, lanes_of<Real>(0.0524) * root * sqrt(Re));
  }
  /// Equation (1).
  template <class Real>
  static Vec3<Real> force(const Real& d, const Real& rho, const Real& mu, const Vec3<Real>& W,
                          const Vec3<Real>& curl) {
    const Real slip = sqrt(max(dot(W, W), smallest<Real>()));
    const Real shear = sqrt(max(dot(curl, curl), smallest<Real>()));
    const Real f =
        factor(Real(rho * d * slip / mu), Real(detail::lanes_of<Real>(0.5) * d * shear / slip));
    return cross(W, curl) * (detail::lanes_of<Real>(1.615) * d * d * sqrt(rho * mu / shear) * f);
  }
};

}  // namespace silt
