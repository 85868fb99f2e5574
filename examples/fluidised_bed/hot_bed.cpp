// silt - BSD-3-Clause, see LICENSE
//
// Hot gas through a cold bubbling bed: how fast gas and grains heat up, and where the heat goes.
// The gas reaches the grains' temperature within about a grain diameter. Upper bound for the
// grains: all the heat that enters, as long as the gas leaves the bed cold. Lower bound, where no
// bubble carries hot gas through: a perfectly mixed bed, which gas leaves at the grains'
// temperature.

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "fluidised_bed/hot_bed.hpp"
#include "fluidised_bed/hot_measure.hpp"
#include "fluidised_bed/scene.hpp"

namespace fluidised {
namespace {

/// The gas temperature, averaged over the depth, as a table.
void write_gas(const std::string& path, const silt::FlowSolver& flow, const Scene& s) {
  silt::CsvTable table(path, {"x [m]", "z [m]", "gas temperature [K]"});
  for (int k = 0; k < s.high; ++k)
    for (int i = 0; i < s.across; ++i) {
      double mean = 0;
      for (int j = 0; j < s.deep; ++j) mean += flow.temperature()(i, j, k) / s.deep;
      table.add_row({(i + 0.5) * s.cell, (k + 0.5) * s.cell, mean});
    }
}

struct Pictures {
  std::vector<std::string> grains, gas, titles;
};

/// Runs for s.blowing; writes a table, a VTK series and the pictures' files to `out`.
template <class Sim>
Pictures blow(const Scene& s, Sim& sim, HotBed<Sim>& bed, const std::string& out) {
  auto table = silt::table(out + "/temperatures.csv", HotBed<Sim>::columns(),
                           silt::every(s.blowing / 200), [&](const auto&) { return bed.row(); });
  auto series = silt::vtk_series(out + "/vtk", silt::every(s.blowing / 50));
  Pictures pictures;
  const int parts = 4;
  for (int k = 0; k < parts; ++k) {
    sim.run(s.blowing / parts, table, series, silt::progress());
    const std::string name = out + "/hot_" + std::to_string(k);
    silt::write_particles(name + ".vtp", sim), write_gas(name + ".csv", sim.fluid().flow(), s);
    pictures.grains.push_back(name + ".vtp"), pictures.gas.push_back(name + ".csv");
    char title[40];
    std::snprintf(title, sizeof title, "%.3g s", (k + 1) * s.blowing / parts);
    pictures.titles.push_back(title);
  }
  return pictures;
}

void add_inputs(example::Summary& summary, const Scene& s, double U, int threads) {
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("diameter_m", s.diameter);
  summary.input("density_kg_m3", s.density);
  summary.input("gas_velocity_m_s", U);
  summary.input("gas_temperature_k", s.hot_gas);
  summary.input("start_temperature_k", s.cold);
  summary.input("heat_capacity_j_kgk", s.grain_capacity);
  summary.input("gas_heat_capacity_j_kgk", s.gas_capacity);
  summary.input("conductivity_w_mk", s.conductivity);
  summary.input("gas_conductivity_w_mk", s.gas_conducts);
  summary.input("threads", static_cast<double>(threads));
}

template <class Sim>
void judge(example::Summary& summary, const Scene& s, const Sim& sim, const HeatBalance& b) {
  summary.result("time_s", b.time);
  summary.result("heat_in_less_out_j", b.in);
  summary.result("heat_stored_in_gas_j", b.in_gas);
  summary.result("heat_stored_in_grains_j", b.in_grains);
  summary.result("heat_of_gas_counted_anew_j", b.anew);
  summary.result("grains_mean_k", b.grains.mean);
  summary.result("gas_mean_k", b.gas.mean);
  summary.result("gas_at_the_outlet_k", b.gas.out);
  summary.result("grains_if_mixed_k", b.mixed);
  summary.result("grains_if_they_keep_all_heat_k", b.all_kept);
  // Rounding: sums of heat above 0 K, a hundred times the stored heat, over thousands of steps.
  summary.check_at_most("heat_balance_over_heat_in_grains",
                        std::abs(b.in + b.anew - b.in_gas - b.in_grains) / b.in_grains, 1e-10);
  summary.check_at_most("heat_from_gas_less_heat_in_grains_over_it",
                        std::abs(b.from_grains + b.in_grains) / b.in_grains, 1e-10);
  // Residual of the pressure solver in the gas volume, and jumps of the void fraction.
  summary.check_at_most("heat_of_gas_counted_anew_over_heat_in_grains",
                        std::abs(b.anew) / b.in_grains, 0.01);
  // Second law; 1e-9: rounding.
  summary.check_at_most("hottest_k", b.hottest, s.hot_gas * (1 + 1e-9));
  summary.check_at_least("coldest_k", b.coldest, s.cold * (1 - 1e-9));
  summary.check_within("heat_in_while_the_outlet_is_cold_over_that_of_the_gas", b.while_cold, 1,
                       0.01, "gas comes in hot and leaves cold; a little is conducted in");
  summary.check_at_most("rise_of_grains_over_that_of_all_heat", b.rise / (b.all_kept - s.cold), 1);
  summary.check_at_least("rise_of_grains_over_that_of_a_mixed_bed", b.rise / (b.mixed - s.cold),
                         0.95);
  summary.check_at_most("largest_overlap", sim.peak_overlap(), sim.guard.max_overlap);
  std::printf(
      "\nAfter %.2f s: grains at %.1f K (%.1f K if mixed, %.1f K if they kept all heat), "
      "gas at %.1f K, %.1f K at the outlet. Of %.4g J that stayed the grains have %.4g J.\n",
      b.time, b.grains.mean, b.mixed, b.all_kept, b.gas.mean, b.gas.out, b.in, b.in_grains);
}

/// Draws a run from its tables; false if that failed.
bool draw_hot(const Scene& s, const std::string& out, const Pictures& pictures, double U) {
  const std::string range = silt::text(s.cold, ",", s.hot_gas);
  std::vector<std::string> grains{"draw"}, gas{"cells"};
  grains.insert(grains.end(), pictures.grains.begin(), pictures.grains.end());
  gas.insert(gas.end(), pictures.gas.begin(), pictures.gas.end());
  grains.insert(grains.end(), {"--colour", "temperature", "--range", range, "--bounds",
                               silt::text("0,", s.width(), ",0,", s.high * s.cell)});
  gas.insert(gas.end(), {"--value", "gas temperature", "--range", range});
  for (auto* picture : {&grains, &gas}) {
    picture->push_back("--title");
    picture->insert(picture->end(), pictures.titles.begin(), pictures.titles.end());
    picture->insert(picture->end(),
                    {"--out", out + (picture == &gas ? "/hot_gas.png" : "/hot_bed.png")});
  }
  return example::draw({"curves", out + "/temperatures.csv", "--x", "time", "--y",
                        "grains if they keep all heat,grains if mixed,grains,gas,gas at the outlet",
                        "--y-label", "temperature [K]", "--title",
                        silt::text("Gas of ", s.hot_gas, " K at ", std::round(1e3 * U) / 1e3,
                                   " m/s through a bed of ", s.cold, " K"),
                        "--out", out + "/temperatures.png"}) &&
         example::draw(grains) && example::draw(gas);
}

}  // namespace

int blow_hot(const Scene& s, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  const double U = s.bubbling * s.velocity_by(silt::Ergun{}, 0.4);
  std::printf("settling\n");
  auto sim = make_hot_bed(s, settle<silt::Sphere>(s, options.threads));
  sim.threads = options.threads;
  begin_to_bubble(sim, U, 0.15);
  std::printf("hot gas at %.2f m/s\n", U);
  HotBed bed(s, sim, U);
  const Pictures pictures = blow(s, sim, bed, options.out);

  example::Summary summary;
  add_inputs(summary, s, U, options.threads);
  judge(summary, s, sim, bed.balance());
  summary.result("time_step_s", sim.step_length());
  summary.result("fluid_steps", static_cast<double>(sim.fluid().fluid_steps()));
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");

  const bool drawn = draw_hot(s, options.out, pictures, U);
  summary.print_checks();
  const auto named = [&](const char* file) { return options.out + "/" + file; };
  std::printf("Look at: %s%s (ParaView), %s, %s; %.0f s\n",
              drawn ? (named("temperatures.png") + ", " + named("hot_bed.png") + ", " +
                       named("hot_gas.png") + ", ")
                          .c_str()
                    : "",
              named("vtk").c_str(), named("temperatures.csv").c_str(),
              named("summary.json").c_str(), watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace fluidised
