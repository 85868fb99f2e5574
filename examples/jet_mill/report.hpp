// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: tables, summary.json with its checks.

#include <string>

#include "jet_mill/measure.hpp"
#include "support/example.hpp"

namespace jet_mill {

/// The mean flow in the cells next to half of the chamber's height.
inline void write_gas(const std::string& path, const silt::FlowMean& mean, const Scene& s) {
  silt::CsvTable out(path, {"x [m]", "y [m]", "u [m/s]", "v [m/s]", "w [m/s]"});
  const auto& grid = mean.grid();
  const int middle = static_cast<int>(0.5 * s.height / s.cell);
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i) {
      const Vec3d low = grid.box().min;
      const Vec3d x{low.x + (i + 0.5) * s.cell, low.y + (j + 0.5) * s.cell, 0.5 * s.height};
      if (room(s, x) <= 0) continue;
      const Vec3d v = 0.5 * (mean.velocity(i, j, middle - 1) + mean.velocity(i, j, middle));
      out.add_row({x.x, x.y, v.x, v.y, v.z});
    }
}

inline void write_impacts(const std::string& path, const silt::ImpactEnergies& impacts,
                          double duration) {
  silt::CsvTable out(path, {"from [J]", "to [J]", "at walls [1/s]", "in pairs [1/s]",
                            "energy at walls [W]", "energy in pairs [W]"});
  for (const auto& c : impacts.table())
    out.add_row({c.from, c.to, static_cast<double>(c.at_walls) / duration,
                 static_cast<double>(c.in_pairs) / duration, c.walls_energy / duration,
                 c.pairs_energy / duration});
}

/// Tables of the end: the mean flow, impacts, sizes of dust, grains and product.
template <class Sim>
void write_tables(const std::string& out, const Scene& s, const Sim& sim,
                  const silt::FlowMean& mean) {
  write_gas(out + "/gas.csv", mean, s);
  write_impacts(out + "/impacts.csv", sim.impact_energies(), sim.time());
  silt::write_sizes(out + "/dust.csv", sim.dust());
  silt::write_sizes(out + "/grains.csv", silt::sizes_present(sim));
  silt::SizeTable product = sim.dust();
  product.merge(sim.left());
  silt::write_sizes(out + "/product.csv", product);
}

inline void add_inputs(example::Summary& summary, const Scene& s) {
  summary.input("jets_m_s", s.jets);
  summary.input("gas_kg_s", s.gas_rate() * Scene::air.density);
  summary.input("feed_kg_s", s.rate);
  summary.input("feed_diameter_m", s.feed);
  summary.input("strength_n", s.strength);
  summary.input("dust_below_m", s.dust);
  summary.input("softened_below_m", 2 * s.full_radius);
  summary.input("cell_m", s.cell);
  summary.input("duration_s", s.duration);
}

template <class Sim>
void add_results(example::Summary& summary, const Sim& sim, const Watch& watch) {
  const auto m = sim.mass_balance();
  summary.result("fed_kg", m.fed);
  summary.result("present_kg", m.present);
  summary.result("left_kg", m.left);
  summary.result("dust_kg", m.dust);
  summary.result("grains", static_cast<double>(sim.size()));
  summary.result("most_grains", watch.most_grains());
  summary.result("broken_at_walls", static_cast<double>(sim.broken(silt::BreakCause::Wall)));
  summary.result("broken_in_pairs", static_cast<double>(sim.broken(silt::BreakCause::Pair)));
  summary.result("fastest_grain_m_s", watch.fastest_grain());
  summary.result("fastest_gas_m_s", watch.fastest_gas());
  summary.result("swirl_at_half_radius_m_s", watch.swirl());
  summary.result("safeguarded", static_cast<double>(sim.safeguarded()));
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("fluid_steps", static_cast<double>(sim.fluid().fluid_steps()));
}

template <class Sim>
void check_run(example::Summary& summary, const Sim& sim, const Watch& watch) {
  const auto& closure = sim.fluid().closure();
  summary.check_at_most("mass_unexplained_over_fed", watch.worst_mass(), 1e-12);
  summary.check_at_least(
      "broken",
      static_cast<double>(sim.broken(silt::BreakCause::Wall) + sim.broken(silt::BreakCause::Pair)),
      1);
  summary.check_at_most("momentum_of_gas_and_grains_off", closure.momentum, 1e-8);
  summary.check_at_most("volume_of_solids_off", closure.volume, 1e-10);
  summary.check_at_most("fastest_grain_over_fastest_gas",
                        watch.fastest_grain() / watch.fastest_gas(), 1);
}

}  // namespace jet_mill
