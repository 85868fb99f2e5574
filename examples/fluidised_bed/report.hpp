// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: tables, summary.json with its checks, pictures.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "fluidised_bed/law_by_layers.hpp"
#include "support/example.hpp"

namespace fluidised {

/// Pressure drops, heights and loads over the velocity of the gas.
inline void write_curve(const std::string& path, const Scene& s, const Curve& c,
                        const Fluidisation& found) {
  const std::string law = s.name_of_law();
  silt::CsvTable table(path, {"velocity [m/s]", "gas rising [Pa]", "gas falling [Pa]",
                              law + " at the bed's voidage [Pa]", law + " by layers [Pa]",
                              "height rising [m]", "height falling [m]", "floor rising [Pa]",
                              "floor falling [Pa]", "walls rising [Pa]", "walls falling [Pa]"});
  for (std::size_t k = 0; k < c.velocities.size(); ++k) {
    const Means &up = c.rising[k], &down = c.falling[k];
    table.add_row({c.velocities[k], up.pressure_drop, down.pressure_drop, found.drops[k][0],
                   found.drops[k][1], up.height, down.height, up.floor, down.floor, up.walls,
                   down.walls});
  }
}

/// Time average by height: gas pressure above that at the outlet, and the weight of the grains
/// above over the area. The gas carries this weight except for the shares of walls and floor.
/// Writes a table to `path`, and returns the pressure minus that weight in the lowest cell layer
/// [Pa].
inline double write_heights(const std::string& path, const silt::FlowMean& mean, const Scene& s) {
  silt::CsvTable table(path, {"height [m]", "mean pressure [Pa]",
                              "weight of the grains above over the area [Pa]", "mean voidage [-]"});
  double above = 0, top = 0, more = 0;  // [Pa]
  for (int k = s.high - 1; k >= 0; --k) {
    double p = 0, eps = 0;
    for (int j = 0; j < s.deep; ++j)
      for (int i = 0; i < s.across; ++i) p += mean.pressure(i, j, k), eps += mean.voidage(i, j, k);
    p /= s.across * s.deep, eps /= s.across * s.deep;
    if (k == s.high - 1) top = p;
    const double half = 0.5 * s.cell * (1 - eps) * (s.density - s.gas.density) * 9.81;
    above += half, more = p - top - above;
    table.add_row({(k + 0.5) * s.cell, p - top, above, eps});
    above += half;
  }
  return more;
}

/// Void fraction of cells, averaged over the depth, as a table.
inline void write_voidage(const std::string& path, const silt::FlowSolver& flow, const Scene& s) {
  const auto& eps = flow.voidage();
  silt::CsvTable table(path, {"x [m]", "z [m]", "voidage [-]"});
  for (int k = 0; k < s.high; ++k)
    for (int i = 0; i < s.across; ++i) {
      double mean = 0;
      for (int j = 0; j < s.deep; ++j) mean += eps(i, j, k) / s.deep;
      table.add_row({(i + 0.5) * s.cell, (k + 0.5) * s.cell, mean});
    }
}

/// The bed at a few times, for pictures.
struct Pictures {
  std::string out;
  std::vector<std::string> grains{}, voidage{}, titles{};

