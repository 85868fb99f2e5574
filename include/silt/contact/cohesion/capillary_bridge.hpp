// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <numbers>

#include <silt/contact/cohesion/cohesive.hpp>
#include <silt/core/functions.hpp>

namespace silt::inline SILT_TARGET {

/// Two closed forms for the force of a liquid bridge.
enum class BridgeForce { Willett, Rabinovich };

/// Pendular liquid bridge of constant volume: it forms when spheres touch and breaks at a gap H_c.
///
///   R = 2 R*: equal spheres; unequal spheres and walls by Derjaguin's approximation           (1)
///   Willett:    F = 2 pi R g cos th/(1 + 1.05 X + 2.5 X^2),  X = H sqrt(R/V)                  (2)
///   Rabinovich: F = 2 pi R g [cos th (1 - H/S) + sin a sin(th + a)],                          (3)
///               S = sqrt(H^2 + 2 V/(pi R)), a = sqrt((S - H)/R)
///   H_c = (1 + th/2) V^(1/3)                                                                   (4)
///
/// (3) is written in a form that is finite at H = 0: 1 - H/S is 1/(1 + H/(2 d_sp)) of the source.
///
/// Source: (2) C. D. Willett et al., Langmuir 16 (2000) 9396, eq. 12 (the short form); (3) Ya. I.
///         Rabinovich et al., Langmuir 21 (2005) 10992; (4) G. Lian et al., J. Colloid Interface
///         Sci. 161 (1993) 138. Recalled: the print was not read.
/// Valid:  V < 0.001 R^3, where (2) errs by a few %, up to 25 % near H_c. No gravity, no viscosity,
///         no liquid flow from bridge to bridge.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 1 Real (Cohesive keeps it).
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
template <BridgeForce Form = BridgeForce::Willett>
struct BasicCapillaryBridge {
  static constexpr bool forms_at_touch = true;
  struct Pair {
    double surface_tension = 0;  // [N/m] g >= 0; water 0.072
    double contact_angle = 0;    // [rad] th in [0, pi/2)
    double volume = 0;           // [m3] V of one bridge, >= 0
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real tension;         // [N/m] 4 pi g
    Real angle;           // [rad]
    Real cosine;          // [-] of it
    Real inverse_volume;  // [1/m3], 0 if there is no liquid
    Real volume;          // [m3]
    Real rupture;         // [m] H_c
  };

  static Coefficients<double> mix(const Pair& p) {
    return {p.volume > 0 ? 4 * std::numbers::pi * p.surface_tension : 0,
            p.contact_angle,
            std::cos(p.contact_angle),
            p.volume > 0 ? 1 / p.volume : 0,
            p.volume,
            (1 + p.contact_angle / 2) * std::cbrt(p.volume)};
  }
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real H = max(-c.overlap, Real(0)), R = Real(2) * c.R_eff;  // (1)
    if constexpr (Form == BridgeForce::Willett) {
      const Real X2 = H * H * R * p.inverse_volume;
      return p.tension * c.R_eff * p.cosine /
             (Real(1) + Real(1.05) * sqrt(X2) + Real(2.5) * X2);  // (2)
    } else {
      const Real S = sqrt(max(H * H + Real(2 / std::numbers::pi) * p.volume / R, smallest<Real>()));
      const Real a = sqrt(max(S - H, Real(0)) / R);
      // sin a sin(th + a) = (cos th - cos(th + 2 a))/2
      const Real edge = Real(0.5) * (p.cosine - cosine(p.angle + Real(2) * a));
      return p.tension * c.R_eff * (p.cosine * (Real(1) - H / S) + edge);  // (3)
    }
  }
  template <class Real>
  static SILT_INLINE Real range(const Coefficients<Real>& p, const Real&) {
    return p.rupture;  // (4)
  }
  static void check(const Pair& p) {
    require_not_negative("CapillaryBridge.surface_tension", p.surface_tension, "N/m");
    require(p.contact_angle >= 0 && p.contact_angle < std::numbers::pi / 2,
            "CapillaryBridge.contact_angle = ", p.contact_angle, " [rad] must be in [0, pi/2)");
    require_not_negative("CapillaryBridge.volume", p.volume, "m3");
  }
};

using CapillaryBridge = BasicCapillaryBridge<>;
static_assert(CohesionModel<CapillaryBridge>);

}  // namespace silt
