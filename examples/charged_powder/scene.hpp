// silt - BSD-3-Clause, see LICENSE
#pragma once

// The scene of the charged powder, closed forms for its grains, and records of charges and of the
// grains that stick.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>

namespace powder {

using silt::Charge, silt::TriboCharge, silt::ElectricCharge;
using Law = silt::HertzMindlin;

struct Scene {
  std::size_t particles = 500;
  double r_min = 40e-6, r_max = 110e-6;  // [m]
  double shaken = 3;                     // [s]
  double frequency = 300, speed = 0.06;  // [Hz], [m/s] the largest of the plate
  double voltage = 0.4;                  // [V] difference of work functions over e
  double area_factor = 1;                // [-]
  double friction = 0.4;                 // [-]
  static constexpr double density = 1500, g = 9.81, delta = 5e-7;  // [kg/m3], [m/s2], [m]
  static constexpr double rest = 0.2, falling = 0.05;              // [s] after shaking

  double side() const {  // [m] of the plate: grains cover a third of it
    const double squares = (std::pow(r_max, 3) - std::pow(r_min, 3)) / (3 * (r_max - r_min));
    return std::sqrt(static_cast<double>(particles) * std::numbers::pi * squares / 0.33);
  }
  Law::Material powder() const {
    return {.youngs_modulus = 3e5, .poisson_ratio = 0.3, .restitution = 0.7, .friction = friction};
  }
  Law::Material metal() const {
    return {.youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.7, .friction = friction};
  }
  /// For a grain on the plate: the charge at which transfer stops [C]; the fractions of it whose
  /// image force equals the weight.
  double saturation(double radius) const {
    return 2 * std::numbers::pi * Charge::eps0 * radius * radius * voltage / delta;
  }
  double image_over_weight(double radius, double charge) const {
    const double weight = density * silt::Sphere::volume(radius) * g;
    return charge * charge / (16 * std::numbers::pi * Charge::eps0 * radius * radius) / weight;
  }
  /// Distance [m] at which the image force of a grain with this fraction of its saturation charge
  /// equals its weight.
  double radius_at_limit(double share) const {
    return 3 * Charge::eps0 * std::pow(voltage * share / delta, 2) / (16 * density * g);
  }
  double early() const { return 0.15 * shaken; }  // [s] when a picture is taken
  /// Effect of n impacts that press a grain into the plate by `overlap` [m]: 1/n0 of the
  /// exponential.
  double charging(double radius, double approach) const {
    const Law::Material a = powder(), b = metal();
    const double overlap =
        silt::hertz_max_overlap({silt::effective_modulus(a.youngs_modulus, a.poisson_ratio,
                                                         b.youngs_modulus, b.poisson_ratio),
                                 radius, density * silt::Sphere::volume(radius), approach,
                                 silt::damping_ratio(a.restitution, silt::DampingEnd::ZeroForce)});
    return area_factor * overlap / (2 * radius);
  }
};

/// Charges, and the closed form of each grain: q_inf (1 - exp(-sum of 1/n0 over its impacts)).
struct Charges {
  const Scene& s;
  std::vector<double> impacts;                   // [-] that sum, of each id
  double sum = 0, saturation = 0, expected = 0;  // [C] of all grains, at the last look
  double given = 0;                              // [C] by the plate
  double off = 0, most = 0;                      // [-] largest so far, over saturation

  explicit Charges(const Scene& scene) : s(scene), impacts(scene.particles, 0.0) {}
  template <class Sim>
  void look(const Sim& sim) {
    sum = saturation = expected = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      const double q = sim.template field<ElectricCharge>(k), full = s.saturation(sim.radius(k));
      sum += q, saturation += full, expected += full * (1 - std::exp(-impacts[sim.id(k)]));
      most = std::max(most, q / full);
    }
    given = sim.template given_by_wall<TriboCharge>("plate").sum;
    off = std::max(off, std::abs(sum - expected) / saturation);
  }
};

/// Number of grains of each size that stick to the inverted plate, and whether these are the right
/// ones.
struct Sticking {
  static constexpr std::size_t classes = 14;
  std::array<double, classes> stick{}, held{}, all{};
  double sum = 0, judged = 0, wrong = 0;

  /// `hold` [-]: image force over weight; within 10 % of 1 a grain is not judged.
  void add(const Scene& s, double radius, double hold, bool sticks) {
    const double place = (radius - s.r_min) / (s.r_max - s.r_min) * classes;
    const auto c = std::min(static_cast<std::size_t>(place), classes - 1);
    all[c] += 1, stick[c] += sticks, held[c] += hold > 1, sum += sticks;
    if (std::abs(hold - 1) > 0.1) judged += 1, wrong += sticks != (hold > 1);
  }
  void write(const Scene& s, const std::string& path) const {
    silt::CsvTable table(path,
                         {"radius [um]", "by their own image [%]", "that stick [%]", "grains"});
    for (std::size_t c = 0; c < classes; ++c)
      if (const double middle = (static_cast<double>(c) + 0.5) / classes; all[c] > 0)
        table.add_row({1e6 * (s.r_min + middle * (s.r_max - s.r_min)), 100 * held[c] / all[c],
                       100 * stick[c] / all[c], all[c]});
  }
};

}  // namespace powder