  template <class Sim>
  void add(Sim& sim, const Scene& s, const std::string& title) {
    const std::string name = out + "/bed_" + std::to_string(grains.size());
    if constexpr (Sim::has_surfaces)
      silt::write_surfaces(name + ".vtp", sim);
    else
      silt::write_particles(name + ".vtp", sim);
    write_voidage(name + ".csv", sim.fluid().flow(), s);
    grains.push_back(name + ".vtp"), voidage.push_back(name + ".csv"), titles.push_back(title);
  }
};

inline void add_inputs(example::Summary& summary, const Scene& s, int threads) {
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("shape", s.shape);
  if (s.shape == "sphere") summary.input("drag", s.drag);
  summary.input("diameter_m", s.diameter);
  summary.input("density_kg_m3", s.density);
  summary.input("gas_density_kg_m3", s.gas.density);
  summary.input("gas_viscosity_pa_s", s.gas.viscosity);
  summary.input("width_m", s.width());
  summary.input("depth_m", s.depth());
  summary.input("cell_m", s.cell);
  summary.input("youngs_modulus_pa", s.material().youngs_modulus);
  summary.input("restitution", s.material().restitution);
  summary.input("friction", s.material().friction);
  summary.input("threads", static_cast<double>(threads));
}

template <class Sim>
void add_results(example::Summary& summary, const Scene& s, Sim& sim, double dense,
                 const Curve& curve, const Fluidisation& found, const Bubbling& bubbling) {
  summary.result("weight_over_area_pa", s.weight());
  summary.result("voidage_of_the_dense_bed", dense);
  summary.result("voidage_of_the_loose_bed", found.voidage);
  summary.result("minimum_fluidisation_m_s", found.measured);
  summary.result("drag_law_at_the_voidages_at_rest_m_s", found.by_voidage);
  summary.result("drag_law_by_layers_m_s", found.by_layers);
  summary.result("ergun_at_the_loose_voidage_m_s", s.velocity_by(silt::Ergun{}, found.voidage));
  summary.result("ergun_at_voidage_0.4_m_s", s.velocity_by(silt::Ergun{}, 0.4));
  summary.result("plateau_over_weight", curve.plateau.borne() / s.weight());
  summary.result("bubbling_velocity_m_s", s.bubbling * found.measured);
  summary.result("bubbling_pressure_drop_pa", bubbling.means.pressure_drop);
  summary.result("bubbling_height_over_height_at_rest", bubbling.means.height / found.height);
  summary.result("highest_grain_over_height_of_the_box", bubbling.highest / (s.high * s.cell));
  summary.result("time_step_s", sim.step_length());
  summary.result("fluid_steps", static_cast<double>(sim.fluid().fluid_steps()));
  summary.result("steps", static_cast<double>(sim.step()));
}

template <class Sim>
void check_run(example::Summary& summary, const Scene& s, Sim& sim, const Curve& curve,
               const Fluidisation& found, const Bubbling& bubbling) {
  const std::string law_name = s.name_of_law();
  const auto [overshoot, above] = curve.overshoot(s);
  const silt::FluidClosure& closure = sim.fluid().closure();
  // Rounding of sums of so many numbers.
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(s.particles);
  summary.check_at_most("volume_of_solids_off", closure.volume, rounding);
  summary.check_at_most("momentum_of_exchange_off", closure.momentum, rounding);
  summary.check_at_most("continuity_off", closure.continuity,
                        sim.fluid().flow().options().tolerance);
  // Gas, floor and walls together carry the weight plus the momentum gain. The gas's part is
  // sampled every 0.2 ms, and lacks the gas's own momentum, rho U^2 (1/eps - 1): 0.3 % while
  // bubbles rise.
  summary.check_at_most("balance_of_forces_over_weight",
                        std::max(curve.unbalanced, std::abs(bubbling.means.unbalanced(s.weight()))),
                        0.01);
  // The kernel smooths the bed's surface, which lowers the drag there: by 0.53 of the kernel's
  // reach over the bed's height. The rest is the variation within layers.
  summary.check_within("minimum_fluidisation_over_the_law", found.measured / found.by_voidage, 1,
                       s.most_off, law_name + " at the bed's voidage at each velocity");
  summary.check_within("minimum_fluidisation_m_s", found.measured, found.by_layers,
                       1.5 * s.by_layers * found.by_layers,
                       law_name + " by the bed's layers, as the kernel blurs them");
  summary.check_at_most("pressure_drop_at_rest_over_law_by_layers_less_1", found.error,
                        2 * s.by_layers);
  summary.check_at_least("pressure_drop_of_the_dense_bed_over_the_loose_one", above, 1.02);
  summary.check_at_least("largest_pressure_drop_at_rest_over_weight", overshoot, 1.01);
  // Not in the quick run, where the bed's rise and fall matter.
  if (curve.plateau.time >= 0.7)
    summary.check_within("plateau_over_weight", curve.plateau.borne() / s.weight(), 1, 0.01,
                         "borne by gas, floor and walls together");
  summary.check_at_least("bubbling_height_over_height_at_rest",
                         bubbling.means.height / found.height, 1.1);
  // Mean pressure in the lowest cell layer: the weight above plus the momentum gain of the grains,
  // minus the load on floor and walls. Half a layer of the walls, and the gas's momentum, are not
  // included.
  summary.check_within(
      "mean_pressure_at_the_floor_less_weight_over_weight", bubbling.bears_more / s.weight(),
      (bubbling.means.momentum - bubbling.means.floor - bubbling.means.walls) / s.weight(), 0.02,
      "means of the flow over the same time as the loads");
  summary.check_at_most("largest_overlap", sim.peak_overlap(), sim.guard.max_overlap);
}

/// Whether all pictures could be drawn.
inline bool draw_run(const std::string& out, const Scene& s, const Pictures& pictures,
                     const Fluidisation& found) {
  const std::string law_name = s.name_of_law();
  std::vector<std::string> grains{"draw"}, gas{"cells"};
  grains.insert(grains.end(), pictures.grains.begin(), pictures.grains.end());
  const std::string bounds = silt::text("0,", s.width(), ",0,", s.high * s.cell);
  const std::string fast = silt::text("0,", std::round(5 * s.bubbling * found.measured) / 10);
  grains.insert(grains.end(), {"--colour", "velocity", "--range", fast, "--bounds", bounds});
  gas.insert(gas.end(), pictures.voidage.begin(), pictures.voidage.end());
  gas.insert(gas.end(), {"--value", "voidage", "--range", "0.35,1"});
  for (auto* picture : {&grains, &gas}) {
    picture->push_back("--title");
    picture->insert(picture->end(), pictures.titles.begin(), pictures.titles.end());
    picture->insert(picture->end(),
                    {"--out", out + (picture == &gas ? "/voidage.png" : "/bed.png")});
  }
  return example::draw(
             {"curves", out + "/pressure_drop.csv", "--x", "velocity", "--y",
              law_name + " at the bed's voidage," + law_name + " by layers,gas rising,gas falling",
              "--y-label", "pressure drop [Pa]", "--reference",
              silt::text("weight of the bed over its area:0,", s.weight()), "--title",
              silt::text("minimum fluidisation at ", std::round(1e3 * found.measured) / 1e3,
                         " m/s"),
              "--out", out + "/pressure_drop.png"}) &&
         example::draw({"curves", out + "/taps.csv", "--x", "time", "--y",
                        "drop from floor to middle,drop from middle to above", "--y-label",
                        "pressure drop [Pa]", "--title", "Between gauges, as bubbles pass", "--out",
                        out + "/taps.png"}) &&
         example::draw({"curves", out + "/heights.csv", "--x", "height", "--y",
                        "mean pressure,weight of the grains above over the area", "--y-label",
                        "[Pa]", "--title", "Mean over time of the bubbling bed", "--out",
                        out + "/heights.png"}) &&
         example::draw({"curves", out + "/probes.csv", "--x", "time", "--y",
                        "low voidage,high voidage", "--y-label", "voidage [-]", "--title",
                        "On the axis, as bubbles pass", "--out", out + "/probes.png"}) &&
         example::draw({"cells", out + "/mean_flow.csv", "--value", "mean voidage", "--title",
                        "mean", "--out", out + "/mean_voidage.png"}) &&
         example::draw(grains) && example::draw(gas);
}

inline void print_results(const Scene& s, const Fluidisation& found, const Bubbling& bubbling) {
  std::printf(
      "\nMinimum fluidisation at %.3f m/s; by %s %.3f m/s of the bed's layers as the kernel blurs "
      "them, %.3f m/s at its voidage, up to %.3f; Ergun's at 0.4 %.3f m/s.\nAt %.2f m/s: %.3f of "
      "the weight borne by the gas, height %.2f times that at rest.\n",
      found.measured, s.name_of_law().c_str(), found.by_layers, found.by_voidage, found.voidage,
      s.velocity_by(silt::Ergun{}, 0.4), s.bubbling * found.measured,
      bubbling.means.pressure_drop / s.weight(), bubbling.means.height / found.height);
}

inline void print_files(const std::string& out, bool drawn, double seconds) {
  const auto named = [&](const char* file) { return out + "/" + file; };
  std::printf(
      "Look at: %s%s (ParaView), %s, %s; %.0f s\n",
      drawn ? (named("pressure_drop.png") + ", " + named("bed.png") + ", " + named("voidage.png") +
               ", " + named("mean_voidage.png") + ", " + named("taps.png") + ", " +
               named("heights.png") + ", " + named("probes.png") + ", ")
                  .c_str()
            : "",
      named("vtk").c_str(), named("pressure_drop.csv").c_str(), named("summary.json").c_str(),
      seconds);
}

}  // namespace fluidised
