// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <silt/contact/formulas.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Head-on impact on a Hertz spring with the damping that gives the same restitution at every
/// speed.
///
///   m* d'' = -k_H d^(3/2) - c_n d'
///   k_H = 4/3 E* sqrt(R*),  c_n = sqrt(5) zeta sqrt(m* k_H) d^(1/4)
///
/// In z = 4/5 d^(5/4) and ds = d^(1/4) dt this is the linear oscillator m* z'' + sqrt(5) zeta
/// sqrt(m* k_H) z' + 5/4 k_H z = 0 with damping ratio zeta. The forms below are therefore exact.
/// Only the damped duration (a quadrature) and the largest force (a bisection) are computed
/// numerically.
///
/// Source: D. Antypov, J. A. Elliott, EPL 94 (2011) 50004; durations and forces are derived here.
/// Valid:  as Hertz' theory, small overlap. No gravity, no tangential motion, no other partner.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/formulas.cpp.
struct HertzImpact {
  double E_eff;     // [Pa] effective modulus, > 0
  double R_eff;     // [m] effective radius, > 0
  double m_eff;     // [kg] effective mass, > 0
  double speed;     // [m/s] of approach at first touch, > 0
  double zeta = 0;  // [-] damping ratio, >= 0: damping_ratio(e, end)
};

inline void check(const HertzImpact& impact) {
  require_positive("HertzImpact.E_eff", impact.E_eff, "Pa");
  require_positive("HertzImpact.R_eff", impact.R_eff, "m");
  require_positive("HertzImpact.m_eff", impact.m_eff, "kg");
  require_positive("HertzImpact.speed", impact.speed, "m/s");
  require_not_negative("HertzImpact.zeta", impact.zeta, "-");
}

/// Largest overlap over its undamped value [-]: exp(-4/5 zeta A(zeta)) with A of formulas.hpp. In
/// terms of the restitution: e^(2/5) for ZeroForce, e^(4/(5 pi) atan(pi/|ln e|)) for ZeroOverlap.
inline double hertz_overlap_ratio(double zeta) {
  return std::exp(-0.8 * zeta * detail::time_of_largest_overlap(zeta));
}

/// Largest overlap [m]: (5 m* v^2 / (4 k_H))^(2/5) times hertz_overlap_ratio(zeta).
inline double hertz_max_overlap(const HertzImpact& impact) {
  check(impact);
  const double kH = hertz_stiffness(impact.E_eff, impact.R_eff);
  return std::pow(1.25 * impact.m_eff * impact.speed * impact.speed / kH, 0.4) *
         hertz_overlap_ratio(impact.zeta);
}

/// Largest force of the spring alone [N], k_H d_max^(3/2): the load to use for breakage.
inline double hertz_max_elastic_force(const HertzImpact& impact) {
  return hertz_stiffness(impact.E_eff, impact.R_eff) * std::pow(hertz_max_overlap(impact), 1.5);
}

namespace detail {

/// z'' + 2 zeta z' + z = 0, z(0) = 0, z'(0) = 1: the impact in units of the undamped one. x is the
/// time over the time A(zeta) of the largest overlap: largest overlap at x = 1, zero force at x =
/// 2.
///   z = g(x) S(x), z' = g S(1 - x), z'' = -g S(2 - x), z''' = g S(3 - x), g = exp(-zeta A x)
///   S(x) = sin(x phi)/sin(phi), cos(phi) = zeta, and sinh, cosh for sin, cos beyond zeta = 1
struct DampedOscillator {
  double zeta;
  double A = time_of_largest_overlap(zeta);
  double sine = damped_frequency(zeta);
  double phase = A * sine;

