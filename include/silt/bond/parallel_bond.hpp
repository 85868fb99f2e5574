// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// A round rod of elastic glue between two spheres: it is stretched, sheared, twisted and bent, and
/// breaks by the stress at its rim.
///
///   R_b = radius_ratio min(R_i, R_j), A = pi R_b^2, I = pi R_b^4/4, J = pi R_b^4/2
///   k_n = E A/L, k_s = k_n/stiffness_ratio, k_b = E I/L, k_t = E J/(stiffness_ratio L)      (1)
///   F = -k_n s_n n - k_s s_s,  M = -k_t a_n n - k_b a_s                                      (2)
///   dashpots -2 damping sqrt(k m*), -2 damping sqrt(k I*), one for each of the four          (3)
///   sigma = F_n/A + |M_s| R_b/I <= tensile_strength,                                         (4)
///   tau = |F_s|/A + |M_n| R_b/J <= shear_strength - sigma_n tan(friction_angle)
///
/// L: centres apart when the bond is made; s, a: shift and turn of i against j (BondStrain), n
/// along the bond, s across. sigma_n = F_n/A is tension alone. `damping` is the ratio to critical
/// damping of the pair alone; in a chain a mode of the angular frequency w has damping w
/// sqrt(m*/k_n).
///
/// Source: D. O. Potyondy, P. A. Cundall, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329, eqs. 12-17
///         (recalled), whose increments (2) sums exactly.
/// Valid:  see BondStrain. A chain of n bonds is a Timoshenko beam, (1) its E I and its shear
///         stiffness k_s L, with an error of second order in 1/n.
/// Units:  SI. Shapes: Real = double or batch, lane = bond.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/bond/beams.cpp, strength.cpp.
struct ParallelBond {
  double youngs_modulus;         // [Pa] of the bond, > 0
  double stiffness_ratio = 2.5;  // [-] k_n/k_s > 0; 2 (1 + nu) of a rod of the Poisson ratio nu
  double radius_ratio = 1;       // [-] of the smaller sphere's radius, > 0
  double tensile_strength = std::numeric_limits<double>::infinity();  // [Pa] > 0
  double shear_strength = std::numeric_limits<double>::infinity();    // [Pa] > 0
  double friction_angle = 0;                                          // [rad] in [0, pi/2)
  double damping = 0.1;  // [-] >= 0, ratio to critical damping
  double weibull_modulus =
      0;  // [-] both strengths are scattered by one Weibull factor of mean 1; 0: none

  template <class Real>
  struct Numbers {
    Real kn, ks, kt, kb;          // [N/m], [N m]
    Real cn, cs, ct, cb;          // [N s/m], [N m s]
    Real per_area;                // [1/m2]
    Real per_bend, per_twist;     // [1/m3] R_b/I, R_b/J
    Real per_tension, per_shear;  // [1/Pa] one over the strengths; 0: it never breaks
    Real friction;                // [-] tan(friction_angle)
  };

  void check() const {
    require_positive("ParallelBond.youngs_modulus", youngs_modulus, "Pa");
    require_positive("ParallelBond.stiffness_ratio", stiffness_ratio, "-");
    require_positive("ParallelBond.radius_ratio", radius_ratio, "-");
    require(tensile_strength > 0, "ParallelBond.tensile_strength = ", tensile_strength,
            " [Pa] must be greater than 0");
    require(shear_strength > 0, "ParallelBond.shear_strength = ", shear_strength,
            " [Pa] must be greater than 0");
    require(friction_angle >= 0 && friction_angle < std::numbers::pi / 2,
            "ParallelBond.friction_angle = ", friction_angle, " [rad] must be in [0, pi/2)");
    require_not_negative("ParallelBond.damping", damping, "-");
    require_not_negative("ParallelBond.weibull_modulus", weibull_modulus, "-");
  }
  Numbers<double> numbers(const BondedPair& p) const {
    const double R = radius_ratio * std::min(p.radius_i, p.radius_j);
    const double A = std::numbers::pi * R * R, I = A * R * R / 4, J = 2 * I;
    const double E_L = youngs_modulus / p.length, G_L = E_L / stiffness_ratio;
    Numbers<double> n{};
    n.kn = E_L * A, n.ks = G_L * A, n.kt = G_L * J, n.kb = E_L * I;
    const auto dashpot = [&](double k, double m) { return 2 * damping * std::sqrt(k * m); };
    n.cn = dashpot(n.kn, p.m_eff), n.cs = dashpot(n.ks, p.m_eff);
    n.ct = dashpot(n.kt, p.inertia_eff), n.cb = dashpot(n.kb, p.inertia_eff);
    n.per_area = 1 / A, n.per_bend = R / I, n.per_twist = R / J;
    double factor = 1;
    if (weibull_modulus > 0)
      factor = std::pow(-std::log1p(-p.share), 1 / weibull_modulus) /
               std::tgamma(1 + 1 / weibull_modulus);
    n.per_tension = 1 / (factor * tensile_strength), n.per_shear = 1 / (factor * shear_strength);
    n.friction = std::tan(friction_angle);
    return n;
  }
  template <class Real>
  static SILT_INLINE BondAnswer<Real> answer(const BondStrain<Real>& s, const Vec3<Real>& n,
                                             const Numbers<Real>& p) {
    const auto split = [&n](const Vec3<Real>& v, const Real& along, const Real& across) {
      return -(across * v + ((along - across) * dot(v, n)) * n);
    };
    return {split(s.shift, p.kn, p.ks), split(s.turn, p.kt, p.kb), split(s.shift_rate, p.cn, p.cs),
            split(s.turn_rate, p.ct, p.cb)};  // (2), (3)
  }
  /// (4) of the springs.
  template <class Real>
  static SILT_INLINE Real load(const BondAnswer<Real>& a, const Vec3<Real>& n,
                               const Numbers<Real>& p) {
    using std::sqrt;
    const auto parts = [&n](const Vec3<Real>& v) {
      const Real along = dot(v, n);
      const Vec3<Real> across = v - along * n;
      return std::pair{along, sqrt(dot(across, across))};
    };
    const auto [Fn, Fs] = parts(a.force);  // on i: < 0 pulls it back
    const auto [Mn, Ms] = parts(a.couple);
    const Real tension = -Fn * p.per_area;
    const Real sigma = tension + Ms * p.per_bend;
    const Real tau = Fs * p.per_area + sqrt(Mn * Mn) * p.per_twist + tension * p.friction;
    return max(sigma * p.per_tension, tau * p.per_shear);
  }
  static double energy(const BondStrain<double>& s, const Vec3d& n, const Numbers<double>& p) {
    const auto of = [&n](const Vec3d& v, double along, double across) {
      const double a = dot(v, n);
      return 0.5 * (along * a * a + across * (dot(v, v) - a * a));
    };
    return of(s.shift, p.kn, p.ks) + of(s.turn, p.kt, p.kb);
  }
  static BondStiffness stiffness(const Numbers<double>& p) {
    return {std::max(p.kn, p.ks), std::max(p.kt, p.kb)};
  }
};

static_assert(BondModel<ParallelBond>);

}  // namespace silt
