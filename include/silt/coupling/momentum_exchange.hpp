// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/powers.hpp>

namespace silt::inline SILT_TARGET {

/// Mean force of the fluid on a particle over one coupling step, stable and accurate for any drag:
/// the particle's velocity follows its exact exponential, and the fluid gets exactly -F.
///
///   F = b (u - v) - c                                                                        (1)
///   b = (m/dt) E,  c = m a (1 - E/X),  X = dt K/m,  E = 1 - e^-X                              (2)
///
/// u [m/s] the fluid's velocity at the end of the step, v the particle's at its start, a [m/s2] its
/// other acceleration (gravity and pressure; contacts of the last step), K [kg/s] drag coefficient,
/// m [kg]. (m/dt)(v' - v) = F + m a is then the exact solution for constant u and a, and the
/// terminal velocity u + m a/K is exact for any X. The fluid has sum b on its diagonal, and sum (b
/// v + c) on the right-hand side. F is then constant over the particle steps.
///
/// If the particles' mass is not small compared with the fluid's, u changes within the step. With
/// their ratio l = (sum m)/(fluid's mass around them) [-]
///
///   E = (1 - e^-Y)/(1 + l e^-Y),  Y = (1 + l) X                                               (3)
///
/// makes the relaxation of equal particles with an implicit fluid exact for any dt as well. l = 0
/// is (2), right for a fluid with constant velocity, with an error of up to 0.17 l of the slip
/// (after one step of X = 1.5).
///
/// Units:  SI. Shapes: Real = double, float or a pack, lane = particle.
/// Tests:  tests/coupling/momentum_exchange.cpp.
template <class Real>
struct MomentumExchange {
  Real coefficient;   // [kg/s] b
  Vec3<Real> offset;  // [N] c

  /// F of (1) [N] on the particle; -F acts on the fluid.
  Vec3<Real> force(const Vec3<Real>& u, const Vec3<Real>& v) const {
    return (u - v) * coefficient - offset;
  }
};

/// (2) and (3), for m > 0, dt > 0, K >= 0, loading >= 0; without drag (K = 0) both are 0.
template <class Real>
inline MomentumExchange<Real> momentum_exchange(const Real& m, const Real& K, const Real& dt,
                                                const Vec3<Real>& a,
                                                const Real& loading = Real(0)) {
  const Real X = max(dt * K / m, smallest<Real>());
  const Real lost = one_minus_exponential(Real((Real(1) + loading) * X));
  const Real E = lost / (Real(1) + loading * (Real(1) - lost));
  const Real none(0);
  return {select(K > none, m / dt * E, none), a * select(K > none, m * (Real(1) - E / X), none)};
}

}  // namespace silt
