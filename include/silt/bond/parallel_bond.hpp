// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/bond/scatter.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Elastic cylindrical rod between two spheres, with tension, shear, torsion and bending. It breaks
/// by the stress at its rim.
///
///   R_b = radius_ratio min(R_i, R_j), A = pi R_b^2, I = pi R_b^4/4, J = pi R_b^4/2
///   k_n = E A/L, k_s = k_n/stiffness_ratio, k_b = E I/L, k_t = E J/(stiffness_ratio L)      (1)
///   F = -k_n s_n n - k_s s_s,  M = -k_t a_n n - k_b a_s                                      (2)
///   dashpots -2 damping sqrt(k m*), -2 damping sqrt(k I*), one for each of the four          (3)
///   sigma = F_n/A + |M_s| R_b/I <= tensile_strength,                                         (4)
///   tau = |F_s|/A + |M_n| R_b/J <= shear_strength - sigma_n tan(friction_angle)
///
/// L: distance of the centres when the bond is made; s, a: displacement and rotation of i against j
/// (BondStrain), n along the bond, s across. sigma_n = F_n/A counts only in tension. `damping` is
/// the ratio to critical damping of the pair alone; in a chain a mode of the angular frequency w
/// has damping w sqrt(m*/k_n).
///
/// Source: D. O. Potyondy, P. A. Cundall, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329, eqs. 12-17
///         (recalled); (2) is the exact sum of their increments.
/// Valid:  see BondStrain. A chain of n bonds is a Timoshenko beam with E I by (1) and the shear
///         stiffness k_s L, with an error of second order in 1/n.
/// Units:  SI. Shapes: Real = double or batch, lane = bond.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/bond/beams.cpp, strength.cpp.
struct ParallelBond {
  double youngs_modulus;         // [Pa] of the bond, > 0
  double stiffness_ratio = 2.5;  // [-] k_n/k_s > 0; 2 (1 + nu) for a rod of Poisson ratio nu
  double radius_ratio = 1;       // [-] over the smaller sphere's radius, > 0
  double tensile_strength = std::numeric_limits<double>::infinity();  // [Pa] > 0
  double shear_strength = std::numeric_limits<double>::infinity();    // [Pa] > 0
  double friction_angle = 0;                                          // [rad] in [0, pi/2)
  double damping = 0.1;  // [-] >= 0, ratio to critical damping
  double weibull_modulus =
      0;  // [-] scatter of both strengths by one Weibull factor of mean 1; 0: none
  static constexpr double share_at_wall = 0.5;  // a rod bends in its middle
  static constexpr std::array names{
      "Young's modulus [Pa]", "k_n/k_s [-]",          "radius ratio [-]",  "tensile strength [Pa]",
      "shear strength [Pa]",  "friction angle [rad]", "damping ratio [-]", "Weibull modulus [-]"};

