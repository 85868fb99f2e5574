// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/contact/formulas.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Rules that give two unequal partners a dashpot from values of each alone, as codes have used
/// them. silt's laws do not: their dashpot follows from the pair's m* and stiffness, c = 2 zeta
/// sqrt(m* S) times a number, which keeps the restitution for any size ratio.
enum class DashpotRule {
  DashpotsInSeries,  // 1/c = 1/c1 + 1/c2 of dashpots c_i made for masses m_i
  MeanDashpot,       // c = (c1 + c2)/2
  MeanMass,          // c made for (m1 + m2)/2
  HarmonicMeanMass   // c made for 2 m1 m2/(m1 + m2)
};

/// The dashpot [-] of such a rule over the right one, c/c_right, c ~ sqrt(m), c_right ~ sqrt(m*).
/// Errors: InputError for a mass ratio that is not positive.
inline double dashpot_over_right(DashpotRule rule, double mass_ratio) {
  require_positive("mass ratio", mass_ratio, "-");
  const double m1 = 1, m2 = mass_ratio, c1 = std::sqrt(m1), c2 = std::sqrt(m2);
  double c = 0;
  switch (rule) {
    case DashpotRule::DashpotsInSeries:
      c = 1 / (1 / c1 + 1 / c2);
      break;
    case DashpotRule::MeanDashpot:
      c = (c1 + c2) / 2;
      break;
    case DashpotRule::MeanMass:
      c = std::sqrt((m1 + m2) / 2);
      break;
    case DashpotRule::HarmonicMeanMass:
      c = std::sqrt(2 * m1 * m2 / (m1 + m2));
      break;
  }
  return c / std::sqrt(effective_mass(m1, m2));
}

/// The restitution [-] that an impact of two partners really has if the zeta of a wanted one is
/// applied through such a rule: a study of its error, no part of any law. zeta'/zeta = c/c_right.
///
/// Exact for the linear spring and for Hertz' spring with the dashpot of HertzMindlin, whose motion
/// is a linear oscillator (contact/impact.hpp). 0: they do not part (end ZeroOverlap alone).
/// Errors: InputError for a restitution out of range or a mass ratio that is not positive.
/// Tests:  tests/contact/unequal_damping.cpp (numbers, and the law itself integrated).
inline double restitution_with(DashpotRule rule, double wanted, double mass_ratio, DampingEnd end) {
  return restitution_of(dashpot_over_right(rule, mass_ratio) * damping_ratio(wanted, end), end);
}

}  // namespace silt
