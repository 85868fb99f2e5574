// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured as hot gas blows through the cold bed: temperatures, and where the heat goes.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fluidised_bed/scene.hpp"

namespace fluidised {

/// Temperature of the grains [K], and their heat [J] above that of cold ones.
struct GrainHeat {
  double mean = 0, least = std::numeric_limits<double>::infinity(), most = 0, stored = 0;
};
template <class Sim>
GrainHeat heat_of_grains(const Sim& sim, const Scene& s) {
  GrainHeat h;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double T = sim.template field<silt::Temperature>(k);
    h.mean += T / static_cast<double>(sim.rows());
    h.least = std::min(h.least, T), h.most = std::max(h.most, T);
    h.stored += sim.mass(k) * s.grain_capacity * (T - s.cold);
  }
  return h;
}

/// Temperature of the gas [K]: mean over all of it, and in the last cells before the outlet.
struct GasHeat {
  double mean = 0, out = 0;
};
inline GasHeat heat_of_gas(const silt::FlowSolver& flow, const Scene& s) {
  GasHeat h;
  double share = 0;
  for (int k = 0; k < s.high; ++k)
    for (int j = 0; j < s.deep; ++j)
      for (int i = 0; i < s.across; ++i) {
        const double m = flow.voidage()(i, j, k), T = flow.temperature()(i, j, k);
        h.mean += m * T, share += m;
        if (k == s.high - 1) h.out += T / (s.across * s.deep);
      }
  h.mean /= share;
  return h;
}

/// Where the heat is that the hot gas has brought.
struct HeatBalance {
  double time = 0;                           // [s] with hot gas
  double in = 0, in_gas = 0, in_grains = 0;  // [J] in less out; stored in both
  double from_grains = 0, anew = 0;          // [J] that gas got; of gas counted anew
  GrainHeat grains{};
  GasHeat gas{};
  double rise = 0, mixed = 0, all_kept = 0;  // [K] of the grains, and what they would have
  double coldest = 0, hottest = 0;           // [K] of a grain, at any time
  double while_cold = 0;  // [-] heat in over that of the gas, while the outlet is cold
};

/// Brings the gas to the superficial velocity U [m/s] in 10 ms; bubbles form during the rest of
/// `span` [s].
template <class Sim>
void begin_to_bubble(Sim& sim, double U, double span) {
  for (int k = 1; k <= 10; ++k) {
    sim.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, U * k / 10}});
    sim.run(1e-3);
  }
  sim.run(span - 0.01);
}

/// A bed with hot gas from now on; its heat input is counted from here.
template <class Sim>
class HotBed {
 public:
  HotBed(const Scene& s, Sim& sim, double U) : s_(s), sim_(sim) {
    brings_ = s.gas.density * s.gas_capacity * U * s.area();
    holds_ = static_cast<double>(s.particles) * s.mass() * s.grain_capacity;
    flow().set_side_heat(2, 0, {.temperature = s.hot_gas});
    gas_before_ = flow().heat_book(), grains_before_ = heat_of_grains(sim, s);
    begun_ = sim.fluid().time(), coldest_ = hottest_ = s.cold;
  }

  /// Columns of a row, and a row at this time.
  static std::vector<std::string> columns() {
    return {"time [s]",
            "gas at the outlet [K]",
            "gas [K]",
            "grains [K]",
            "coldest grain [K]",
            "hottest grain [K]",
            "grains if mixed [K]",
            "grains if they keep all heat [K]",
            "heat in less heat out [J]",
            "heat stored in gas [J]",
            "heat stored in grains [J]"};
  }
  std::array<double, 11> row() {
    const GrainHeat grains = heat_of_grains(sim_, s_);
    const GasHeat gas = heat_of_gas(flow(), s_);
    const silt::FluidHeatBook& book = flow().heat_book();
    const double in = book.through_sides - gas_before_.through_sides;
    coldest_ = std::min(coldest_, grains.least), hottest_ = std::max(hottest_, grains.most);
    if (gas.out - s_.cold < 1e-3 * (s_.hot_gas - s_.cold))
      while_cold_ = in / (brings_ * time() * (s_.hot_gas - s_.cold));
    return {time(),
            gas.out,
            gas.mean,
            grains.mean,
            grains.least,
            grains.most,
            mixed(),
            all_kept(),
            in,
            book.stored - gas_before_.stored,
            grains.stored - grains_before_.stored};
  }

  /// What the bed has got so far.
  HeatBalance balance() const {
    const silt::FluidHeatBook& now = flow().heat_book();
    HeatBalance b;
    b.time = time(), b.grains = heat_of_grains(sim_, s_), b.gas = heat_of_gas(flow(), s_);
    b.in = now.through_sides - gas_before_.through_sides;
    b.in_gas = now.stored - gas_before_.stored;
    b.in_grains = b.grains.stored - grains_before_.stored;
    b.from_grains = now.from_particles - gas_before_.from_particles;
    b.anew = now.counted_anew - gas_before_.counted_anew;
    b.rise = b.grains.mean - grains_before_.mean;
    b.mixed = mixed(), b.all_kept = all_kept();
    b.coldest = coldest_, b.hottest = hottest_, b.while_cold = while_cold_;
    return b;
  }

 private:
  silt::FlowSolver& flow() const { return sim_.fluid().flow(); }
  double time() const { return sim_.fluid().time() - begun_; }  // [s] with hot gas
  /// [K] of a single body that takes all heat that the gas brings above the body's temperature.
  double mixed() const {
    return s_.hot_gas - (s_.hot_gas - s_.cold) * std::exp(-time() * brings_ / holds_);
  }
  double all_kept() const {  // [K] of grains that get all heat of the gas above `cold`
    return std::min(s_.cold + time() * brings_ * (s_.hot_gas - s_.cold) / holds_, s_.hot_gas);
  }

  const Scene& s_;
  Sim& sim_;
  double brings_, holds_;  // [W/K] the gas, [J/K] the grains
  silt::FluidHeatBook gas_before_;
  GrainHeat grains_before_;
  double begun_;
  double coldest_, hottest_, while_cold_ = 0;  // [K], [K]; [-] heat in over that of the gas
};

}  // namespace fluidised
