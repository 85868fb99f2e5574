// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include <silt/core/error.hpp>

/// Closed forms shared by contact laws and time step checks. Complete impacts: contact/impact.hpp.
///
/// Symbols: E* effective modulus [Pa], R* effective radius [m], m* effective mass [kg], v speed of
///          approach at first touch [m/s], k stiffness [N/m], zeta damping ratio [-],
///          e restitution [-]. A wall has infinite radius and mass and keeps its E and nu; a rigid
///          partner has infinite E.
/// Source:  K. L. Johnson, Contact Mechanics (1985), ch. 4, 7 and 11; T. Schwager, T. Poeschel,
///          Granular Matter 9 (2007) 465 (end of contact); others at their function.
/// Units:   SI.
/// Errors:  InputError for a restitution or a damping ratio out of range. Other arguments are not
///          checked here; the policies that take them from users check them.
/// Tests:   tests/contact/formulas.cpp.
namespace silt::inline SILT_TARGET {

// ---- elastic moduli and the quantities of a pair ------------------------------------------------

/// G = E / (2 (1 + nu)) [Pa]
constexpr double shear_modulus(double youngs_modulus, double poisson_ratio) {
  return youngs_modulus / (2 * (1 + poisson_ratio));
}

/// E = 2 G (1 + nu) [Pa]
constexpr double youngs_modulus(double shear_modulus, double poisson_ratio) {
  return 2 * shear_modulus * (1 + poisson_ratio);
}

/// E* [Pa] with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
constexpr double effective_modulus(double E1, double nu1, double E2, double nu2) {
  return 1 / ((1 - nu1 * nu1) / E1 + (1 - nu2 * nu2) / E2);
}

/// G* [Pa] with 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2, from Young's moduli as above
constexpr double effective_shear_modulus(double E1, double nu1, double E2, double nu2) {
  return 1 / ((2 - nu1) / shear_modulus(E1, nu1) + (2 - nu2) / shear_modulus(E2, nu2));
}

/// R* [m] with 1/R* = 1/R1 + 1/R2
constexpr double effective_radius(double R1, double R2) { return 1 / (1 / R1 + 1 / R2); }

/// m* [kg] with 1/m* = 1/m1 + 1/m2
constexpr double effective_mass(double m1, double m2) { return 1 / (1 / m1 + 1 / m2); }

// ---- damping ratio and restitution --------------------------------------------------------------

/// When a damped contact ends. With a dashpot the normal force becomes attractive before the
/// overlap is zero. `ZeroForce`: the contact ends there, and the attraction is cut. `ZeroOverlap`:
/// the attraction is kept until the overlap is zero. The same zeta gives a higher restitution with
/// `ZeroForce`, hence a restitution always refers to one of the two.
enum class DampingEnd { ZeroOverlap, ZeroForce };

namespace detail {

/// sqrt(|1 - zeta^2|), accurate near 1 and without overflow
inline double damped_frequency(double zeta) {
  return std::sqrt(std::abs(1 - zeta)) * std::sqrt(1 + zeta);
}

/// Time of the largest displacement x of x'' + 2 zeta x' + x = 0, x(0) = 0: A = acos(zeta) /
/// sqrt(1 - zeta^2), and acosh(zeta) / sqrt(zeta^2 - 1) beyond 1. The force -x'' is 0 at 2 A.
inline double time_of_largest_overlap(double zeta) {
  require_not_negative("damping ratio", zeta, "-");
  if (zeta == 1) return 1;
  return (zeta < 1 ? std::acos(zeta) : std::acosh(zeta)) / damped_frequency(zeta);
}

/// Solves 2 zeta A(zeta) = L by Newton's method in ln zeta and ln L. In these variables the left
/// side is concave. Iterates that start at zeta = L/pi, below the root, increase to it and cannot
/// pass it.
inline double damping_ratio_of_cut_contact(double L) {
  double zeta = L / std::numbers::pi;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double A = time_of_largest_overlap(zeta);
    const double h = zeta - 1;
    const double slope = std::abs(h) < 1e-3 ? -1.0 / 3 + 4.0 / 15 * h  // dA/dzeta
                                            : (1 - zeta * A) / (h * (zeta + 1));
    const double factor = std::pow(L / (2 * zeta * A), A / (A + zeta * slope));
    zeta *= factor;
    if (factor <= 1 + 2 * std::numeric_limits<double>::epsilon()) break;
  }
  return zeta;
}

}  // namespace detail

/// zeta [-] that gives restitution e in (0, 1]; relative error about 1e-15 for e > 1e-3.
///   ZeroOverlap: zeta = -ln e / sqrt(pi^2 + ln^2 e)
///   ZeroForce:   2 zeta A(zeta) = -ln e, A = acos(zeta)/sqrt(1 - zeta^2); zeta > 1 where e < e^-2
/// It holds for the linear dashpot c = 2 zeta sqrt(m* k) on a linear spring, and for the Hertz
/// spring with c = 2 sqrt(5/6) zeta sqrt(S_n m*), S_n = 2 E* sqrt(R* d). Both have the same e at
/// every speed.
/// Source: Schwager & Poeschel 2007 (linear); D. Antypov, J. A. Elliott, EPL 94 (2011) 50004.
inline double damping_ratio(double restitution, DampingEnd end) {
  require(restitution > 0 && restitution <= 1, "restitution = ", restitution,
          " [-] must be in (0, 1]");
  if (restitution == 1) return 0;
  const double L = -std::log(restitution);
  if (end == DampingEnd::ZeroForce) return detail::damping_ratio_of_cut_contact(L);
  return L / std::hypot(std::numbers::pi, L);
}

