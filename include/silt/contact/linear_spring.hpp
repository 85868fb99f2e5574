// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/contact/concept.hpp>
#include <silt/contact/formulas.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Linear spring and dashpot along the normal; with friction also a linear tangential spring.
///
///   F_n = k_n d - c_n v_n,  c_n = 2 zeta sqrt(m* k_n)                                        (1)
///   F_t = -k_t s - c_t v_t, |F_t| <= mu F_n,  k_t/k_n = shear_ratio, c_t = c_n sqrt(k_t/k_n) (2)
///
/// `LinearSpring` has no friction; particles need neither rotation nor contact history. k is given
/// for two bodies of the same material. Two materials in contact act as springs in series.
///
/// Source: P. A. Cundall, O. D. L. Strack, Geotechnique 29 (1979) 47; T. Schwager, T. Poeschel,
///         Granular Matter 9 (2007) 465 (the end of contact, `DampingEnd`).
/// Valid:  any overlap; the contact time does not depend on the impact speed.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals [m] with friction.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/linear_spring.cpp, tests/physics/impact.cpp.
template <DampingEnd End = DampingEnd::ZeroForce>
struct BasicLinearSpring {
  static constexpr double energy_exponent = 2;  // of the overlap
  struct Material {
    double stiffness;          // [N/m] k_n against itself, > 0
    double restitution = 1.0;  // [-] in (0, 1], against itself
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    double restitution;  // [-] in (0, 1]
  };
  template <class Real>
  struct Coefficients {
    Real stiffness;  // [N/m]
    Real damping;    // [-] c_n / sqrt(m* k_n)
    static constexpr std::array names{"stiffness [N/m]", "damping [-]"};
  };

  static Pair like(const Material& m) { return {m.restitution}; }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    return {2 / (1 / a.stiffness + 1 / b.stiffness), 2 * damping_ratio(pair.restitution, End)};
  }
  template <class Real>
  static SILT_INLINE Real force(const Contact<Real>& c, const Coefficients<Real>& p) {
    return normal_force<End>(p.stiffness * c.overlap, p.damping * sqrt(p.stiffness * c.m_eff), c);
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>&, const Coefficients<Real>& p) {
    return p.stiffness;
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>&, const Coefficients<Real>&) {
    return Real(1);
  }
  template <class Real>
  static SILT_INLINE Stored<Real> stored(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real elastic = p.stiffness * c.overlap, zero(0);
    return {elastic, Real(0.5) * elastic * c.overlap, {zero, zero, zero}, zero};
  }
  static double contact_time(const Coefficients<double>& p, double, double m_eff, double) {
    return linear_contact_time(p.stiffness, m_eff, 0);
  }
  static void check(const Material& m) {
    require_positive("LinearSpring::Material.stiffness", m.stiffness, "N/m");
    check(like(m));
  }
  static void check(const Pair& p) {
    require(p.restitution > 0 && p.restitution <= 1, "LinearSpring restitution = ", p.restitution,
            " [-] must be in (0, 1]");
  }
};

/// BasicLinearSpring with a tangential spring and Coulomb friction.
/// Source: equation (2) of BasicLinearSpring, P. A. Cundall, O. D. L. Strack 1979.
/// Valid:  as BasicLinearSpring; spheres and bodies.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 3 Reals [m].
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/linear_spring.cpp, tests/physics/impact.cpp.
template <DampingEnd End = DampingEnd::ZeroForce>
struct BasicLinearSpringFriction {
  static constexpr double energy_exponent = 2;  // of the overlap
  using Normal = BasicLinearSpring<End>;
  struct Material {
    double stiffness;                // [N/m] k_n against itself, > 0
    double restitution = 1.0;        // [-] in (0, 1], against itself
    double friction = 0.0;           // [-] >= 0, against itself
    double shear_ratio = 2.0 / 7.0;  // [-] k_t/k_n in (0, 1]; 2/7 gives equal half periods
    bool operator==(const Material&) const = default;
  };
  struct Pair {
    double restitution;  // [-] in (0, 1]
    double friction;     // [-] >= 0
  };
  template <class Real>
  struct Coefficients {
    Real stiffness;    // [N/m]
    Real damping;      // [-] c_n / sqrt(m* k_n)
    Real shear_ratio;  // [-] k_t/k_n
    Real friction;     // [-]
    static constexpr std::array names{"stiffness [N/m]", "damping [-]", "k_t/k_n [-]",
                                      "friction [-]"};
  };
  template <class Real>
  struct History {
    Vec3<Real> slip;  // [m]
  };

