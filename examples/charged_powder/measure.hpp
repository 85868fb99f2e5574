// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: charges beside their closed form, and who sticks to the plate.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "charged_powder/scene.hpp"

namespace powder {

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
