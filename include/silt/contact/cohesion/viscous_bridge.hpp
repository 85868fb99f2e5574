// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <numbers>

#include <silt/contact/cohesion/capillary_bridge.hpp>
#include <silt/contact/cohesion/cohesive.hpp>
#include <silt/core/powers.hpp>

namespace silt::inline SILT_TARGET {

/// Liquid bridge with viscosity: a CapillaryBridge, and the resistance of the liquid between the
/// surfaces to their motion.
///
///   normal       F = -6 pi mu R*^2 v_n/H                                                     (1)
///   tangential   F = -6 pi mu R* (8/15 ln(R*/H) + 0.9588) v_t                                (2)
///
/// H is the gap, and the roughness where the gap is smaller or the bodies touch. Spheres of reduced
/// mass m* that separate with v, without surface tension, lose
///
///   6 pi mu R*^2/m* (1 + ln(H_c/h)),   h the roughness, H_c the gap of rupture                (3)
///
/// of v; if v is less they stay together. The largest coefficient, at the roughness, limits the
/// time step to an eighth of the relaxation time m* h/(6 pi mu R*^2) of equal spheres, which is a
/// quarter of that of a small sphere at a large one. For a viscous liquid choose the roughness as
/// large as (3) allows: it enters by its logarithm. A law without friction has (1) alone. In the
/// energy ledger, what (2) takes counts as friction.
///
/// Source: (1) M. J. Adams, V. Perchard, I. Chem. E. Symp. Ser. 91 (1985) 147; (2) A. J. Goldman et
///         al., Chem. Eng. Sci. 22 (1967) 637. Recalled: the print was not read. (3) is derived.
/// Valid:  as CapillaryBridge; H well below R*, inertia of the liquid neglected.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 1 Real (Cohesive keeps it).
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
template <BridgeForce Form = BridgeForce::Willett>
struct BasicViscousBridge {
  using Capillary = BasicCapillaryBridge<Form>;
  static constexpr bool forms_at_touch = true;
  struct Pair {
    double surface_tension = 0;  // [N/m] >= 0; water 0.072
    double contact_angle = 0;    // [rad] in [0, pi/2)
    double volume = 0;           // [m3] of one bridge, >= 0
    double viscosity = 0;        // [Pa s] mu >= 0; water 0.001
    double roughness = 0;        // [m] h > 0 where there is viscosity, the smallest gap
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    typename Capillary::template Coefficients<Real> capillary;
    Real resistance;  // [Pa s] 6 pi mu, 0 if there is no liquid
    Real roughness;   // [m]
  };

  static Coefficients<double> mix(const Pair& p) {
    return {Capillary::mix({p.surface_tension, p.contact_angle, p.volume}),
            p.volume > 0 ? 6 * std::numbers::pi * p.viscosity : 0,
            p.roughness > 0 ? p.roughness : 1};
  }
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real resisted = p.resistance * c.R_eff * c.R_eff / gap(c, p) * c.normal_velocity;  // (1)
    return Capillary::attraction(c, p.capillary) + resisted;
  }
  /// [N] tangential.
  template <class Real>
  static SILT_INLINE Vec3<Real> resistance(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real shear =
        Real(8.0 / 15) * natural_log(max(c.R_eff / gap(c, p), Real(1))) + Real(0.9588);
    return (-p.resistance * c.R_eff * shear) * c.tangential_velocity;  // (2)
  }
  template <class Real>
  static SILT_INLINE Real range(const Coefficients<Real>& p, const Real& R_eff) {
    return Capillary::range(p.capillary, R_eff);
  }
  /// [s] in which the resistance at the roughness stops m_eff [kg].
  static double relaxation(const Coefficients<double>& p, double R_eff, double m_eff) {
    return m_eff * p.roughness / (p.resistance * R_eff * R_eff);
  }
  static void check(const Pair& p) {
    require_not_negative("ViscousBridge.surface_tension", p.surface_tension, "N/m");
    require(p.contact_angle >= 0 && p.contact_angle < std::numbers::pi / 2,
            "ViscousBridge.contact_angle = ", p.contact_angle, " [rad] must be in [0, pi/2)");
    require_not_negative("ViscousBridge.volume", p.volume, "m3");
    require_not_negative("ViscousBridge.viscosity", p.viscosity, "Pa s");
    require_not_negative("ViscousBridge.roughness", p.roughness, "m");
    if (!(p.volume > 0 && p.viscosity > 0)) return;
    const double rupture = mix(p).capillary.rupture;
    require(p.roughness > 0 && p.roughness < rupture, "ViscousBridge.roughness = ", p.roughness,
            " [m] must be greater than 0 and less than the gap at which the bridge breaks, ",
            rupture, " m");
  }

 private:
  template <class Real>
  static SILT_INLINE Real gap(const Contact<Real>& c, const Coefficients<Real>& p) {
    return max(-c.overlap, p.roughness);
  }
};

using ViscousBridge = BasicViscousBridge<>;
static_assert(CohesionModel<ViscousBridge>);

}  // namespace silt
