// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <silt/eigen.hpp>

namespace example {

/// The bed of a drum seen along its axis y: solid fraction in columns and layers, averaged over the
/// added samples.
class Occupancy {
 public:
  static constexpr int cells = 12;  // over a radius

  Occupancy(double radius, double length)  // [m] of the drum
      : radius_(radius), cell_(radius / cells), volume_(cell_ * cell_ * length) {}

  void next_sample() { ++samples_; }
  /// A grain at x and z [m] from the axis; its whole volume [m3] is counted at its centre.
  void add_grain(double x, double z, double volume) { solid_[cell_at(x)][cell_at(z)] += volume; }

  /// Height [m] of the surface over column k: where the solid fraction falls below half of the
  /// bed's; NaN if nowhere.
  double surface(int k) const {
    const double full = 0.5 * 0.6 * volume_ * static_cast<double>(samples_);
    for (int m = 2 * cells - 1; m >= 0; --m) {
      const double here = solid_[k][m];
      if (here < full) continue;
      const double above = m + 1 < 2 * cells ? solid_[k][m + 1] : 0;
      return -radius_ + (m + 0.5 + (here - full) / std::max(here - above, 1e-300)) * cell_;
    }
    return std::nan("");
  }
  double place(int k) const { return -radius_ + (k + 0.5) * cell_; }  // [m]

  /// Slope [degrees] of the middle of the surface: columns within half of the drum's radius.
  double angle() const {
    std::vector<double> places, heights;  // [m]
    for (int k = 0; k < 2 * cells; ++k)
      if (std::abs(place(k)) <= 0.5 * radius_ && std::isfinite(surface(k)))
        places.push_back(place(k)), heights.push_back(surface(k));
    if (places.size() < 3) return std::nan("");
    const double slope = silt::fit_straight_line(places, heights).slope;
    return std::abs(std::atan(slope)) * 180 / std::numbers::pi;
  }

 private:
  int cell_at(double x) const {
    return std::clamp(static_cast<int>((x + radius_) / cell_), 0, 2 * cells - 1);
  }

  double radius_, cell_, volume_;
  std::size_t samples_ = 0;
  std::array<std::array<double, 2 * cells>, 2 * cells> solid_{};
};

}  // namespace example
