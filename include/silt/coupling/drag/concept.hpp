// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <numbers>

#include <silt/core/functions.hpp>
#include <silt/core/powers.hpp>

namespace silt::inline SILT_TARGET {

/// Drag law: drag of a fluid on one sphere among others, without the pressure gradient force:
///
///   F_d = K W,  K = 3 pi mu d eps Fhat(eps, Re)  [kg/s],  Re = eps rho |W| d/mu               (1)
///   beta = n K = 18 mu eps (1 - eps) Fhat/d^2    [kg/(m3 s)], n = 6 (1 - eps)/(pi d^3)        (2)
///
/// W [m/s] fluid's velocity minus the particle's, eps [-] fluid fraction, d [m] diameter (of the
/// sphere of equal volume), mu [Pa s], rho [kg/m3]. (1) is the force of model A, where -V grad p
/// also acts on the particle. In model B the drag is the whole force: K/eps, see model_b().
///
/// A law is a small struct, for example
///   struct Stokes {
///     template <class Real>
///     Real normalised(const Real& eps, const Real&) const { return Real(1) / eps; }
///   };
/// `normalised` is Fhat [-] of (1), a pure function. Real is double, float or a pack of them, one
/// lane per particle: use select(), not `if`, on values, and power() and other functions of
/// core/powers.hpp and core/functions.hpp. It must be valid for 0 < eps <= 1 and Re >= 0, and
/// finite at Re = 0. CoupledFlow refuses laws that do not work for packs at compile time
/// (core/probe.hpp).
///
/// A `void check() const` of a law with parameters is called when a coupling is made; it throws
/// InputError.
///
/// Units:  SI; eps, Re and Fhat [-]. Shapes: Real = double, float or a batch, lane = particle.
/// Errors: none.
/// Tests:  tests/coupling/drag.cpp.
template <class L>
concept DragLaw = requires(const L& law, const double& eps, const float& eps_of_float) {
  { law.normalised(eps, eps) } -> std::same_as<double>;
  { law.normalised(eps_of_float, eps_of_float) } -> std::same_as<float>;
};

namespace detail {
template <class L>
concept DragOnLanes = requires(const L& law, const ProbeLane& x) {
  { law.normalised(x, x) } -> std::same_as<ProbeLane>;
};
template <class L>
void ask_drag_on_lanes(const L& law, const ProbeLane& x) {
  law.normalised(x, x);
}
/// As laws_fit_lanes() of engine/contact/ask_on_lanes.hpp, for a drag law.
template <class L>
constexpr bool drag_fits_lanes() {
  if constexpr (DragOnLanes<L>) static_cast<void>(&ask_drag_on_lanes<L>);
  return DragOnLanes<L>;
}

/// A constant of a formula, in the precision of the lanes.
template <class Real>
constexpr Real lanes_of(double x) {
  return Real(static_cast<ScalarOf<Real>>(x));
}
/// Re limited to arguments of powers and logarithms. Every law here is within 1e-4 of its Stokes
/// limit there.
template <class Real>
inline Real guarded(const Real& Re) {
  return max(Re, lanes_of<Real>(1e-10));
}
}  // namespace detail

/// Re = eps rho |W| d/mu [-]: superficial, as in all drag laws here.
template <class Real>
inline Real slip_reynolds(const Real& eps, const Real& rho, const Real& slip, const Real& d,
                          const Real& mu) {
  return eps * rho * slip * d / mu;
}

/// K of (1) [kg/s].
template <class Law, class Real>
inline Real drag_coefficient(const Law& law, const Real& eps, const Real& Re, const Real& d,
                             const Real& mu) {
  return detail::lanes_of<Real>(3 * std::numbers::pi) * mu * d * eps * law.normalised(eps, Re);
}

/// beta of (2) [kg/(m3 s)], per volume of the mixture.
template <class Law, class Real>
inline Real interphase_coefficient(const Law& law, const Real& eps, const Real& Re, const Real& d,
                                   const Real& mu) {
  return Real(18) * mu * eps * (Real(1) - eps) * law.normalised(eps, Re) / (d * d);
}

/// K or beta of model B (including the force of the mean pressure) from those of model A.
template <class Real>
inline Real model_b(const Real& coefficient, const Real& eps) {
  return coefficient / eps;
}

/// F_d [N] of (1) for the slip W.
template <class Law, class Real>
inline Vec3<Real> drag_force(const Law& law, const Real& eps, const Real& rho, const Real& mu,
                             const Real& d, const Vec3<Real>& W) {
  const Real Re = slip_reynolds(eps, rho, sqrt(dot(W, W)), d, mu);
  return W * drag_coefficient(law, eps, Re, d, mu);
}

}  // namespace silt
