// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/contact/hertz_damped.hpp>
#include <silt/contact/impact.hpp>

namespace silt::inline SILT_TARGET {

/// Head-on impact on a Hertz spring with a dashpot c0 d^p, as in HertzDamped.
///
///   m* d'' = -k_H d^(3/2) - c0 d^p d'
///
/// With x = d/d0, d0 = (m* v^2/k_H)^(2/5) and time in units of d0/v: x'' = -x^(3/2) - kappa x^p x',
///   kappa = c0 d0^(p + 1)/(m* v).
/// Restitution and overlap ratio depend on kappa alone. Closed forms exist for p = 1/4
/// (contact/impact.hpp) and, with kappa = alpha v, for
///   p = 3/2:  (1 + e) kappa = ln((1 + kappa)/(1 - kappa e)),
///             d_max/d_undamped = (2 (kappa - ln(1 + kappa))/kappa^2)^(2/5).
/// For other p the equation is integrated in the form dz/ds = v, dv/ds = -5/4 z - kappa (5 z/4)^((4
/// p - 1)/5) v with z = 4/5 x^(5/4) and ds = x^(1/4) dt. This is a linear oscillator for p = 1/4
/// and smooth for the other laws.
///
/// Valid:  as impact.hpp. Relative error 1e-7 for restitutions above 0.01.
/// Units:  SI. Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/hertz_damped.cpp (closed forms, the law itself integrated).
struct DampedImpact {
  double restitution;    // [-] 0: the partners do not separate
  double overlap_ratio;  // [-] largest overlap over its undamped value
};

namespace detail {

/// The impact with exponent p and damping kappa, integrated by the classical Runge-Kutta method.
class ReducedImpact {
 public:
  ReducedImpact(double p, double kappa, DampingEnd end)
      : power_((4 * p - 1) / 5), kappa_(kappa), end_(end) {}

  DampedImpact run() const {
    State now{1e-14, 1};  // z^power may have no value at first touch
    double deepest = 0;
    for (int step = 0; step < 100000; ++step) {
      // Small steps near first touch, where z^power is not smooth; there z = s.
      const double h = std::min(0.005, 0.05 * now.z / std::abs(now.v) + 1e-16);
      const State next = advanced(now, h);
      if (now.v > 0 && next.v <= 0)
        deepest = advanced(now, moment(now, h, [](State s) { return s.v <= 0; })).z;
      if (ended(next) || (next.v < 0 && next.z < 1e-12)) {
        const double last = ended(next) ? moment(now, h, [this](State s) { return ended(s); }) : h;
        const double e = -advanced(now, last).v;
        return {e < 1e-9 ? 0 : e, overlap_ratio(deepest)};  // smaller: no rebound
      }
      now = next;
    }
    return {0, overlap_ratio(deepest)};
  }

 private:
  struct State {
    double z, v;
  };
  static double overlap_ratio(double deepest) { return std::pow(deepest / std::sqrt(0.8), 0.8); }
  double push(State s) const {
    const double z = std::max(1.25 * s.z, 1e-15);
    return z + kappa_ * std::pow(z, power_) * s.v;
  }
  State rate(State s) const { return {s.v, -push(s)}; }
  bool ended(State s) const {
    return s.v < 0 && (s.z <= 0 || (end_ == DampingEnd::ZeroForce && push(s) <= 0));
  }
  State advanced(State s, double h) const {
    const auto along = [&](State k, double share) {
      return State{s.z + share * h * k.z, s.v + share * h * k.v};
    };
    const State a = rate(s), b = rate(along(a, 0.5)), c = rate(along(b, 0.5)),
                d = rate(along(c, 1));
    return {s.z + h / 6 * (a.z + 2 * b.z + 2 * c.z + d.z),
            s.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v)};
  }
  /// Fraction of the step h from `s` after which `happened` becomes true.
  template <class Event>
  double moment(State s, double h, const Event& happened) const {
    double before = 0, after = h;
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = 0.5 * (before + after);
      (happened(advanced(s, middle)) ? after : before) = middle;
    }
    return after;
  }

  double power_, kappa_;
  DampingEnd end_;
};

/// kappa [-] of `dissipation` 1
template <class Damping>
double reduced_damping(const HertzImpact& impact) {
  check(impact);
  require(impact.zeta == 0, "HertzImpact.zeta = ", impact.zeta,
          " [-] must be 0 here: it is the dashpot of HertzMindlin");
  const double kH = hertz_stiffness(impact.E_eff, impact.R_eff);
  const double d0 = std::pow(impact.m_eff * impact.speed * impact.speed / kH, 0.4);
  return Damping::prefactor(1, kH) * std::pow(d0, Damping::exponent + 1) /
         (impact.m_eff * impact.speed);
}

}  // namespace detail

/// Restitution and largest overlap of an impact with this `dissipation`.
template <class Damping>
DampedImpact damped_impact(const HertzImpact& impact, double dissipation,
                           DampingEnd end = DampingEnd::ZeroForce) {
  require_not_negative("dissipation", dissipation, Damping::unit);
  const double kappa = dissipation * detail::reduced_damping<Damping>(impact);
  return detail::ReducedImpact(Damping::exponent, kappa, end).run();
}

/// The `dissipation` that gives the impact this restitution in (0, 1].
template <class Damping>
double dissipation_for(double restitution, const HertzImpact& impact,
                       DampingEnd end = DampingEnd::ZeroForce) {
  require(restitution > 0 && restitution <= 1, "restitution = ", restitution,
          " [-] must be in (0, 1]");
  const double unit = detail::reduced_damping<Damping>(impact);
  if (restitution == 1) return 0;
  const auto excess = [&](double kappa) {
    return detail::ReducedImpact(Damping::exponent, kappa, end).run().restitution - restitution;
  };
  // The restitution falls as the damping grows. Bisection alternates with regula falsi (Illinois).
  double low = 0, high = 0.1, at_low = 1 - restitution, at_high = excess(high);
  for (; at_high > 0; at_high = excess(high)) low = high, at_low = at_high, high *= 2;
  for (int iteration = 0; iteration < 80 && high - low > 1e-14 * high; ++iteration) {
    const double share = iteration % 4 == 3 ? 0.5 : at_low / (at_low - at_high);
    const double middle = low + share * (high - low), here = excess(middle);
    if (here == 0) return middle / unit;
    if (here > 0)
      low = middle, at_low = here, at_high *= 0.5;
    else
      high = middle, at_high = here, at_low *= 0.5;
  }
  return 0.5 * (low + high) / unit;
}

}  // namespace silt
