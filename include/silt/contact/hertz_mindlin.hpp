// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/contact/impact.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Hertz normal force, Mindlin no-slip tangential spring with Coulomb's limit, and damping that
/// gives the same restitution at every impact speed.
///
///   S_n = 2 E* sqrt(R* d)             S_t = 8 G* sqrt(R* d)                                  (1)
///   F_n = 2/3 S_n d - c_n v_n         c_n = 2 sqrt(5/6) zeta sqrt(S_n m*)                    (2)
///   dF_t = - S_t v_t dt, kept in the tangent plane; total F_t - c_t v_t, |total| <= mu F_n   (3)
///
/// `Memory::Force` (default) stores the tangential force. It grows by (3) while the overlap grows,
/// and is reduced in proportion to S_t while the overlap shrinks; no energy is created (Thornton &
/// Randall 1988). `Memory::Displacement` stores the slip s and takes F_t = -S_t(d) s, as LIGGGHTS,
/// EDEM and LAMMPS' `mindlin` do. It is cheaper, but creates energy where a contact is loaded after
/// it has slipped. `End::ZeroForce` (default) cuts the attraction that damping causes near
/// separation, and uses the zeta that gives the required restitution with this cut.
/// `End::ZeroOverlap` keeps the attraction, as Tsuji does.
///
/// Source: H. Hertz 1882; R. D. Mindlin, J. Appl. Mech. 16 (1949) 259; Y. Tsuji et al., Powder
///         Technol. 71 (1992) 239; C. Thornton, C. W. Randall, Micromechanics of Granular Materials
///         (1988) 133; D. Antypov, J. A. Elliott, EPL 94 (2011) 50004 (constant restitution). The
///         dashpot is corrected for the lag of the half-step velocity (spring_slider.hpp).
/// Valid:  spheres, small overlap (d < 0.1 R*), elastic solids without adhesion.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals ([N] or [m]).
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/hertz_mindlin.cpp, tests/physics/impact.cpp.
template <DampingEnd End = DampingEnd::ZeroForce, TangentialMemory Memory = TangentialMemory::Force>
struct BasicHertzMindlin {
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
    Real twice_modulus;    // [Pa] 2 E*
    Real stiffness_ratio;  // [-] S_t/S_n = 4 G*/E*
    Real normal_damping;   // [-] c_n / sqrt(S_n m*)
    Real shear_damping;    // [-] c_t / c_n
    Real friction;         // [-]
    static constexpr std::array names{"2 E* [Pa]", "4 G*/E* [-]", "damping along the normal [-]",
                                      "damping along the surface [-]", "friction [-]"};
  };
  template <class Real>
  struct History {
    Vec3<Real> tangential;  // [N] force on i, or [m] slip, by Memory
  };

  static Pair like(const Material& m) { return {m.restitution, m.friction}; }

  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const double E =
        effective_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus, b.poisson_ratio);
    const double G = effective_shear_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus,
                                             b.poisson_ratio);
    const double zeta = damping_ratio(pair.restitution, End);
    return {2 * E, 4 * G / E, zeta * std::sqrt(10.0 / 3.0), std::sqrt(4 * G / E), pair.friction};
  }

  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    const Real Sn = p.twice_modulus * sqrt(c.R_eff * c.overlap);  // (1)
    const Real cn = p.normal_damping * sqrt(Sn * c.m_eff);
    const Real Fn = normal_force<End>(Real(2.0 / 3.0) * Sn * c.overlap, cn, c);  // (2)
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
    const Real cn = p.normal_damping * sqrt(Sn * c.m_eff);
    return mindlin_stored<Memory>(slider(p, Sn, cn), c, elastic, Real(0.4) * elastic * c.overlap,
                                  h.tangential);
  }

  template <class Real>
  static Coefficients<Real> scaled(Coefficients<Real> p, const Real& factor) {
    p.twice_modulus = p.twice_modulus * factor;
    return p;
  }
  static double compliance(const Material& m) {
    return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
  }
  static double impact_force(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) {
    const double zeta = p.normal_damping / std::sqrt(10.0 / 3.0);
    return hertz_max_elastic_force({0.5 * p.twice_modulus, R_eff, m_eff, speed, zeta});
  }

  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff,
                             double speed) {
    return hertz_contact_time(0.5 * p.twice_modulus, R_eff, m_eff, speed);
  }

  static void check(const Material& m) {
    require_positive("HertzMindlin::Material.youngs_modulus", m.youngs_modulus, "Pa");
    require_in("HertzMindlin::Material.poisson_ratio", m.poisson_ratio, "-", 0, 0.5);
    check(like(m));
  }
  static void check(const Pair& p) {
    require(p.restitution > 0 && p.restitution <= 1, "HertzMindlin restitution = ", p.restitution,
            " [-] must be in (0, 1]");
    require_not_negative("HertzMindlin friction", p.friction, "-");
  }

 private:
  template <class Real>
  static SILT_INLINE SpringSlider<Real> slider(const Coefficients<Real>& p, const Real& Sn,
                                               const Real& cn) {
    return {p.stiffness_ratio * Sn, p.shear_damping * cn, p.friction};
  }
};

using HertzMindlin = BasicHertzMindlin<>;
static_assert(ContactLaw<HertzMindlin>);

}  // namespace silt
