// silt - BSD-3-Clause, see LICENSE
#pragma once

// The drop test's scene: grains that break and a plate of steel, their material and laws, and what
// one impact should do by them.
//
//   drop_test::Scene s;
//   auto sim = drop_test::make_simulation(s, 2e-3, 5, 1e-4, 1);  // [m], [m/s], [m] above the plate
//   sim.run(1e-4, silt::breakage_table("breakage.csv", silt::every(1e-6)));

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
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

/// Grains side by side above the plate, far apart, each at the height `gap` [m] and moving down;
/// their ids are 0, 1, ... No gravity: all hit the plate at the same speed.
inline auto make_simulation(const Scene& s, double diameter, double speed, double gap,
                            std::uint64_t seed) {
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{s.salt(), s.steel()}};
  contacts.set_pair(s.salt(), s.steel(), {.restitution = s.restitution, .friction = 0.4});
  silt::Particles<silt::Sphere> grains;
  const auto row = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(s.grains))));
  for (std::size_t k = 0; k < s.grains; ++k)
    grains.add({.position = {3 * diameter * static_cast<double>(k % row),
                             3 * diameter * static_cast<double>(k / row), diameter / 2 + gap},
                .radius = diameter / 2,
                .density = Scene::density,
                .velocity = {0, 0, -speed}});
  silt::Simulation sim{
      std::move(grains), contacts,
      silt::Breakage{
          s.strength(),
          s.equivalence(),
          s.sizes(),
          s.fatigue(),
          {.dust_below = Scene::dust * diameter, .most_fragments = Scene::most, .seed = seed}},
      silt::EnergyLedger{}};
  sim.gravity = {0, 0, 0};
  // Small fragments between the plate and a large one have larger overlaps than alone.
  sim.guard.max_overlap = 0.6;
  sim.time_step = s.touching(Scene::dust * diameter, speed) / 40;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.steel(), {.name = "plate"});
  return sim;
}

}  // namespace drop_test
