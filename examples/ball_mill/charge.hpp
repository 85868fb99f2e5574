// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <silt/core/error.hpp>

/// The laboratory ball mill of B. Doroszek et al., Minerals 14 (2024) 407: three drums, their balls
/// and speeds.
namespace ball_mill {

/// One of the drums, with its measured values.
struct Mill {
  const char* name;         // its outer diameter [mm]
  double radius;            // [m] inner
  double least;             // [m] diameter of the smallest balls
  double angle, angle_dry;  // [degrees] of repose in the recordings: balls alone; with dry ore
};
inline constexpr std::array<Mill, 3> mills{{{"300", 0.146, 0.015, 43.25, 54.24},
                                            {"400", 0.196, 0.020, 42.15, 41.97},
                                            {"500", 0.246, 0.025, 40.35, 47.67}}};

inline const Mill& mill(const std::string& name) {
  for (const Mill& m : mills)
    if (name == m.name) return m;
  throw silt::InputError(silt::text("ball_mill: case '", name, "' is none of 300, 400, 500"));
}

inline constexpr double gravity = 9.81;           // [m/s2]
inline constexpr double make_up = 0.035;          // [m] diameter B of the balls that are added
inline constexpr double between = 0.005;          // [m] from one size to the next
inline constexpr double steel_density = 7800.92;  // [kg/m3]
inline constexpr double filling = 0.30;           // [-] volume of solid steel in that of the drum
inline constexpr double speed = 0.30;             // [-] of the critical one

struct BallClass {
  double diameter;    // [m]
  double mass_share;  // [-]
};

/// Bond's equilibrium charge: balls up to the size x are the mass fraction y = (x/B)^3.8. Balls of
/// one size represent the interval from the next smaller size to their own; the smallest represents
/// all below.
/// Source: the paper, section 3.5, after F. C. Bond, Crushing and grinding calculations (1961),
///         which was not read. The intervals are not stated there; with these the speeds are those
///         printed.
inline std::vector<BallClass> bond_classes(double least, double step = between,
                                           double largest = make_up) {
  silt::require(least > 0 && step > 0 && largest >= least, "bond_classes: from ", least, " to ",
                largest, " m in steps of ", step, " m must be sizes that grow");
  std::vector<BallClass> out;
  double below = 0;
  const auto count = static_cast<int>(std::lround((largest - least) / step));
  for (int k = 0; k <= count; ++k) {
    const double size = least + k * step, finer = std::pow(size / largest, 3.8);
    out.push_back({size, finer - below}), below = finer;
  }
  return out;
}

/// [m] weighted with the mass.
inline double mean_diameter(const std::vector<BallClass>& classes) {
  double sum = 0, mass = 0;
  for (const BallClass& c : classes) sum += c.mass_share * c.diameter, mass += c.mass_share;
  return sum / mass;
}

/// [1/min] critical speed: that at which a ball of `ball` [m] radius at the shell of a drum of
/// `drum` [m] radius is weightless at the top: 60/(2 pi) sqrt(g/(R - r)).
inline double critical_speed(double drum, double ball) {
  return 60 / (2 * std::numbers::pi) * std::sqrt(gravity / (drum - ball));
}

/// [1/min] of a drum: 30 % of the critical speed of the mean ball.
inline double turns_a_minute(const Mill& m) {
  return speed * critical_speed(m.radius, 0.5 * mean_diameter(bond_classes(m.least)));
}

/// Whole numbers of balls of each class for a drum of `length` [m].
inline std::vector<std::size_t> ball_counts(const Mill& m, double length, double share = filling) {
  const double steel = share * std::numbers::pi * m.radius * m.radius * length;  // [m3]
  std::vector<std::size_t> out;
  for (const BallClass& c : bond_classes(m.least))
    out.push_back(static_cast<std::size_t>(
        std::lround(steel * c.mass_share / (std::numbers::pi / 6 * std::pow(c.diameter, 3)))));
  return out;
}

}  // namespace ball_mill