  static Pair like(const Material& m) { return {m.restitution, m.friction}; }
  static Coefficients<double> mix(const Material& a, const Material& b, const Pair& pair) {
    const auto normal = Normal::mix({a.stiffness}, {b.stiffness}, {pair.restitution});
    const double kt = 2 / (1 / (a.shear_ratio * a.stiffness) + 1 / (b.shear_ratio * b.stiffness));
    return {normal.stiffness, normal.damping, kt / normal.stiffness, pair.friction};
  }
  template <class Real>
  static SILT_INLINE Traction<Real> force(const Contact<Real>& c, const Coefficients<Real>& p,
                                          History<Real>& h) {
    const Real cn = p.damping * sqrt(p.stiffness * c.m_eff);
    const Real Fn = normal_force<End>(p.stiffness * c.overlap, cn, c);  // (1)
    return {Fn, slider(p, cn).from_displacement(c, Fn, h.slip)};        // (2)
  }
  template <class Real>
  static SILT_INLINE Real stiffness(const Contact<Real>&, const Coefficients<Real>& p) {
    return p.stiffness;
  }
  template <class Real>
  static SILT_INLINE Real unloading(const Contact<Real>&, const Coefficients<Real>&) {
    return Real(1);
  }
  template <class Real>
  static SILT_INLINE Stored<Real> stored(const Contact<Real>& c, const Coefficients<Real>& p,
                                         const History<Real>& h) {
    const Real elastic = p.stiffness * c.overlap;
    return stored_in<TangentialMemory::Displacement>(
        slider(p, p.damping * sqrt(p.stiffness * c.m_eff)), c, elastic,
        Real(0.5) * elastic * c.overlap, h.slip);
  }
  template <class Real>
  static Coefficients<Real> scaled(Coefficients<Real> p, const Real& factor) {
    p.stiffness = p.stiffness * factor;
    return p;
  }
  static double compliance(const Material& m) { return 1 / m.stiffness; }
  static double impact_force(const Coefficients<double>& p, double, double m_eff, double speed) {
    return p.stiffness * linear_max_overlap(p.stiffness, m_eff, speed, 0.5 * p.damping);
  }
  static double contact_time(const Coefficients<double>& p, double, double m_eff, double) {
    return linear_contact_time(p.stiffness, m_eff, 0);
  }
  static void check(const Material& m) {
    require_positive("LinearSpringFriction::Material.stiffness", m.stiffness, "N/m");
    require(m.shear_ratio > 0 && m.shear_ratio <= 1,
            "LinearSpringFriction::Material.shear_ratio = ", m.shear_ratio,
            " [-] must be in (0, 1]");
    check(like(m));
  }
  static void check(const Pair& p) {
    Normal::check(typename Normal::Pair{p.restitution});
    require_not_negative("LinearSpringFriction friction", p.friction, "-");
  }

 private:
  template <class Real>
  static SILT_INLINE SpringSlider<Real> slider(const Coefficients<Real>& p, const Real& cn) {
    return {p.shear_ratio * p.stiffness, sqrt(p.shear_ratio) * cn, p.friction};
  }
};

using LinearSpring = BasicLinearSpring<>;
using LinearSpringFriction = BasicLinearSpringFriction<>;
static_assert(ContactLaw<LinearSpring> && !is_frictional<LinearSpring>);
static_assert(ContactLaw<LinearSpringFriction> && is_frictional<LinearSpringFriction>);

}  // namespace silt
