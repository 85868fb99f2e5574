// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <numbers>

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Resistance to twisting about the contact normal: elastic until the contact area slides.
///
///   M <- M - k_w w_n dt, |M| <= M_m = 3 pi/16 mu_w a F_n, a = sqrt(R* d), k_w = S_n a^2       (1)
///   M_d = -2 eta sqrt(I k_w) w_n, |M + M_d| <= M_m, I = (1/I_i + 1/I_j)^-1                     (2)
///
/// M_m is the torque of Coulomb friction under Hertz pressure if mu_w is the friction of the
/// surfaces. When k_w falls, M is reduced in proportion; no energy is created.
///
/// Source: J. L. Lubkin, J. Appl. Mech. 18 (1951) 183 (M_m); E. Reissner, H. F. Sagoci, J. Appl.
///         Phys. 15 (1944) 652: 16/3 G a^3 for one body, thus 4/3 (1 - nu) S_n a^2 for two equal
///         bodies. This is (1) at nu = 1/4, and within a third of it at all nu.
/// Valid:  spheres; a is Hertz' contact radius for every contact law.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: 1 Real [N m].
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/rolling_models.cpp, tests/physics/rolling_models.cpp.
struct Twisting {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double twisting_friction = 0;  // [-] mu_w >= 0
    double damping = 0.3;          // [-] eta >= 0, share of the critical damping
  };
  template <class Real>
  struct Coefficients {
    Real limit;          // [-] 3 pi/16 mu_w
    Real twice_damping;  // [-]
  };
  template <class Real>
  struct History {
    Real torque;  // [N m] spring part, on i about the normal
  };
  static Coefficients<double> mix(const Pair& p) {
    return {3 * std::numbers::pi / 16 * p.twisting_friction, 2 * p.damping};
  }
  template <class Real>
  static SILT_INLINE Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p,
                                       History<Real>& h) {
    const Real a2 = c.R_eff * max(c.overlap, Real(0)), kw = c.normal_stiffness * a2;
    const Real limit = p.limit * sqrt(a2) * c.normal_force;
    const Real trial = c.unloading * c.shrinking * h.torque - kw * c.time_step * c.twist;
    h.torque = max(min(trial, limit), -limit);  // (1)
    const Real damping = p.twice_damping * sqrt(c.share_of_rolling * c.inertia_eff * kw);
    return max(min(h.torque - damping * c.twist, limit), -limit) * c.normal;  // (2)
  }
  template <class Real>
  static SILT_INLINE Real stored(const RollingContact<Real>& c, const Coefficients<Real>&,
                                 const History<Real>& h) {
    const Real kw = c.normal_stiffness * c.R_eff * max(c.overlap, Real(0));
    return h.torque * h.torque / max(Real(2) * kw, smallest<Real>());
  }
  static void check(const Pair& p) {
    require_not_negative("Twisting.twisting_friction", p.twisting_friction, "-");
    require_not_negative("Twisting.damping", p.damping, "-");
  }
};

/// Two rolling models together, usually one for rolling and one for twisting:
///   silt::Contacts<silt::HertzMindlin, silt::Both<silt::RollingEpsd, silt::Twisting>> contacts{
///       glass, {{.rolling_friction = 0.1}, {.twisting_friction = 0.4}}};
///
/// Source: none: the couples of both models are added.
/// Valid:  as both models.
/// Units:  SI. History: those of both.
/// Errors: those of both models; RollingOwn is refused at compile time.
/// Tests:  tests/contact/rolling_models.cpp, tests/physics/rolling_models.cpp.
template <class First, class Second>
struct Both {
  static_assert(RollingModel<First> && RollingModel<Second>,
                "Both<First, Second>: both must be RollingModels; the contract is in "
                "silt/contact/concept.hpp");
  static_assert(!detail::of_own_rotation<First> && !detail::of_own_rotation<Second>,
                "Both<First, Second>: RollingOwn cannot be combined with another model");
  static constexpr bool is_rolling_model = true;
  struct Pair {
    typename First::Pair first;
    typename Second::Pair second;
  };
  template <class Real>
  struct Coefficients {
    typename First::template Coefficients<Real> first;
    typename Second::template Coefficients<Real> second;
  };

 private:
  template <class Real, int>
  struct None {};
  template <class Model, class Real, int Place>
  using Kept = std::conditional_t<detail::HasHistory<Model>,
                                  typename detail::HistoryOf<Model, Real>::type, None<Real, Place>>;
  template <class Real, int Place, class Base>
  struct Part : Base {};

 public:
  template <class Real>
  struct History : Part<Real, 1, Kept<First, Real, 1>>, Part<Real, 2, Kept<Second, Real, 2>> {};

  static Coefficients<double> mix(const Pair& p) {
    return {First::mix(p.first), Second::mix(p.second)};
  }
  template <class Real>
  static SILT_INLINE Vec3<Real> torque(const RollingContact<Real>& c, const Coefficients<Real>& p,
                                       History<Real>& h) {
    return of<First>(c, p.first, static_cast<Part<Real, 1, Kept<First, Real, 1>>&>(h)) +
           of<Second>(c, p.second, static_cast<Part<Real, 2, Kept<Second, Real, 2>>&>(h));
  }
  template <class Real>
  static SILT_INLINE Real stored(const RollingContact<Real>& c, const Coefficients<Real>& p,
                                 const History<Real>& h) {
    return in<First>(c, p.first, static_cast<const Part<Real, 1, Kept<First, Real, 1>>&>(h)) +
           in<Second>(c, p.second, static_cast<const Part<Real, 2, Kept<Second, Real, 2>>&>(h));
  }
  static void check(const Pair& p) {
    detail::check_rolling<First>(p.first), detail::check_rolling<Second>(p.second);
  }

 private:
  template <class Model, class Real, class Coefficients, class History>
  static SILT_INLINE Vec3<Real> of(const RollingContact<Real>& c, const Coefficients& p,
                                   History& h) {
    if constexpr (detail::HasHistory<Model>)
      return Model::torque(c, p, h);
    else
      return Model::torque(c, p);
  }
  template <class Model, class Real, class Coefficients, class History>
  static SILT_INLINE Real in(const RollingContact<Real>& c, const Coefficients& p,
                             const History& h) {
    if constexpr (requires { Model::stored(c, p, h); })
      return Model::stored(c, p, h);
    else
      return Real(0);
  }
};

static_assert(RollingModel<Twisting>);

}  // namespace silt
