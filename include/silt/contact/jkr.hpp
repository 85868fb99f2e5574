// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/contact/adhesion.hpp>
#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/error.hpp>
#include <silt/core/functions.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Square root sqrt(a) [m^1/2] of the contact radius a of a JKR contact: A = A_t + u with
///   h(u) = u sqrt(6 A_t^2 + 4 A_t u + u^2) = q,  q^2 = R* (d - d_t)                            (1)
/// This is A^4 - R* c A = R* d without its double root at d_t. h increases and is convex: from the
/// second step on Newton's method decreases to the root, whatever the start. The start below has
/// the right limits for q -> 0 and infinity, with an error of at most 0.34 %. Three steps leave
/// 1e-15 (two 2e-12) for all q. Without adhesion A_t = 0 and A = sqrt(q).
template <class Real>
inline Real root_of_contact_radius(const Real& At, const Real& q) {
  constexpr int steps = sizeof(ScalarOf<Real>) == sizeof(float) ? 2 : 3;
  constexpr double slope = 1.4494897427831781;  // sqrt(6) - 1
  const Real tiny = smallest<Real>(), At2 = At * At;
  Real u = q / max(At + sqrt(Real(slope * slope) * At2 + q), tiny);
  for (int k = 0; k < steps; ++k) {
    const Real r = sqrt(Real(6) * At2 + u * (Real(4) * At + u));
    u = u - (u * r - q) * r / max(Real(6) * At2 + u * (Real(6) * At + Real(2) * u), tiny);
  }
  return At + u;
}

}  // namespace detail

/// Adhesive elastic spheres: normal force by Johnson, Kendall and Roberts, Mindlin's tangential
/// spring, and Coulomb's limit with the adhesion included in the normal load.
///
///   F_n = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3) - c_n v_n,  d = a^2/R* - sqrt(2 pi w a/E*)    (1)
///   c_n = 2 sqrt(5/6) zeta sqrt(S_n m*),  S_n = 2 E* a,  S_t = 8 G* a                         (2)
///   dF_t = - S_t v_t dt, total F_t - c_t v_t, |total| <= mu (F_n + 2 F_c), F_c = 3/2 pi w R*  (3)
///
/// Bodies attach when they touch, d = 0, and separate at d_t < 0: jkr_overlap_at_parting(). The
/// energy lost in this cycle is jkr_energy_loss(). It adds to the loss of the dashpot.
/// `restitution` is that of the dashpot alone. Closed forms: contact/adhesion.hpp.
///
/// Source: K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301; C. Thornton,
///         J. Phys. D 24 (1991) 1942 (2 F_c in the friction limit); a(d) by
///         detail::root_of_contact_radius. S_n of (2) is Hertz' stiffness for a; dF/dd is larger
///         near separation. No peeling: a does not depend on F_t.
/// Valid:  tabor_parameter > 5: soft, large, strongly adhesive spheres; otherwise use
///         Cohesive<HertzMindlin, Dmt>. A reduced modulus needs a smaller w: w_soft = w f^(2/5), f
///         the factor on E*.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 4 Reals (force [N], a [m]).
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/jkr.cpp, tests/physics/cohesion.cpp.
struct Jkr {
  struct Material {
    double youngs_modulus;          // [Pa] > 0
    double poisson_ratio;           // [-] in [0, 0.5]
    double work_of_adhesion = 0.0;  // [J/m2] w >= 0, against itself: 2 gamma
    double restitution = 1.0;       // [-] in (0, 1], against itself, of the dashpot alone
    double friction = 0.0;          // [-] >= 0, against itself
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    double work_of_adhesion;  // [J/m2] >= 0
    double restitution;       // [-] in (0, 1]
    double friction;          // [-] >= 0
  };
  template <class Real>
  struct Coefficients {
    Real twice_modulus;    // [Pa] 2 E*
    Real stickiness;       // [m^1/2] c/4 = sqrt(2 pi w/E*)/4
    Real stiffness_ratio;  // [-] S_t/S_n = 4 G*/E*
    Real normal_damping;   // [-] c_n / sqrt(S_n m*)
    Real shear_damping;    // [-] c_t / c_n
    Real friction;         // [-]
  };
  template <class Real>
  struct History {
    Vec3<Real> tangential;  // [N] force on i
    Real contact_radius;    // [m] a, 0: not attached
  };

