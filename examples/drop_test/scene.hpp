// silt - BSD-3-Clause, see LICENSE
#pragma once

// Material and laws of the drop test, and their predictions for one impact and for many.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

namespace drop_test {

using silt::Vec3d;
using Law = silt::HertzMindlin;

/// Grains of the synthetic material S and a steel plate, both with their real moduli.
struct Scene {
  std::vector<double> diameters{2e-3, 0.5e-3, 0.1e-3};  // [m]
  std::size_t grains = 4000;                            // of each size at each speed
  std::size_t speeds = 10;
  std::size_t seed = 1;
  double restitution = 0.7;             // [-]
  double slowest = 0.4, fastest = 2.5;  // [-] over the speed at which half of all grains break
  std::size_t again = 40;               // impacts at most of the same grain
  std::vector<double> gentle{0.5, 0.65, 0.8};  // [-] their speeds, over the same
  static constexpr double density = 2165;      // [kg/m3]
  static constexpr double dust = 0.2;      // [-] fragments below it, over a grain's size, are dust
  static constexpr std::size_t most = 60;  // fragments of a grain: some 15 are the mean

  Law::Material salt() const {
    return {
        .youngs_modulus = 20e9, .poisson_ratio = 0.25, .restitution = restitution, .friction = 0.4};
  }
  Law::Material steel() const {
    return {
        .youngs_modulus = 210e9, .poisson_ratio = 0.3, .restitution = restitution, .friction = 0.4};
  }
  double modulus() const {  // [Pa] E* of grain and plate
    return silt::effective_modulus(salt().youngs_modulus, salt().poisson_ratio,
                                   steel().youngs_modulus, steel().poisson_ratio);
  }
  double mass(double diameter) const { return density * silt::Sphere::volume(diameter / 2); }

  silt::LogLogisticStrength strength() const {
    return {.median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};
  }
  silt::HertzEquivalence equivalence() const { return {}; }
  silt::GaudinSchuhmann sizes() const {
    return {.exponent = 0.8, .coarsest = 0.9, .refining = 0.3};
  }
  silt::PowerFatigue fatigue() const { return {.kappa = 0.1, .psi = 3}; }

  /// An impact on the plate, by Hertz' formulas only.
  silt::Impact impact(double diameter, double speed) const {
    const double m = mass(diameter), R = diameter / 2;
    // From the dashpot, for contacts that the law ends at zero force: r^(3/2), r = e^(2/5).
    const double lowered = std::pow(restitution, 0.6);
    const double kH = 4.0 / 3.0 * modulus() * std::sqrt(R);  // [N/m^1.5]
    return {.diameter = diameter,
            .mass = m,
            .speed = speed,
            .m_eff = m,
            .R_eff = R,
            .elastic_force = std::pow(kH, 0.4) * std::pow(1.25 * m * speed * speed, 0.6) * lowered,
            .contact_force = NAN,
            .at_wall = true};
  }
  /// [s] contact time with the plate.
  double touching(double diameter, double speed) const {
    return silt::hertz_contact_time(modulus(), diameter / 2, mass(diameter), speed);
  }
  double load(double diameter, double speed) const {  // [N]
    return equivalence().load(impact(diameter, speed));
  }
  double selection(double diameter, double speed) const {  // [-]
    return silt::selection(strength(), equivalence(), impact(diameter, speed));
  }
  /// [m/s] at which half of all grains break: the load is proportional to the speed to the power
  /// 6/5.
  double median_speed(double diameter) const {
    return std::pow(strength().median_at(diameter) / load(diameter, 1), 1 / 1.2);
  }
};

/// Number of the impact that breaks a grain of this strength, at most `most` + 1, under the same
/// load at each impact.
inline std::size_t breaking_impact(const silt::PowerFatigue& fatigue, double strength, double load,
                                   std::size_t most) {
  std::size_t n = 1;
  for (; n <= most && load < strength; ++n) strength = fatigue.weakened(strength, load);
  return n;
}

/// Fraction of all grains [-] that are broken after 1, 2, ... `most` impacts: those weaker than the
/// strength above which one more impact is needed. Bisection finds that strength.
inline std::vector<double> broken_after(const Scene& s, double diameter, double speed,
                                        std::size_t most) {
  const double load = s.load(diameter, speed);
  std::vector<double> shares;
  for (std::size_t n = 1; n <= most; ++n) {
    double low = load, high = 1e3 * load;  // [N]
    for (int halving = 0; halving < 100; ++halving) {
      const double middle = std::sqrt(low * high);
      (breaking_impact(s.fatigue(), middle, load, most) <= n ? low : high) = middle;
    }
    shares.push_back(s.strength().weaker(n == 1 ? load : low, diameter, s.mass(diameter)));
  }
  return shares;
}

/// Quantile of chi-square with n degrees of freedom at the probability with which a normal deviate
/// exceeds z. Source: E. B. Wilson, M. M. Hilferty, PNAS 17 (1931) 684; error below 1 % for n of 10
/// and more.
inline double chi_square(double n, double z) {
  const double w = 2 / (9 * n);
  return n * std::pow(std::max(1 - w + z * std::sqrt(w), 0.0), 3);
}

}  // namespace drop_test
