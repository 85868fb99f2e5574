// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/contact/concept.hpp>
#include <silt/contact/impact.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// A contact law whose small spheres are softer than their material, so that they do not dictate
/// the time step, with a safeguard against the deep overlaps that this risks.
///
///   silt::Contacts<silt::Softened<silt::HertzMindlin>> contacts{
///       {.solid = glass, .full_radius = 1e-3}};     // [m] smaller ones behave as this one
///
///   f_i = min(1, max((R_i/R_full)^(5/2), least))   on the modulus of sphere i; walls: 1 (1)
///
///   1/E* = a_i/f_i + a_j/f_j, a_i + a_j = 1/E* of the solids                                  (2)
///
///   beyond an overlap of deepest 2 min(R_i, R_j), while approaching: the normal velocity becomes
///   e v_0 of separation, and the contact carries nothing until it ends                        (3)
///
/// With the exponent of (1) (ContactTime; Rayleigh: 2, LinearSpring: 3) a small sphere's contact
/// lasts as long as that of one of R_full; its overlap over the diameter grows by R_full/R. Where
/// that would be too much, `least` is the bound: softest_modulus() over the solid's modulus. (2)
/// scales the tangential stiffness alike. (3) is exact for an impact of two: v_0 is the approach at
/// first touch, e the restitution. If others press the pair together again, a
/// dashpot resists; what it cannot hold, Guard::max_overlap stops.
/// `Simulation::safeguarded()` counts how often (3) acted: it should be rare, or the scene is not
/// one to be softened: check that its results do not change with `full_radius`. The largest force
/// that an impact would have had without all this, for breakage: physical_force().
///
/// Source: T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113 (softening, limit of 15 % of
///         the diameter); the velocity v_0 of first touch instead of the present one is silt's: the
///         present one gives 0.87 for 0.9, as the spring has taken its part by then.
/// Valid:  scenes driven by drag, gravity or walls rather than by elastic waves.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: the body's and 1 Real [m/s].
/// Errors: InputError naming field, value, unit and allowed range. Does not compile with Gear: (3)
///         acts in one step, and Gear makes more of it.
/// Tests:  tests/contact/softened.cpp.
template <class Body, Softening Rule = Softening::ContactTime>
struct Softened {
  static_assert(
      ContactLaw<Body>,
      "Softened<Body>: Body is no ContactLaw; its contract is in silt/contact/concept.hpp");
  static_assert(
      requires(const typename Body::template Coefficients<double>& p) { Body::scaled(p, 1.0); },
      "Softened<Body>: Body must say by scaled() what its coefficients are when it is softer, as "
      "silt/contact/concept.hpp says");
  static_assert(is_frictional<Body> && !ActsAtDistance<Body>,
                "Softened<Body>: Body must be a frictional law without a range");

  struct Material {
    typename Body::Material solid;
    double full_radius = 0;  // [m] R_full >= 0 of spheres of this material; 0: none is softened
    double least = 0;        // [-] in [0, 1], bound of the factor
    double deepest = 0.15;   // [-] > 0, overlap over the smaller diameter; infinite: no safeguard
    bool operator==(const Material&) const = default;
  };
  using Pair = typename Body::Pair;
  template <class Real>
  struct Coefficients {
    typename Body::template Coefficients<Real> body;
    Real share_i, share_j;        // [-] a_i, a_j over their sum
    Real per_full_i, per_full_j;  // [1/m] 1/R_full, or so large that none is smaller
    Real least_i, least_j;        // [-]
    Real deepest;                 // [-]
    Real restitution;             // [-]
  };
  template <class Real>
  struct History : detail::HistoryOf<Body, Real>::type {
    Real approach;  // [m/s] at first touch; negative: the safeguard has acted
  };
  static constexpr bool needs_radii = true;