/// e [-] for a given zeta, the inverse of `damping_ratio`.
///   ZeroOverlap: e = exp(-pi zeta / sqrt(1 - zeta^2)), and 0 from zeta = 1 on (it never rebounds)
///   ZeroForce:   e = exp(-2 zeta A(zeta))
inline double restitution_of(double zeta, DampingEnd end) {
  const double A = detail::time_of_largest_overlap(zeta);
  if (end == DampingEnd::ZeroForce) return std::exp(-2 * zeta * A);
  if (zeta >= 1) return 0;
  return std::exp(-std::numbers::pi * zeta / detail::damped_frequency(zeta));
}

// ---- linear spring and dashpot ------------------------------------------------------------------

/// Contact time [s], with w0 = sqrt(k/m*): ZeroForce 2 A(zeta)/w0; ZeroOverlap pi/(w0 sqrt(1 -
/// zeta^2)), infinite from zeta = 1 on.
inline double linear_contact_time(double k, double m_eff, double zeta,
                                  DampingEnd end = DampingEnd::ZeroForce) {
  const double A = detail::time_of_largest_overlap(zeta);
  const double w0 = std::sqrt(k / m_eff);
  if (end == DampingEnd::ZeroForce) return 2 * A / w0;
  if (zeta >= 1) return std::numeric_limits<double>::infinity();
  return std::numbers::pi / (w0 * detail::damped_frequency(zeta));
}

/// Largest overlap [m]: (v/w0) exp(-zeta A(zeta)) = (v/w0) sqrt(e), e with the end ZeroForce.
inline double linear_max_overlap(double k, double m_eff, double speed, double zeta) {
  const double A = detail::time_of_largest_overlap(zeta);
  return speed * std::sqrt(m_eff / k) * std::exp(-zeta * A);
}

/// Largest force [N], dashpot included. For zeta < 1/2: v sqrt(k m*) exp(-zeta (3 acos zeta - pi) /
/// sqrt(1 - zeta^2)). For larger zeta: the dashpot force 2 zeta v sqrt(k m*) at first touch.
inline double linear_max_force(double k, double m_eff, double speed, double zeta) {
  const double A = detail::time_of_largest_overlap(zeta);
  const double share =
      zeta < 0.5 ? std::exp(-zeta * (3 * A - std::numbers::pi / detail::damped_frequency(zeta)))
                 : 2 * zeta;
  return share * speed * std::sqrt(k * m_eff);
}

/// k [N/m] of the linear spring with the same largest overlap as Hertz' law in an undamped impact
/// at `speed`:
///   k = 16/15 sqrt(R*) E* (15 m* v^2 / (16 sqrt(R*) E*))^(1/5)
inline double linear_stiffness_from_hertz(double E_eff, double R_eff, double m_eff, double speed) {
  const double k = 16.0 / 15.0 * std::sqrt(R_eff) * E_eff;
  return k * std::pow(m_eff * speed * speed / k, 0.2);
}

// ---- Hertz spring without damping, and time steps -----------------------------------------------

/// k_H [N/m^1.5] = 4/3 E* sqrt(R*), of F = k_H d^(3/2)
inline double hertz_stiffness(double E_eff, double R_eff) {
  return 4.0 / 3.0 * E_eff * std::sqrt(R_eff);
}

/// t_c v / d_max of an elastic Hertz impact [-]: 4/5 sqrt(pi) Gamma(2/5) / Gamma(9/10)
inline constexpr double hertz_time_factor = 2.9432751843247047;

/// Contact time [s] of an elastic impact: t_c = 2.943275 d_max/v, d_max = (5 m* v^2/(4 k_H))^(2/5).
/// Infinite at speed 0. With damping: contact/impact.hpp.
inline double hertz_contact_time(double E_eff, double R_eff, double m_eff, double speed) {
  const double kH = hertz_stiffness(E_eff, R_eff);
  return hertz_time_factor * std::pow(1.25 * m_eff / kH, 0.4) * std::pow(speed, -0.2);
}

/// Time [s] that a Rayleigh wave takes along half the circumference of a sphere:
///   pi R sqrt(rho/G) / (0.1631 nu + 0.8766)
/// This is a stability limit, not a time step: use 0.1 (fast flows) to 0.2 (dense, slow) of the
/// value of the smallest sphere.
/// Source: fit of the Rayleigh wave speed, error 0.4 % at most; as LIGGGHTS' fix
///         check/timestep/gran.
inline double rayleigh_time_step(double radius, double density, double shear_modulus,
                                 double poisson_ratio) {
  return std::numbers::pi * radius * std::sqrt(density / shear_modulus) /
         (0.1631 * poisson_ratio + 0.8766);
}

}  // namespace silt
