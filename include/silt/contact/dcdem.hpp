// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/error.hpp>
#include <silt/core/functions.hpp>

namespace silt::inline SILT_TARGET {

/// `Mended`: the law as intended, with a tangential spring and Coulomb's limit. `Literal`: the law
/// as DualSPHysics 5.0 and 5.4 compute it, for comparison only; its friction is not Coulomb
/// friction.
enum class DcdemForm { Mended, Literal };

/// The contact law of the distributed contact DEM (DCDEM) of DualSPHysics, between whole spheres.
///
///   F_n = k_n d^(3/2) - g_n d^(1/4) v_n,  k_n = 4/3 E* sqrt(R*)                                (1)
///   Mended:   g_n = C_n sqrt(6 m* E* sqrt(R*)), C_n = zeta sqrt(10/9) such that e is met
///             F_t = -2/7 (k_n d^(1/2) s + g_n d^(1/4) v_t), |F_t| <= mu F_n, s the slip        (2)
///   Literal:  g_n = 2 |ln e|/sqrt(pi + ln^2 e) sqrt(m* k_n)       (pi where pi^2 is right)
///             F_t = min(mu F_n tanh(8 v_t), (k_n dt - g_n) v_t/3.5) along v_t                  (3)
///
/// `Literal` gives e = 0.234 for a specified 0.39 (0.339 for 0.5, 0.702 for 0.8). In (3) the factor
/// 8 has the unit s/m, and the units of (k_n dt - g_n) do not match. Where k_n dt < g_n the second
/// term of the minimum is negative and is the smaller one whenever F_n > 0. Friction is then a
/// dashpot without a limit, and mu has no effect. Where k_n dt > g_n it acts along the sliding
/// direction.
///
/// Source: R. B. Canelas et al., Comput. Phys. Commun. 202 (2016) 131, eqs. 24-33; the literal form
///         as read in the public sources. The factor k_n d^(1/2) in (2) is silt's: with k_n, as
///         printed, units do not match. The literal code halves the mass of a fixed wall's partner
///         in g_n. silt does not, as the law gets only the effective mass.
/// Valid:  Mended: as HertzMindlin. Literal: for comparison only.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals [m] (Mended), none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/dcdem.cpp.
template <DcdemForm Form = DcdemForm::Mended>
struct BasicDcdem {
  struct Material {
    double youngs_modulus;     // [Pa] > 0
    double poisson_ratio;      // [-] in [0, 0.5]
    double restitution = 1.0;  // [-] in (0, 1], against itself
    double friction = 0.0;     // [-] >= 0, against itself
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    double restitution;  // [-] in (0, 1]
    double friction;     // [-] >= 0
  };
  template <class Real>
  struct Coefficients {
    Real stiffness;  // [Pa] k_n / sqrt(R*)
    Real damping;    // [-] g_n / sqrt(m* k_n)
    Real friction;   // [-]
  };
  template <class Real>
  struct Slip {
    Vec3<Real> slip;  // [m]
  };
  template <class Real>
  struct Nothing {};
  template <class Real>
  using History = std::conditional_t<Form == DcdemForm::Mended, Slip<Real>, Nothing<Real>>;

  static Pair like(const Material& m) { return {m.restitution, m.friction}; }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const double E =
        effective_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus, b.poisson_ratio);
    double damping = std::sqrt(5) * damping_ratio(pair.restitution, DampingEnd::ZeroOverlap);
    if constexpr (Form == DcdemForm::Literal) {
      const double L = -std::log(pair.restitution);
      damping = 2 * L / std::sqrt(std::numbers::pi + L * L);
    }
    return {4.0 / 3.0 * E, damping, pair.friction};
  }

  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    const Real kn = p.stiffness * sqrt(c.R_eff), root = sqrt(c.overlap);
    const Real gn = p.damping * sqrt(c.m_eff * kn);
    const Real Fn =
        normal_force<DampingEnd::ZeroOverlap>(kn * root * c.overlap, gn * sqrt(root), c);  // (1)
    if constexpr (Form == DcdemForm::Mended) {
      return {Fn, slider(p, kn * root, gn * sqrt(root)).from_displacement(c, Fn, h.slip)};  // (2)
    } else {
      const Vec3<Real> v = c.tangential_velocity;
      const Real speed = sqrt(max(dot(v, v), smallest<Real>()));
      const Real along = min(p.friction * Fn * hyperbolic_tangent(Real(8) * speed),
                             (kn * c.time_step - gn) * speed * Real(1 / 3.5));  // (3)
      return {Fn, (along / speed) * v};
    }
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>& c, const Coefficients<Real>& p) {
    return Real(1.5) * p.stiffness * sqrt(c.R_eff * c.overlap);
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>& c, const Coefficients<Real>&) {
    return hertz_unloading(c);
  }
  template <class Real>
  static SILT_INLINE Stored<Real> stored(const Contact<Real>& c, const Coefficients<Real>& p,
                                         [[maybe_unused]] const History<Real>& h) {
    const Real S = p.stiffness * sqrt(c.R_eff * c.overlap), elastic = S * c.overlap,
               energy = Real(0.4) * elastic * c.overlap, zero(0);
    if constexpr (Form == DcdemForm::Mended) {
      const Real gn = p.damping * sqrt(c.m_eff * p.stiffness * sqrt(c.R_eff)),
                 damping = gn * sqrt(sqrt(c.overlap));
      return mindlin_stored<TangentialMemory::Displacement>(slider(p, S, damping), c, elastic,
                                                            energy, h.slip);
    } else
      return {elastic, energy, {zero, zero, zero}, zero};
  }
  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) {
    return hertz_contact_time(0.75 * p.stiffness, R_eff, m_eff, speed);
  }
  static void check(const Material& m) {
    require_positive("Dcdem::Material.youngs_modulus", m.youngs_modulus, "Pa");
    require_in("Dcdem::Material.poisson_ratio", m.poisson_ratio, "-", 0, 0.5);
    check(like(m));
  }
  static void check(const Pair& p) {
    require(p.restitution > 0 && p.restitution <= 1, "Dcdem restitution = ", p.restitution,
            " [-] must be in (0, 1]");
    require_not_negative("Dcdem friction", p.friction, "-");
  }

 private:
  /// Ratio F/d [N/m] of the normal spring, and the dashpot [N s/m].
  template <class Real>
  static SILT_INLINE SpringSlider<Real> slider(const Coefficients<Real>& p, const Real& spring,
                                               const Real& damping) {
    const Real share(2.0 / 7.0);
    return {share * spring, share * damping, p.friction};
  }
};

using Dcdem = BasicDcdem<>;
using DcdemLiteral = BasicDcdem<DcdemForm::Literal>;
static_assert(ContactLaw<Dcdem> && ContactLaw<DcdemLiteral>);

}  // namespace silt