  template <class Real>
  struct Numbers {
    Real kn;            // [N/m]
    Real radius;        // [m] R_b
    Real cn;            // [N s/m] 2 damping sqrt(k_n m*)
    Real turn_damping;  // [N s] 2 damping sqrt(k_n I*): times R_b/2, or R_b/sqrt(2 stiffness_ratio)
    Real per_strength;  // [-] inverse Weibull factor of both strengths
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
    check_weibull_modulus("ParallelBond", weibull_modulus);
  }
  Numbers<double> numbers(const BondedPair& p) const {
    const double R = radius_ratio * std::min(p.radius_i, p.radius_j);
    const double kn = youngs_modulus * std::numbers::pi * R * R / p.length;
    return {kn, R, 2 * damping * std::sqrt(kn * p.m_eff),
            2 * damping * std::sqrt(kn * p.inertia_eff),
            1 / weibull_factor(p.share, weibull_modulus)};
  }
  bool has_dashpots() const { return damping > 0; }
  template <class Real>
  SILT_INLINE BondAnswer<Real> answer(const BondStrain<Real>& s, const Numbers<Real>& p) const {
    const Vec3<Real>& n = s.normal;
    const auto split = [&n](const Vec3<Real>& v, const Real& along, const Real& across) {
      return -(v * across + n * ((along - across) * dot(v, n)));
    };
    const Real per(1 / stiffness_ratio), root(std::sqrt(1 / stiffness_ratio));
    const Real kb = Real(0.25) * p.kn * p.radius * p.radius, kt = Real(2) * per * kb;
    const Real cb = Real(0.5) * p.radius * p.turn_damping, ct = Real(std::sqrt(2.0)) * root * cb;
    return {split(s.shift, p.kn, per * p.kn), split(s.turn, kt, kb),
            split(s.shift_rate, p.cn, root * p.cn), split(s.turn_rate, ct, cb)};  // (2), (3)
  }
  /// Lanes that certainly hold, by sums of components in place of magnitudes: without roots and
  /// divisions, for the many bonds far from their strength.
  bool holds_always() const { return std::isinf(tensile_strength) && std::isinf(shear_strength); }
  template <class Real>
  SILT_INLINE auto holds(const BondAnswer<Real>& a, const Vec3<Real>& n,
                         const Numbers<Real>& p) const {
    const auto across = [&n](const Vec3<Real>& v, const Real& along) {
      const Vec3<Real> rest = v - n * along;
      return abs(rest.x) + abs(rest.y) + abs(rest.z);
    };
    const Real Fn = dot(a.force, n), Mn = dot(a.couple, n);
    const Real sigma = Real(4) * across(a.couple, Mn) - Fn * p.radius;  // times pi R_b^3
    const Real tau = across(a.force, Fn) * p.radius + Real(2) * abs(Mn) -
                     Fn * p.radius * Real(friction_angle > 0 ? std::tan(friction_angle) : 0);
    const Real most =
        max(sigma * Real(1 / tensile_strength), tau * Real(1 / shear_strength)) * p.per_strength;
    return most <= Real(std::numbers::pi) * p.radius * p.radius * p.radius;
  }
  /// (4) for the springs.
  template <class Real>
  SILT_INLINE Real load(const BondAnswer<Real>& a, const Vec3<Real>& n,
                        const Numbers<Real>& p) const {
    const auto across = [&n](const Vec3<Real>& v, const Real& along) {
      const Vec3<Real> rest = v - n * along;
      return sqrt(dot(rest, rest));
    };
    const Real Fn = dot(a.force, n), Mn = dot(a.couple, n);  // on i: Fn < 0 is tension
    const Real per_R = Real(1) / max(p.radius, smallest<Real>());
    const Real per_area = Real(1 / std::numbers::pi) * per_R * per_R;
    const Real per_bend = Real(4) * per_area * per_R;  // R_b/I; R_b/J is half of it
    const Real tension = -Fn * per_area;
    const Real sigma = tension + across(a.couple, Mn) * per_bend;
    const Real tau = across(a.force, Fn) * per_area + abs(Mn) * (Real(0.5) * per_bend) +
                     tension * Real(friction_angle > 0 ? std::tan(friction_angle) : 0);
    return max(sigma * Real(1 / tensile_strength), tau * Real(1 / shear_strength)) * p.per_strength;
  }
  double energy(const BondStrain<double>& s, const Numbers<double>& p) const {
    const auto a = answer(s, p);
    return -0.5 * (dot(a.force, s.shift) + dot(a.couple, s.turn));
  }
  BondStiffness stiffest(const Numbers<double>& p) const {
    const double ratio = std::max(1.0, 1 / stiffness_ratio);
    const double cb = 0.5 * p.radius * p.turn_damping;
    return {ratio * p.kn, 0.25 * p.kn * p.radius * p.radius * std::max(1.0, 2 / stiffness_ratio),
            std::sqrt(ratio) * p.cn, cb * std::max(1.0, std::sqrt(2 / stiffness_ratio))};
  }
};

static_assert(BondModel<ParallelBond>);

}  // namespace silt