  static Pair like(const Material& m) { return {m.work_of_adhesion, m.restitution, m.friction}; }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const double E =
        effective_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus, b.poisson_ratio);
    const double G = effective_shear_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus,
                                             b.poisson_ratio);
    const double zeta = damping_ratio(pair.restitution, DampingEnd::ZeroOverlap);
    return {2 * E,
            std::sqrt(2 * std::numbers::pi * pair.work_of_adhesion / E) / 4,
            4 * G / E,
            zeta * std::sqrt(10.0 / 3.0),
            std::sqrt(4 * G / E),
            pair.friction};
  }

  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    const Real zero(0);
    const Real A = root_of_radius(c, p);
    const Real a = select(c.overlap > zero, A * A, select(h.contact_radius > zero, A * A, zero));
    const auto attached = a > zero;
    const Real A3 = a * A, Sn = p.twice_modulus * a;
    const Real elastic =
        p.twice_modulus * A3 * (Real(2.0 / 3.0) * A3 / c.R_eff - Real(4) * p.stickiness);
    const Real cn = p.normal_damping * sqrt(Sn * c.m_eff);
    const Real Fn =
        select(attached, normal_force<DampingEnd::ZeroOverlap>(elastic, cn, c), zero);  // (1)
    const Real unloading = min(a / max(h.contact_radius, smallest<Real>()), Real(1));
    const Real pressing = select(attached, Fn + twice_pull_off(c, p), zero);
    const Vec3<Real> Ft =
        slider(p, Sn, cn).from_force(c, pressing, unloading, h.tangential);  // (3)
    h.contact_radius = a;
    return {Fn, Ft};
  }

  /// Range up to which bodies may stay attached.
  template <class Real>
  static SILT_INLINE Real range(const Coefficients<Real>& p, const Real& R_eff) {
    return Real(3) * p.stickiness * cube_root(p.stickiness * R_eff);
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real A = root_of_radius(c, p);
    return p.twice_modulus * A * A;
  }
  template <class Real>
  static SILT_INLINE Real pressing(const Contact<Real>& c, const Coefficients<Real>& p,
                                   const Real& normal) {
    const Real sum = max(normal + twice_pull_off(c, p), Real(0));
    return select(abs(normal) > Real(0), sum, Real(0));  // normal is 0 where they are detached
  }
  /// Only the Hertz spring is counted as stored energy: the work of adhesion is not recovered, as
  /// separation takes more energy than attachment releases.
  template <class Real>
  static SILT_INLINE Stored<Real> stored(const Contact<Real>& c, const Coefficients<Real>& p,
                                         const History<Real>& h) {
    const Real d = max(c.overlap, Real(0)), Sn = p.twice_modulus * sqrt(c.R_eff * d),
               elastic = Real(2.0 / 3.0) * Sn * d;
    const Real of_area = p.twice_modulus * h.contact_radius;
    return stored_in<TangentialMemory::Force>(
        slider(p, of_area, p.normal_damping * sqrt(of_area * c.m_eff)), c, elastic,
        Real(0.4) * elastic * d, h.tangential);
  }
  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) {
    return hertz_contact_time(0.5 * p.twice_modulus, R_eff, m_eff, speed);
  }

  static void check(const Material& m) {
    require_positive("Jkr::Material.youngs_modulus", m.youngs_modulus, "Pa");
    require_in("Jkr::Material.poisson_ratio", m.poisson_ratio, "-", 0, 0.5);
    check(like(m));
  }
  static void check(const Pair& p) {
    require_not_negative("Jkr work_of_adhesion", p.work_of_adhesion, "J/m2");
    require(p.restitution > 0 && p.restitution <= 1, "Jkr restitution = ", p.restitution,
            " [-] must be in (0, 1]");
    require_not_negative("Jkr friction", p.friction, "-");
  }

 private:
  template <class Real>
  static SILT_INLINE SpringSlider<Real> slider(const Coefficients<Real>& p, const Real& Sn,
                                               const Real& cn) {
    return {p.stiffness_ratio * Sn, p.shear_damping * cn, p.friction};
  }
  template <class Real>
  static SILT_INLINE Real root_of_radius(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real At = cube_root(p.stickiness * c.R_eff);
    const Real above = max(c.overlap + Real(3) * p.stickiness * At, Real(0));  // [m] d - d_t
    return detail::root_of_contact_radius(At, sqrt(c.R_eff * above));
  }
  template <class Real>
  static SILT_INLINE Real twice_pull_off(const Contact<Real>& c, const Coefficients<Real>& p) {
    return Real(12) * p.twice_modulus * p.stickiness * p.stickiness * c.R_eff;
  }
};

static_assert(ContactLaw<Jkr> && ActsAtDistance<Jkr>);

}  // namespace silt