  static Pair like(const Material& m) { return Body::like(m.solid); }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const double of_a = Body::compliance(a.solid), of_b = Body::compliance(b.solid);
    const auto per_full = [](const Material& m) {
      return m.full_radius > 0 ? 1 / m.full_radius : 1e30;
    };
    return {Body::mix(a.solid, b.solid, pair),
            of_a / (of_a + of_b),
            of_b / (of_a + of_b),
            per_full(a),
            per_full(b),
            a.least,
            b.least,
            std::min({a.deepest, b.deepest, 1e9}),
            pair.restitution};
  }

  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    using Kept = typename detail::HistoryOf<Body, Real>::type;
    const Real zero(0), v = c.normal_velocity;
    Traction<Real> f = Body::force(c, softened(c, p), static_cast<Kept&>(h));
    const Real approach = select(abs(h.approach) > zero, h.approach, max(-v, smallest<Real>()));
    const Real smaller = select(c.radius_j > zero, min(c.radius_i, c.radius_j), c.radius_i);
    const auto deep = c.overlap > Real(2) * p.deepest * smaller;
    const auto nearing = v < zero;
    const Real turning = c.m_eff * (p.restitution * approach - v) / c.time_step;
    const Real stopping = select(nearing, Real(-0.5) * c.m_eff * v / c.time_step, zero);
    const Real now = select(approach > zero,
                            select(deep, select(nearing, -approach, approach), approach), approach);
    const auto acts = now < zero;
    f.normal = select(acts, select(approach > zero, turning, stopping), f.normal);
    f.tangential = select(acts, Vec3<Real>{zero, zero, zero}, f.tangential);
    h.approach = now;
    return f;
  }
  /// True in the lanes in which the safeguard acted in this step.
  template <class Real>
  static SILT_INLINE Mask<Real> safeguarded(const History<Real>& before, const History<Real>& now) {
    const Real zero(0);
    return select(before.approach < zero, zero, now.approach) < zero;
  }

  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>& c, const Coefficients<Real>& p) {
    return Body::stiffness(c, softened(c, p));
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>& c,
                                    const Coefficients<Real>& p) requires requires {
    Body::unloading(c, p.body);
  }
  { return Body::unloading(c, p.body); }
  template <class Real>
  static SILT_INLINE Stored<Real> stored(
      const Contact<Real>& c, const Coefficients<Real>& p,
      const History<Real>& h) requires detail::SaysWhatItStores<Body> {
    using Kept = typename detail::HistoryOf<Body, Real>::type;
    Stored<Real> s = Body::stored(c, softened(c, p), static_cast<const Kept&>(h));
    const Real zero(0);
    const auto carries = h.approach > zero;
    s.force = select(carries, s.force, zero), s.normal = select(carries, s.normal, zero);
    s.spring = select(carries, s.spring, Vec3<Real>{zero, zero, zero});
    s.tangential = select(carries, s.tangential, zero);
    s.stiffening = select(carries, s.stiffening, zero);
    return s;
  }
  /// For partners of radii R_i and R_j [m]; of a wall: R_j = 0.
  static double contact_time(const Coefficients<double>& p, double R_i, double R_j, double m_eff,
                             double speed) {
    const double R_eff = R_j > 0 ? 1 / (1 / R_i + 1 / R_j) : R_i;
    return Body::contact_time(Body::scaled(p.body, factor(p, R_i, R_j)), R_eff, m_eff, speed);
  }
  /// The largest force [N] of the unsoftened spring in an impact at `speed` [m/s].
  static double physical_force(const Coefficients<double>& p, double R_eff, double m_eff,
                               double speed) {
    return Body::impact_force(p.body, R_eff, m_eff, speed);
  }
  /// E* over that of the solids [-].
  template <class Real>
  static SILT_INLINE Real factor(const Coefficients<Real>& p, const Real& R_i, const Real& R_j) {
    const Real one(1);
    const Real of_j = select(R_j > Real(0), factor_of(R_j, p.per_full_j, p.least_j), one);
    return one / (p.share_i / factor_of(R_i, p.per_full_i, p.least_i) + p.share_j / of_j);
  }

  static void check(const Material& m) {
    Body::check(m.solid);
    require_not_negative("Softened::Material.full_radius", m.full_radius, "m");
    require_in("Softened::Material.least", m.least, "-", 0, 1);
    require(m.deepest > 0, "Softened::Material.deepest = ", m.deepest,
            " [-] must be positive; infinite: no safeguard");
  }
  static void check(const Pair& p) { Body::check(p); }

 private:
  template <class Real>
  static Real factor_of(const Real& R, const Real& per_full, const Real& least) {
    const Real x = min(R * per_full, Real(1));
    Real f = x * x;
    if constexpr (Rule == Softening::ContactTime) f = f * sqrt(x);
    if constexpr (Rule == Softening::LinearContactTime) f = f * x;
    return max(f, least);
  }
  template <class Real>
  static SILT_INLINE auto softened(const Contact<Real>& c, const Coefficients<Real>& p) {
    return Body::scaled(p.body, factor(p, c.radius_i, c.radius_j));
  }
};

}  // namespace silt
