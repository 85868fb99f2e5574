// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/contact/concept.hpp>
#include <silt/contact/impact.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Contact law in which small spheres are softer than their material. They then do not limit the
/// time step. A safeguard ends overlaps that become too deep.
///
///   silt::Contacts<silt::Softened<silt::HertzMindlin>> contacts{
///       {.solid = glass, .full_radius = 1e-3}};     // [m] larger spheres stay hard
///
///   f_i = min(1, max((R_i/R_full)^(5/2), least))   on the modulus of sphere i; 1 for walls  (1)
///
///   1/E* = a_i/f_i + a_j/f_j, a_i + a_j = 1/E* of the solids                                  (2)
///
///   beyond an overlap of deepest 2 min(R_i, R_j), while approaching: the relative normal velocity
///   is set to e v_0, separating, and the contact exerts no force until it ends               (3)
///
/// With the exponent of (1) (ContactTime; Rayleigh: 2, LinearSpring: 3) a small sphere's contact
/// lasts as long as that of a sphere of radius R_full. Its overlap relative to the diameter grows
/// by R_full/R. `least` limits this: use softest_modulus() divided by the solid's modulus. (2)
/// scales the tangential stiffness by the same factor.
///
/// (3) is exact for a binary impact: v_0 is the approach speed at first touch, e the restitution.
/// If other particles press the pair together again, a dashpot resists. Deeper overlaps are caught
/// by Guard::max_overlap. `Simulation::safeguarded()` counts how often (3) acted. It should be
/// rare; otherwise the scene should not be softened. Check that the results do not change with
/// `full_radius`. For breakage, physical_force() gives the largest force of the impact without
/// softening.
///
/// Source: T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113 (softening, limit of 15 % of
///         the diameter). silt uses the velocity v_0 of first touch in (3) instead of the present
///         velocity: with the present one a restitution of 0.9 becomes 0.87, as the spring has
///         already slowed the spheres.
/// Valid:  scenes driven by drag, gravity or walls, not by elastic waves.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: the body's and 1 Real [m/s].
/// Errors: InputError naming field, value, unit and allowed range. Refused with Gear at compile
///         time: (3) changes the velocity within one step, which Gear's corrector amplifies.
/// Tests:  tests/contact/softened.cpp.
template <class Body, Softening Rule = Softening::ContactTime>
struct Softened {
  static_assert(
      ContactLaw<Body>,
      "Softened<Body>: Body is not a ContactLaw; its contract is in silt/contact/concept.hpp");
  static_assert(
      requires(const typename Body::template Coefficients<double>& p) { Body::scaled(p, 1.0); },
      "Softened<Body>: Body must have scaled(), which returns the coefficients of a softer body, "
      "as "
      "silt/contact/concept.hpp says");
  static_assert(is_frictional<Body> && !ActsAtDistance<Body>,
                "Softened<Body>: Body must be a frictional law without a range");

  struct Material {
    typename Body::Material solid;
    double full_radius = 0;  // [m] R_full >= 0 of spheres of this material; 0: no softening
    double least = 0;        // [-] in [0, 1], lower bound of the factor
    double deepest = 0.15;   // [-] > 0, overlap over smaller diameter; infinite: no safeguard
    bool operator==(const Material&) const = default;
  };
  using Pair = typename Body::Pair;
  template <class Real>
  struct Coefficients {
    typename Body::template Coefficients<Real> body;
    Real share_i, share_j;        // [-] a_i, a_j over their sum
    Real per_full_i, per_full_j;  // [1/m] 1/R_full; very large: no softening
    Real least_i, least_j;        // [-]
    Real deepest;                 // [-]
    Real restitution;             // [-]
  };
  template <class Real>
  struct History : detail::HistoryOf<Body, Real>::type {
    Real approach;  // [m/s] at first touch; < 0: the safeguard has acted
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
  /// True in the lanes where the safeguard acted in this step.
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
  /// Contact time [s] of partners of radii R_i and R_j [m]; wall: R_j = 0.
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
  /// Ratio of E* to that of the solids [-].
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