  double decay(double x) const { return std::exp(-zeta * A * x); }
  double shape(double x) const {
    if (zeta == 1) return x;
    if (zeta < 1) return std::sin(x * phase) / sine;
    return std::exp((x - 1) * phase) * std::expm1(-2 * phase * x) / std::expm1(-2 * phase);
  }
};

/// Integral over [0, length] of f(distance from start, distance to end), with singularities at the
/// ends of at most x^(-1/5): trapezoidal rule in t with x = length/(1 + exp(-pi sinh t)) (H.
/// Takahasi, M. Mori, Publ. RIMS 9 (1974) 721). Both distances are passed to avoid cancellation at
/// either end.
template <class F>
double double_exponential_quadrature(double length, const F& f) {
  constexpr double step = 1.0 / 32;
  constexpr int half_nodes = 120;  // to t = 3.75, where x/length = 5e-29
  double sum = 0;
  for (int node = -half_nodes; node <= half_nodes; ++node) {
    const double t = step * node;
    const double tail = std::exp(-std::numbers::pi * std::abs(std::sinh(t)));
    const double nearer = length * tail / (1 + tail), other = length / (1 + tail);
    const double weight = std::numbers::pi * std::cosh(t) * nearer / (1 + tail);
    sum += weight * (t < 0 ? f(nearer, other) : f(other, nearer));
  }
  return step * sum;
}

/// Duration of a damped impact in units of (undamped largest overlap)/v: 4/5 int z^(-1/5) dtau.
inline double hertz_duration_factor(double zeta, DampingEnd end) {
  const DampedOscillator motion{zeta};
  const bool cut = end == DampingEnd::ZeroForce;
  // Phase angle of the sine between the end of the contact and z = 0.
  const double gap = cut && zeta < 1 ? 2 * std::asin(zeta) : 0;
  const auto integrand = [&](double x, double to_end) {
    const bool late = zeta < 1 && x * motion.phase > std::numbers::pi / 2;
    const double shape =
        late ? std::sin(gap + to_end * motion.phase) / motion.sine : motion.shape(x);
    return motion.decay(-0.2 * x) * std::pow(shape, -0.2);
  };
  const double length = cut ? 2 : std::numbers::pi / motion.phase;
  return 0.8 * motion.A * double_exponential_quadrature(length, integrand);
}

}  // namespace detail

/// Contact time over its undamped value [-]; relative error about 1e-15 for e >= 1e-12. ZeroOverlap
/// prolongs a contact (infinitely for zeta >= 1), ZeroForce shortens it.
inline double hertz_contact_time_ratio(double zeta, DampingEnd end) {
  require_not_negative("damping ratio", zeta, "-");
  if (zeta == 0) return 1;
  if (end == DampingEnd::ZeroOverlap && zeta >= 1) return std::numeric_limits<double>::infinity();
  return detail::hertz_duration_factor(zeta, end) / hertz_time_factor;
}

/// Contact time [s] with damping: hertz_contact_time times hertz_contact_time_ratio.
inline double hertz_contact_time(const HertzImpact& impact, DampingEnd end) {
  check(impact);
  return hertz_contact_time(impact.E_eff, impact.R_eff, impact.m_eff, impact.speed) *
         hertz_contact_time_ratio(impact.zeta, end);
}

/// Largest force [N] of spring and dashpot together. With damping it occurs before the largest
/// overlap. In units of the oscillator it is the maximum of -z'' z^(1/5), found by bisection.
inline double hertz_max_force(const HertzImpact& impact) {
  check(impact);
  const detail::DampedOscillator motion{impact.zeta};
  const auto past_maximum = [&](double x) {
    return 5 * motion.shape(x) * motion.shape(3 - x) >= motion.shape(1 - x) * motion.shape(2 - x);
  };
  double before = 0, x = 1;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (before + x);
    (past_maximum(middle) ? x : before) = middle;
  }
  HertzImpact undamped = impact;
  undamped.zeta = 0;
  return hertz_max_elastic_force(undamped) * motion.decay(1.2 * x) *
         std::pow(motion.shape(x), 0.2) * motion.shape(2 - x);
}

// ---- lower bounds of the stiffness
// ---------------------------------------------------------------

