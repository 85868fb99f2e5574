// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <silt/bond/concept.hpp>
#include <silt/bond/scatter.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Point bond between two spheres: it transmits force, but its ends rotate freely about the point
/// between them, as in a ball joint.
///
///   F = -k_n s_n n - k_s s_s,  dashpots -2 damping sqrt(k m*) for both             (1)
///   F_n <= tensile_strength (tension only), |F_s| <= shear_strength                (2)
///
/// s: displacement of i against j at the middle of the bond (BondStrain), n along the bond, s
/// across.
///
/// Source: the contact bond of D. O. Potyondy, P. A. Cundall, Int. J. Rock Mech. Min. Sci. 41
///         (2004) 1329 (recalled).
/// Valid:  see BondStrain. Chains have no bending stiffness. Two spheres that roll on each other by
///         the angle a stretch the bond by R a^2.
/// Units:  SI. Shapes: Real = double or batch, lane = bond.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/bond/contact_bond.cpp.
struct ContactBond {
  double normal_stiffness;                                            // [N/m] > 0
  double shear_stiffness;                                             // [N/m] >= 0
  double tensile_strength = std::numeric_limits<double>::infinity();  // [N] > 0
  double shear_strength = std::numeric_limits<double>::infinity();    // [N] > 0
  double damping = 0.1;        // [-] >= 0, ratio to critical damping of the pair
  double weibull_modulus = 0;  // [-] as in ParallelBond; 0: no scatter
  static constexpr std::array names{"normal stiffness [N/m]", "shear stiffness [N/m]",
                                    "tensile strength [N]",   "shear strength [N]",
                                    "damping ratio [-]",      "Weibull modulus [-]"};

  template <class Real>
  struct Numbers {
    Real is_there;      // [-] 1; 0 in lanes without a bond
    Real root_mass;     // [kg^1/2] root of m*
    Real per_strength;  // [-] inverse Weibull factor of both strengths
  };

  void check() const {
    require_positive("ContactBond.normal_stiffness", normal_stiffness, "N/m");
    require_not_negative("ContactBond.shear_stiffness", shear_stiffness, "N/m");
    require(tensile_strength > 0, "ContactBond.tensile_strength = ", tensile_strength,
            " [N] must be greater than 0");
    require(shear_strength > 0, "ContactBond.shear_strength = ", shear_strength,
            " [N] must be greater than 0");
    require_not_negative("ContactBond.damping", damping, "-");
    check_weibull_modulus("ContactBond", weibull_modulus);
  }
  Numbers<double> numbers(const BondedPair& p) const {
    return {1, std::sqrt(p.m_eff), 1 / weibull_factor(p.share, weibull_modulus)};
  }
  bool has_dashpots() const { return damping > 0; }
  template <class Real>
  SILT_INLINE BondAnswer<Real> answer(const BondStrain<Real>& s, const Numbers<Real>& p) const {
    const Vec3<Real>& n = s.normal;
    const auto split = [&n](const Vec3<Real>& v, const Real& along, const Real& across) {
      return -(v * across + n * ((along - across) * dot(v, n)));
    };
    const Real kn = p.is_there * Real(normal_stiffness), ks = p.is_there * Real(shear_stiffness);
    const Real c = p.root_mass * Real(2 * damping);
    const Vec3<Real> none{Real(0), Real(0), Real(0)};
    return {split(s.shift, kn, ks), none,
            split(s.shift_rate, c * Real(std::sqrt(normal_stiffness)),
                  c * Real(std::sqrt(shear_stiffness))),
            none};  // (1)
  }
  template <class Real>
  SILT_INLINE Real load(const BondAnswer<Real>& a, const Vec3<Real>& n,
                        const Numbers<Real>& p) const {
    const Real along = dot(a.force, n);  // on i: < 0 is tension
    const Vec3<Real> rest = a.force - n * along;
    return max(-along * Real(1 / tensile_strength),
               sqrt(dot(rest, rest)) * Real(1 / shear_strength)) *
           p.per_strength;  // (2)
  }
  double energy(const BondStrain<double>& s, const Numbers<double>& p) const {
    return -0.5 * dot(answer(s, p).force, s.shift);
  }
  BondStiffness stiffest(const Numbers<double>& p) const {
    const double k = std::max(normal_stiffness, shear_stiffness);
    return {k, 0, 2 * damping * p.root_mass * std::sqrt(k), 0};
  }
};

static_assert(BondModel<ContactBond>);

}  // namespace silt
