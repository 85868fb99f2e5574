// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <silt/silt.hpp>

namespace example {

/// Frequency of contacts by dissipated energy, for grinding models of mills. Four classes per
/// decade.
class ImpactSpectrum {
 public:
  /// Over 12 decades of energy [J] from this one on: 1e-15 J and less unless given.
  explicit ImpactSpectrum(int first_decade = -15) : first_decade_(first_decade) {}
  void add(const silt::ContactEvent& impact) {
    if (!(impact.lost_energy > 0)) return;
    const double place = 4 * (std::log10(impact.lost_energy) - first_decade_);
    const auto k = static_cast<std::size_t>(std::clamp(place, 0.0, classes - 1.0));
    ++count_[impact.wall != silt::no_wall][k];
    lost_ += impact.lost_energy;
  }
  double lost() const { return lost_; }  // [J]
  /// Rates per grain, of `grains` over `duration` [s].
  void write(const std::string& path, double grains, double duration) const {
    silt::CsvTable table(path, {"lost energy [J]", "between grains [1/s]", "at the drum [1/s]"});
    for (std::size_t k = 0; k < classes; ++k)
      if (count_[0][k] + count_[1][k] > 0)
        table.add_row({std::pow(10.0, first_decade_ + (static_cast<double>(k) + 0.5) / 4),
                       count_[0][k] / (grains * duration), count_[1][k] / (grains * duration)});
  }

 private:
  static constexpr std::size_t classes = 4 * 12;
  std::array<double, classes> count_[2] = {};  // between grains, at the drum
  double first_decade_;
  double lost_ = 0;
};

}  // namespace example
