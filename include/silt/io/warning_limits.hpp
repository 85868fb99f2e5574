// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Thresholds of warnings (scene_warnings.hpp, run_warnings.hpp, break_warnings.hpp) and their
/// reasons.
struct WarningLimits {
  /// Simulations of the throw or impact of fewer particles need no walls.
  static constexpr std::size_t few = 10;  // [-]
  /// Without a fluid. Most solids have a density of 1 to 10 in g/cm3 and more than 10 in kg/m3. The
  /// lightest in use are foams such as expanded polystyrene, some 10 kg/m3 (recalled).
  static constexpr double lightest_solid = 10;  // [kg/m3]
  /// In a fluid, bubbles can be as light as gases: hydrogen at 0.1 bar and 20 C has 0.008 kg/m3
  /// (computed, ideal gas).
  static constexpr double lightest_bubble = 1e-3;  // [kg/m3]
  /// Diameter of grains of 2 mm whose radius is given as 1. Boulders of 1 m are below.
  static constexpr double largest_grain = 2;  // [m]
  /// Earth's gravity, also rounded to 10. In mm/s2 it is a thousand times larger, above that of
  /// centrifuges of some hundred g.
  static constexpr double least_g = 9.7, most_g = 10.1;  // [m/s2]
  /// Only cryogenics are colder, and everyday temperatures in degrees Celsius are below.
  static constexpr double coldest = 100;  // [K]
  /// Distance of an outlet in units of the size of the scene and the width of a throw.
  static constexpr double far_off = 100;  // [-]
  /// Share of the due particles of an inlet that wait.
  static constexpr double waiting_share = 0.1;  // [-]
  /// A contact that a particle's own motion or weight makes is seldom deeper than 1 %. One of 5 %
  /// in a stiff material throws particles apart at metres per second.
  static constexpr double start_overlap = 0.05;  // [-] of the smaller radius
  /// Strengths of one size scatter by a factor of some 2 to each side. If all loads are below a
  /// tenth of any strength, the scene cannot be meant to break particles.
  static constexpr double far_from_breaking = 0.1;  // [-] of the strength
  /// A particle hit at ten times the speed that breaks it has a load of 16 strengths as a force,
  /// 100 as an energy. If most breakages have more, strengths are in other units.
  static constexpr double far_above_breaking = 100;  // [-] of the strength
  /// Dry solids have 0.1 to 1, rubber on rough ground less than 2 (recalled). Calibrated values of
  /// rough grains may be somewhat larger.
  static constexpr double most_friction = 3;  // [-]
  /// Values calibrated for grains that are no spheres are below 1, mostly below 0.5 (recalled).
  static constexpr double most_rolling_friction = 2;  // [-]
  /// Soft gels have some 1e3 Pa (recalled), and simulations that soften take 1e5 to 1e8. Of steel
  /// in GPa the number is 210, of polymers 2. Diamond has 1.2e12 Pa (recalled), the stiffest solid.
  static constexpr double softest = 500, stiffest = 2e12;  // [Pa]
  /// A mesh whose file is in mm, read without a scale, around particles that fill half of it or
  /// less.
  static constexpr double largest_mesh = 500;  // [-] of the size of all particles and inlets
  /// An outlet that takes a part of a bed at its start seldom takes most of it.
  static constexpr double emptied_at_start = 0.5;  // [-] of the particles
};

namespace detail {

/// Three significant digits.
[[gnu::cold]] inline std::string about(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", value);
  return digits;
}

}  // namespace detail
}  // namespace silt
