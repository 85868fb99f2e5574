// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/core/lanes.hpp>

/// Forces on a particle of volume V [m3] in an accelerating fluid, in addition to drag and lift.
///
/// Symbols: Du/Dt [m/s2] acceleration of the undisturbed fluid, dv/dt the particle's, rho [kg/m3]
/// of the fluid, d [m], mu [Pa s].
/// Shapes:  Real = double, float or a pack, lane = particle; forces on the particle [N].
/// Source:  M. R. Maxey, J. J. Riley, Phys. Fluids 26 (1983) 883; T. R. Auton, J. C. R. Hunt,
///          M. Prud'homme, J. Fluid Mech. 197 (1988) 241 (Du/Dt in the virtual mass).
/// Tests:   tests/coupling/unsteady.cpp.
namespace silt::inline SILT_TARGET {

/// rho V/2 [kg] of a sphere. Virtual mass: F = virtual_mass (Du/Dt - dv/dt). As dv/dt is unknown,
/// it is added to the mass: (m + virtual_mass) dv/dt = virtual_mass Du/Dt + others.
template <class Real>
inline Real virtual_mass(const Real& V, const Real& rho) {
  return Real(0.5) * rho * V;
}

/// dv/dt [m/s2] from all other forces and the fluid's acceleration.
template <class Real>
inline Vec3<Real> acceleration_with_virtual_mass(const Vec3<Real>& others, const Real& m,
                                                 const Real& V, const Real& rho,
                                                 const Vec3<Real>& fluid_acceleration) {
  const Real added = virtual_mass(V, rho);
  return (others + fluid_acceleration * added) * (Real(1) / (m + added));
}

/// -V grad p [N]. With the whole pressure it includes buoyancy. Far from other particles it equals
/// rho V (Du/Dt - g) minus the viscous stress below.
template <class Real>
inline Vec3<Real> pressure_gradient_force(const Real& V, const Vec3<Real>& pressure_gradient) {
  return pressure_gradient * (-V);
}

/// V div tau [N], tau the fluid's mean viscous stress.
template <class Real>
inline Vec3<Real> viscous_stress_force(const Real& V, const Vec3<Real>& stress_divergence) {
  return stress_divergence * V;
}

/// 1.5 d^2 sqrt(pi rho mu) [kg/s^(1/2)]: Basset's force is this times the integral of
/// unsteady/basset.hpp.
template <class Real>
inline Real basset_coefficient(const Real& d, const Real& rho, const Real& mu) {
  using Scalar = ScalarOf<Real>;
  return Real(Scalar(1.5)) * d * d * sqrt(Real(static_cast<Scalar>(std::numbers::pi)) * rho * mu);
}

}  // namespace silt
