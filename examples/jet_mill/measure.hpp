// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured in the mill: the mean flow and its swirl, the fastest grains and gas, the
// balance of mass, sizes of grains and dust.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "jet_mill/scene.hpp"

namespace jet_mill {

/// Sizes [m] d10, d50 and d90 by mass of a table; NaN while it is empty.
inline std::array<double, 3> quantiles(const silt::SizeTable& sizes) {
  if (!(sizes.mass() > 0)) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    return {none, none, none};
  }
  return {sizes.quantile(0.1), sizes.quantile(0.5), sizes.quantile(0.9)};
}

/// Looks at equal times; means are of the second half of the run.
class Watch {
 public:
  explicit Watch(const Scene& s) : s_(s) {}
  double interval() const { return s_.duration / 150; }  // [s] between looks

  template <class Sim>
  void look(const Sim& sim) {
    const auto m = sim.mass_balance();
    if (m.fed > 0) worst_mass_ = std::max(worst_mass_, std::abs(m.residual()) / m.fed);
    most_grains_ = std::max(most_grains_, static_cast<double>(sim.size()));
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) fastest_grain_ = std::max(fastest_grain_, norm(sim.velocity(k)));
    look_at_gas(sim.fluid().flow());
    if (sim.time() < 0.5 * s_.duration) return;
    mean_.add(sim.fluid().flow(), interval());
    add_swirl(sim.fluid().flow());
  }
  double worst_mass() const { return worst_mass_; }        // [-] unexplained, over what was fed
  double most_grains() const { return most_grains_; }      // at a time
  double fastest_grain() const { return fastest_grain_; }  // [m/s]
  double fastest_gas() const { return fastest_gas_; }      // [m/s] in one direction
  double swirl() const { return swirl_ / std::max(samples_, 1.0); }  // [m/s] at half the radius
  const silt::FlowMean& mean() const { return mean_; }

 private:
  void look_at_gas(const silt::FlowSolver& flow) {
    const auto& grid = flow.grid();
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i)
          for (int d = 0; d < 3; ++d)
            fastest_gas_ = std::max(fastest_gas_, std::abs(flow.velocity(d)(i, j, k)));
  }
  void add_swirl(const silt::FlowSolver& flow) {
    for (int k = 0; k < 32; ++k) {
      const double angle = 2 * std::numbers::pi * k / 32, r = 0.5 * s_.radius;
      const Vec3d x{r * std::cos(angle), r * std::sin(angle), 0.5 * s_.height};
      const Vec3d v = silt::flow_at(flow, x).velocity;
      swirl_ += v.y * std::cos(angle) - v.x * std::sin(angle), samples_ += 1;
    }
  }

  const Scene& s_;
  silt::FlowMean mean_;
  double worst_mass_ = 0, most_grains_ = 0, fastest_grain_ = 0, fastest_gas_ = 0;
  double swirl_ = 0, samples_ = 0;
};

}  // namespace jet_mill
