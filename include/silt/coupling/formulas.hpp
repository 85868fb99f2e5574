// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <numbers>
#include <string_view>

#include <silt/core/error.hpp>
#include <silt/coupling/drag/ergun.hpp>

/// Closed formulas for beds and single particles in a fluid, for any drag law.
///
/// Symbols: d [m] diameter, rho_p and rho [kg/m3] of particle and fluid, mu [Pa s], g [m/s2]
/// gravity, eps [-] fluid fraction, U [m/s] superficial velocity: volume flow per total area.
/// Units:   SI.
/// Errors:  InputError naming the argument, its value, unit and range.
/// Tests:   tests/coupling/formulas.cpp.
namespace silt::inline SILT_TARGET {

namespace detail {
inline void check_sphere_in_fluid(std::string_view where, double d, double rho_p, double rho,
                                  double mu, double g) {
  require_positive(text(where, ": diameter d"), d, "m");
  require_positive(text(where, ": particle density rho_p"), rho_p, "kg/m3");
  require_positive(text(where, ": fluid density rho"), rho, "kg/m3");
  require_positive(text(where, ": viscosity mu"), mu, "Pa s");
  require_positive(text(where, ": gravity g"), g, "m/s2");
}
/// A law of void fraction and Reynolds number alone.
template <class Law>
constexpr void need_plain_law() {
  static_assert(
      requires(const Law& law, double eps) {
        { law.normalised(eps, eps) } -> std::convertible_to<double>;
      },
      "the formulas of coupling/formulas.hpp take a drag law of void fraction and Reynolds number, "
      "`Real normalised(const Real& eps, const Real& Re) const`; one of silt::InFluid depends on "
      "the "
      "particle as well (silt/coupling/drag/concept.hpp)");
}
inline void check_fluid_fraction(std::string_view where, double eps) {
  require(eps > 0 && eps <= 1, where, ": fluid fraction eps = ", eps, " [-] must be in (0, 1]");
}
}  // namespace detail

/// Ar = g d^3 rho |rho_p - rho|/mu^2 [-].
inline double archimedes_number(double d, double rho_p, double rho, double mu, double g = 9.81) {
  detail::check_sphere_in_fluid("archimedes_number", d, rho_p, rho, mu, g);
  return g * d * d * d * rho * std::abs(rho_p - rho) / (mu * mu);
}

/// Re = rho U d/mu [-] at which drag and pressure balance weight minus buoyancy:
///   18 Re Fhat(eps, Re) = eps Ar
/// That is F_d/eps = V |rho_p - rho| g with Fhat of drag/concept.hpp. Accurate to the last digits;
/// the smallest Re where the force is reached, if the law jumps over it.
template <class Law>
double balance_reynolds(const Law& law, double eps, double Ar) {
  detail::need_plain_law<Law>();
  detail::check_fluid_fraction("balance_reynolds", eps);
  require_not_negative("balance_reynolds: Archimedes number Ar", Ar, "-");
  const auto carried = [&](double Re) { return 18 * Re * law.normalised(eps, Re) >= eps * Ar; };
  if (Ar == 0) return 0;
  double low = 0, high = 1;
  while (!carried(high)) {
    low = high, high *= 4;
    require(high < 1e30, "balance_reynolds: the drag law carries no weight at eps = ", eps,
            " [-]; its Fhat must not fall as fast as 1/Re");
  }
  if (low == 0)
    for (low = 0.25; carried(low) && low > 1e-300; low *= 0.25) high = low;
  for (double middle = 0.5 * (low + high); low < middle && middle < high;
       middle = 0.5 * (low + high))
    (carried(middle) ? high : low) = middle;
  return high;
}

/// Terminal velocity [m/s] of a single sphere, downwards, or upwards if it is lighter.
template <class Law>
double terminal_velocity(const Law& law, double d, double rho_p, double rho, double mu,
                         double g = 9.81) {
  detail::check_sphere_in_fluid("terminal_velocity", d, rho_p, rho, mu, g);
  return balance_reynolds(law, 1, archimedes_number(d, rho_p, rho, mu, g)) * mu / (rho * d);
}

/// Superficial velocity [m/s] that just carries a bed of fluid fraction eps. It is also the flux
/// eps |W| of a settling suspension.
template <class Law>
double minimum_fluidisation_velocity(const Law& law, double eps, double d, double rho_p, double rho,
                                     double mu, double g = 9.81) {
  detail::check_sphere_in_fluid("minimum_fluidisation_velocity", d, rho_p, rho, mu, g);
  return balance_reynolds(law, eps, archimedes_number(d, rho_p, rho, mu, g)) * mu / (rho * d);
}

/// The same with Ergun's law in closed form: the root of A Re^2 + B Re = Ar with
///   A = 1.75/eps^3, B = 150 (1 - eps)/eps^3; eps = 0.4: 27.34 Re^2 + 1406.25 Re = Ar
inline double ergun_fluidisation_reynolds(double eps, double Ar) {
  detail::check_fluid_fraction("ergun_fluidisation_reynolds", eps);
  require_not_negative("ergun_fluidisation_reynolds: Archimedes number Ar", Ar, "-");
  const double e3 = eps * eps * eps, A = 1.75 / e3, B = 150 * (1 - eps) / e3;
  const double root = std::sqrt(B * B + 4 * A * Ar);
  return Ar == 0 ? 0 : 2 * Ar / (B + root);
}

/// Pressure gradient [Pa/m] of a bed with the superficial velocity U, without the hydrostatic one:
/// number of particles times F_d/eps,
///   18 mu (1 - eps) U Fhat(eps, rho U d/mu)/(eps d^2)
template <class Law>
double bed_pressure_gradient(const Law& law, double eps, double d, double rho, double mu,
                             double U) {
  detail::need_plain_law<Law>();
  detail::check_sphere_in_fluid("bed_pressure_gradient", d, 1, rho, mu, 1);
  detail::check_fluid_fraction("bed_pressure_gradient", eps);
  require_not_negative("bed_pressure_gradient: superficial velocity U", U, "m/s");
  return 18 * mu * (1 - eps) * U * law.normalised(eps, rho * U * d / mu) / (eps * d * d);
}

/// Ergun's: 150 mu (1 - eps)^2 U/(eps^3 d^2) + 1.75 rho (1 - eps) U^2/(eps^3 d) [Pa/m].
inline double ergun_pressure_gradient(double eps, double d, double rho, double mu, double U) {
  return bed_pressure_gradient(Ergun(), eps, d, rho, mu, U);
}

}  // namespace silt
