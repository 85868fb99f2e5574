// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string_view>

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Dashpots for a Hertz spring whose restitution depends on the impact speed. Each has one
/// parameter, `dissipation`, a material property:
///   KuwabaraKono    c_n = A S_n                 A [s]        viscoelastic bulk, e falls with speed
///   HuntCrossley    c_n = alpha k_H d^(3/2)     alpha [s/m]  no attraction; e from alpha v only
///   LinearDashpot   c_n = c                     c [N s/m]    common in codes; jumps at first touch
/// dissipation_for() of contact/damped_impact.hpp finds the value for a restitution at a speed.
///
/// Source: as HertzDamped; each is a parameter of it.
/// Valid:  as HertzMindlin.
/// Units:  SI; of `dissipation` as above.
/// Errors: HertzDamped throws InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/hertz_damped.cpp.
struct KuwabaraKono {
  static constexpr std::string_view unit = "s";
  static constexpr double exponent = 0.5;  // of the overlap
  template <class Real>
  static Real coefficient(const Real& dissipation, const Real& stiffness, const Real&) {
    return dissipation * stiffness;
  }
  /// c_n over d^exponent
  static double prefactor(double dissipation, double kH) { return 1.5 * dissipation * kH; }
};
struct HuntCrossley {
  static constexpr std::string_view unit = "s/m";
  static constexpr double exponent = 1.5;
  template <class Real>
  static Real coefficient(const Real& dissipation, const Real&, const Real& elastic_force) {
    return dissipation * elastic_force;
  }
  static double prefactor(double dissipation, double kH) { return dissipation * kH; }
};
struct LinearDashpot {
  static constexpr std::string_view unit = "N s/m";
  static constexpr double exponent = 0;
  template <class Real>
  static Real coefficient(const Real& dissipation, const Real&, const Real&) {
    return dissipation;
  }
  static double prefactor(double dissipation, double) { return dissipation; }
};

/// Hertz and Mindlin springs as in HertzMindlin, with one of the dashpots above.
///
///   S_n = 2 E* sqrt(R* d)     S_t = 8 G* sqrt(R* d)                                           (1)
///   F_n = 2/3 S_n d - c_n v_n                                                                 (2)
///   dF_t = - S_t v_t dt, total F_t - c_t v_t, |total| <= mu F_n, c_t = c_n sqrt(S_t/S_n)      (3)
///
/// Source: G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26 (1987) 1230; N. V. Brilliantov et al.,
///         Phys. Rev. E 53 (1996) 5382 (A of viscoelastic spheres); K. H. Hunt, F. R. E. Crossley,
///         J. Appl. Mech. 42 (1975) 440. The tangential dashpot is silt's choice, as in
///         HertzMindlin.
/// Valid:  as HertzMindlin. Use HertzMindlin for one restitution at all speeds.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals ([N] or [m]).
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/hertz_damped.cpp.
template <class Damping, DampingEnd End = DampingEnd::ZeroForce,
          TangentialMemory Memory = TangentialMemory::Force>
struct HertzDamped {
  struct Material {
    double youngs_modulus;     // [Pa] > 0
    double poisson_ratio;      // [-] in [0, 0.5]
    double dissipation = 0.0;  // A [s], alpha [s/m] or c [N s/m], >= 0, against itself
    double friction = 0.0;     // [-] >= 0, against itself
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    double dissipation;  // as in Material
    double friction;     // [-] >= 0
  };
  template <class Real>
  struct Coefficients {
    Real twice_modulus;    // [Pa] 2 E*
    Real stiffness_ratio;  // [-] S_t/S_n = 4 G*/E*
    Real dissipation;      // as in Material
    Real shear_damping;    // [-] c_t/c_n
    Real friction;         // [-]
  };
  template <class Real>
  struct History {
    Vec3<Real> tangential;  // [N] force on i, or [m] slip, by Memory
  };

  static Pair like(const Material& m) { return {m.dissipation, m.friction}; }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const double E =
        effective_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus, b.poisson_ratio);
    const double G = effective_shear_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus,
                                             b.poisson_ratio);
    return {2 * E, 4 * G / E, pair.dissipation, std::sqrt(4 * G / E), pair.friction};
  }
  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    const Real Sn = stiffness(c, p);  // (1)
    const Real elastic = Real(2.0 / 3.0) * Sn * c.overlap;
    const Real cn = Damping::coefficient(p.dissipation, Sn, elastic);
    const Real Fn = normal_force<End>(elastic, cn, c);                           // (2)
    return {Fn, mindlin_force<Memory>(slider(p, Sn, cn), c, Fn, h.tangential)};  // (3)
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>& c, const Coefficients<Real>& p) {
    return p.twice_modulus * sqrt(c.R_eff * c.overlap);
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>& c, const Coefficients<Real>&) {
    return hertz_unloading(c);
  }
  template <class Real>
  static SILT_INLINE Stored<Real> stored(const Contact<Real>& c, const Coefficients<Real>& p,
                                         const History<Real>& h) {
    const Real Sn = stiffness(c, p), elastic = Real(2.0 / 3.0) * Sn * c.overlap;
    const Real cn = Damping::coefficient(p.dissipation, Sn, elastic);
    return mindlin_stored<Memory>(slider(p, Sn, cn), c, elastic, Real(0.4) * elastic * c.overlap,
                                  h.tangential);
  }
  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) {
    return hertz_contact_time(0.5 * p.twice_modulus, R_eff, m_eff, speed);
  }
  static void check(const Material& m) {
    require_positive("HertzDamped::Material.youngs_modulus", m.youngs_modulus, "Pa");
    require_in("HertzDamped::Material.poisson_ratio", m.poisson_ratio, "-", 0, 0.5);
    check(like(m));
  }
  static void check(const Pair& p) {
    require_not_negative("HertzDamped dissipation", p.dissipation, Damping::unit);
    require_not_negative("HertzDamped friction", p.friction, "-");
  }

 private:
  template <class Real>
  static SILT_INLINE SpringSlider<Real> slider(const Coefficients<Real>& p, const Real& Sn,
                                               const Real& cn) {
    return {p.stiffness_ratio * Sn, p.shear_damping * cn, p.friction};
  }
};

static_assert(ContactLaw<HertzDamped<KuwabaraKono>> && ContactLaw<HertzDamped<HuntCrossley>> &&
              ContactLaw<HertzDamped<LinearDashpot>>);

}  // namespace silt