/// Overlap that an impact must not exceed when the stiffness is reduced for a larger time step.
struct OverlapLimit {
  double R_eff;        // [m] effective radius, > 0
  double m_eff;        // [kg] effective mass, > 0
  double speed;        // [m/s] of approach, the fastest expected, > 0
  double max_overlap;  // [m] > 0; 0.15 of the smaller diameter is a usual choice
  double zeta = 0;     // [-] damping ratio, >= 0
};

inline void check(const OverlapLimit& limit) {
  require_positive("OverlapLimit.R_eff", limit.R_eff, "m");
  require_positive("OverlapLimit.m_eff", limit.m_eff, "kg");
  require_positive("OverlapLimit.speed", limit.speed, "m/s");
  require_positive("OverlapLimit.max_overlap", limit.max_overlap, "m");
  require_not_negative("OverlapLimit.zeta", limit.zeta, "-");
}

/// Smallest E* [Pa] that keeps the overlap below the limit: 15 m* v^2/(16 sqrt(R*)) (r/d_max)^(5/2)
/// with r = hertz_overlap_ratio(zeta).
inline double softest_modulus(const OverlapLimit& limit) {
  check(limit);
  return 15.0 / 16.0 * limit.m_eff * limit.speed * limit.speed / std::sqrt(limit.R_eff) *
         std::pow(hertz_overlap_ratio(limit.zeta) / limit.max_overlap, 2.5);
}

/// Smallest k [N/m] of a linear spring that keeps the overlap below the limit: m* v^2 (exp(-zeta
/// A(zeta))/d_max)^2. R_eff has no effect.
inline double softest_linear_stiffness(const OverlapLimit& limit) {
  check(limit);
  const double ratio =
      linear_max_overlap(1, 1, 1, limit.zeta) * limit.speed / limit.max_overlap;  // [1/s]
  return limit.m_eff * ratio * ratio;
}

/// Smallest E* [Pa] for a solid sphere on a wall, with the overlap limit as a share of the
/// diameter: E* = 5/4 pi rho v^2 (r / (2 share))^(5/2), which is 79.66 rho v^2 r^(5/2) at 0.15. It
/// does not depend on the size. Two equal spheres need 1/sqrt(2) of it.
inline double softest_modulus_on_wall(double density, double speed, double zeta,
                                      double overlap_per_diameter = 0.15) {
  require_positive("density", density, "kg/m3");
  require_positive("overlap_per_diameter", overlap_per_diameter, "-");
  const double mass = 4.0 / 3.0 * std::numbers::pi * density;  // [kg] of a sphere of radius 1 m
  return softest_modulus({.R_eff = 1,
                          .m_eff = mass,
                          .speed = speed,
                          .max_overlap = 2 * overlap_per_diameter,
                          .zeta = zeta});
}

/// Quantity that a softened small sphere shares with a sphere of radius `wanted`, which then
/// determines the time step.
enum class Softening {
  Rayleigh,          // the Rayleigh time step: E ~ s^-2, s = wanted radius over radius
  ContactTime,       // the contact time of a Hertz spring: E ~ s^-5/2
  LinearContactTime  // that of a linear spring: k ~ s^-3
};

/// Factor [-] on the modulus (LinearContactTime: on the stiffness) that gives a sphere of `radius`
/// [m] the time step limit of a sphere of radius `wanted` [m]; 1 if it is not smaller. The ratio of
/// overlap to diameter grows by s (ContactTime, LinearContactTime) or s^(4/5) (Rayleigh), see
/// softest_modulus.
inline double softening_factor(double radius, double wanted, Softening rule) {
  require_positive("softening: radius", radius, "m");
  require_positive("softening: wanted radius", wanted, "m");
  const double s = std::max(wanted / radius, 1.0);
  if (rule == Softening::Rayleigh) return 1 / (s * s);
  if (rule == Softening::LinearContactTime) return 1 / (s * s * s);
  return 1 / (s * s * std::sqrt(s));
}

}  // namespace silt
