// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Adhesion of two elastic spheres by the theory of Johnson, Kendall and Roberts (JKR), in closed
/// form.
///
///   d = a^2/R* - sqrt(2 pi w a/E*),  F = 4 E* a^3/(3 R*) - sqrt(8 pi w E* a^3)                (1)
///
/// With A = sqrt(a) and c = sqrt(2 pi w/E*): A^4 - R* c A = R* d, F = 2 E* A^3 (2 A^3/(3 R*) - c).
/// The overlap has its minimum d_t at A_t = (R* c/4)^(1/3). Bodies that are pulled apart separate
/// there.
///
/// Symbols: a contact radius [m], d overlap [m], F force [N] > 0 repulsive, w work of adhesion
/// [J/m2].
/// Source:  K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301; C. Thornton,
///          Z. Ning, Powder Technol. 99 (1998) 154 (energy); D. Tabor, J. Colloid Interface Sci. 58
///          (1977) 2.
/// Valid:   tabor_parameter > 5; a well below the radius.
/// Units:   SI. Errors: InputError naming field, value, unit and allowed range.
/// Tests:   tests/contact/jkr.cpp.
struct AdhesivePair {
  double E_eff;             // [Pa] > 0
  double R_eff;             // [m] > 0
  double work_of_adhesion;  // [J/m2] w >= 0
};

inline void check(const AdhesivePair& pair) {
  require_positive("AdhesivePair.E_eff", pair.E_eff, "Pa");
  require_positive("AdhesivePair.R_eff", pair.R_eff, "m");
  require_not_negative("AdhesivePair.work_of_adhesion", pair.work_of_adhesion, "J/m2");
}

/// Tabor parameter (R* w^2/(E*^2 z0^3))^(1/3) [-]. z0 [m] is the equilibrium distance of the
/// surface atoms, about 0.3 nm. DMT theory holds below 0.1, JKR above 5.
inline double tabor_parameter(const AdhesivePair& pair, double z0) {
  check(pair);
  require_positive("tabor_parameter: z0", z0, "m");
  const double ratio = pair.work_of_adhesion / pair.E_eff;
  return std::cbrt(pair.R_eff * ratio * ratio) / z0;
}

/// Pull-off force [N]: 3/2 pi w R* (JKR), 2 pi w R* (DMT).
inline double jkr_pull_off(const AdhesivePair& pair) {
  check(pair);
  return 1.5 * std::numbers::pi * pair.work_of_adhesion * pair.R_eff;
}
/// Pull-off force [N] of stiff spheres (DMT): 2 pi w R*.
inline double dmt_pull_off(const AdhesivePair& pair) { return 4.0 / 3.0 * jkr_pull_off(pair); }

/// Overlap [m] <= 0 at which bodies that are pulled apart separate: -3/4 (pi^2 w^2 R*/E*^2)^(1/3).
/// The tensile force there is 5/9 of jkr_pull_off.
inline double jkr_overlap_at_parting(const AdhesivePair& pair) {
  check(pair);
  const double ratio = std::numbers::pi * pair.work_of_adhesion / pair.E_eff;
  return -0.75 * std::cbrt(ratio * ratio * pair.R_eff);
}

/// Contact radius [m] without load: (9 pi w R*^2/(2 E*))^(1/3). The overlap there is a^2/(3 R*).
inline double jkr_radius_at_rest(const AdhesivePair& pair) {
  check(pair);
  return std::cbrt(4.5 * std::numbers::pi * pair.work_of_adhesion * pair.R_eff * pair.R_eff /
                   pair.E_eff);
}
/// Overlap [m] without load: that at which the force of a JKR contact is 0.
inline double jkr_overlap_at_rest(const AdhesivePair& pair) {
  const double a = jkr_radius_at_rest(pair);
  return a * a / (3 * pair.R_eff);
}

/// Force [N] at a given contact radius [m], equation (1).
inline double jkr_force(const AdhesivePair& pair, double contact_radius) {
  check(pair);
  const double a3 = contact_radius * contact_radius * contact_radius;
  return 4 * pair.E_eff * a3 / (3 * pair.R_eff) -
         std::sqrt(8 * std::numbers::pi * pair.work_of_adhesion * pair.E_eff * a3);
}

/// Energy [J] lost when bodies attach at d = 0 and separate at d_t: the integral of -F from d_t to
/// 0, (3/10 + 4^(-1/3)/20) (2 pi)^(5/3) (w^5 R*^4/E*^2)^(1/3) = 7.092 (...)^(1/3).
inline double jkr_energy_loss(const AdhesivePair& pair) {
  check(pair);
  const double share = 0.3 + std::cbrt(0.25) / 20;
  const double L = std::cbrt(2 * std::numbers::pi * pair.work_of_adhesion * pair.R_eff *
                             pair.R_eff / pair.E_eff);  // [m]
  const double ratio = L * L / pair.R_eff;
  return share * pair.E_eff * ratio * ratio * L;
}

/// Sticking speed v_s [m/s]: slower impacts do not rebound. v_s = sqrt(2 jkr_energy_loss/m*),
/// without other losses. Faster impacts have the restitution sqrt(1 - (v_s/v)^2).
inline double jkr_sticking_speed(const AdhesivePair& pair, double m_eff) {
  require_positive("jkr_sticking_speed: m_eff", m_eff, "kg");
  return std::sqrt(2 * jkr_energy_loss(pair) / m_eff);
}

}  // namespace silt
