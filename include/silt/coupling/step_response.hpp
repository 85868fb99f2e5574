// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/core/powers.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Loads on a particle in a fluid step of a CoupledFlow, without those that the step computes.
struct StepLoads {
  double mass, added;  // [kg] m, infinite: fixed; m' added mass
  double drag;         // [kg/s] K
  double volume;       // [m3] for pressure and stress; 0: without (model B)
  double dt;           // [s] the fluid step
  Vec3d velocity;      // [m/s] v of the particle
  Vec3d fluid;         // [m/s] u of the fluid
  Vec3d convection;    // [m/s2] u grad u
  Vec3d others;        // [N] not from the fluid: weight, buoyancy by the fluid's weight, contacts
  Vec3d push;          // [N] from the fluid except drag, pressure, stress, added mass: lift
};

/// Velocity of a particle at the end of a fluid step, and force on it, linear in the results of the
/// step: the fluid's velocity u', grad p' and div tau'.
///
///   (m + m') dv/dt = K (u' - v) - V (grad p' - div tau') + m' Du/Dt + push + others           (1)
///   Du/Dt = (u' - u)/dt + u grad u                                                            (2)
///   X = dt K/(m + m'),  E = 1 - e^-X,  R = E/X (1 without drag)
///   v' = v0 + a u' - b (grad p' - div tau'),  a = E + R m'/(m + m'),  b = dt R V/(m + m')     (3)
///   F  = c u' - o + q (grad p' - div tau'),  c = m a/dt,  q = V - m b/dt                      (4)
///
/// (3) is the exact solution of (1) for constant u', p' in the step, and F the force of the fluid
/// besides V (div tau' - grad p'), from the same change of momentum. The total force on a particle
/// without mass is therefore 0, and the terminal velocity is right for any X and any density ratio.
/// A fluid that starts suddenly gives the inviscid impulse in the step of the start. For m' = 0 and
/// a known pressure it is MomentumExchange.
///
/// Units: SI.
/// Tests: tests/coupling/light_particles.cpp, tests/coupling/impulsive_start.cpp.
struct StepResponse {
  double with_fluid = 0;     // [-] a
  double with_pressure = 0;  // [m3 s/kg] b
  Vec3d start{0, 0, 0};      // [m/s] v0
  double coefficient = 0;    // [kg/s] c
  Vec3d offset{0, 0, 0};     // [N] o
  double borne = 0;          // [m3] q
  /// [-] share of changes of other forces during the step that the fluid force, which is constant,
  /// misses: near 0 for heavy particles, near 1 for light or stiffly coupled ones
  double lag = 0;

  /// v' of (3) [m/s]; slope: grad p' - div tau' [Pa/m].
  Vec3d velocity(const Vec3d& u, const Vec3d& slope) const {
    return start + with_fluid * u - with_pressure * slope;
  }
  /// F of (4) [N]; -F acts on the fluid.
  Vec3d force(const Vec3d& u, const Vec3d& slope) const {
    return coefficient * u - offset + borne * slope;
  }
};

/// Effect of contacts during a fluid step that the constant fluid forces miss: StepResponse::lag,
/// largest of any particle.
struct HeldAnswer {
  double lag = 0;            // [-] and
  double density_ratio = 0;  // [-] that particle's density over the fluid's
  double in_contact = 0;     // [-] lag of particles in contact, times 0.9 per step
  /// Up to this lag fluid steps of any length are stable with contacts whose dashpot is at least a
  /// twentieth of the critical one (e = 0.85). Above it fluid steps must resolve the contacts'
  /// oscillation, omega dt < 1.7. From the eigenvalues of a particle on a damped spring with (3)
  /// and (4), where the fluid gets the mean force of the spring over the previous step.
  static constexpr double most_lag = 0.1;
  static constexpr double least_lag = 1e-3;  // smaller ones are ignored
  void include(double of, double ratio, bool touched) {
    if (of > lag) lag = of, density_ratio = ratio;
    if (touched) in_contact = std::max(in_contact, of);
  }
};

inline StepResponse step_response(const StepLoads& p) {
  const Vec3d known = p.push + p.added * (p.convection - (1 / p.dt) * p.fluid);
  if (!std::isfinite(p.mass))
    return {0, 0, p.velocity, p.drag + p.added / p.dt, p.drag * p.velocity - known, 0};
  const double all = p.mass + p.added, X = p.dt * p.drag / all;
  // A drag that is NaN stays NaN, for the flow to refuse.
  const double E = X == 0 ? 0 : one_minus_exponential(X), R = X == 0 ? 1 : E / X;
  const double part = p.mass / all * R;  // of the forces that act on the particle's own mass
  StepResponse r;
  r.with_fluid = E + R * p.added / all;
  r.with_pressure = p.dt * R * p.volume / all;
  r.start = (1 - E) * p.velocity + (p.dt * R / all) * (p.others + known);
  r.coefficient = p.mass / p.dt * r.with_fluid;
  r.offset = (p.mass / p.dt * E) * p.velocity + (1 - part) * p.others - part * known;
  r.borne = (1 - part) * p.volume;
  r.lag = 1 - part;
  return r;
}

}  // namespace silt
