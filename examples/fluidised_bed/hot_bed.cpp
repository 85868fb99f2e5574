// silt - BSD-3-Clause, see LICENSE
//
// Hot gas through a cold bubbling bed: how fast gas and grains heat up, and where the heat goes.
// The gas reaches the grains' temperature within about a grain diameter. Upper bound for the
// grains: all the heat that enters, as long as the gas leaves the bed cold. Lower bound, where no
// bubble carries hot gas through: a perfectly mixed bed, which gas leaves at the grains'
// temperature.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/module/heat/fluid_convection.hpp>

#include "scene.hpp"

namespace fluidised {
namespace {

auto make_hot_bed(const Scene& s, silt::Particles<silt::Sphere> grains) {
  silt::FlowSolver flow(
      silt::Grid(domain(s).box(), {s.across, s.deep, s.high}, {false, true, false}), s.gas);
  flow.set_side(2, 0, silt::Inflow{});
  flow.set_side(2, 1, silt::Outflow{});
  flow.set_heat({.heat_capacity = s.gas_capacity,
                 .conductivity = s.gas_conducts,
                 .start_temperature = s.cold});
  silt::Simulation sim{
      std::move(grains), silt::Contacts<Law>{s.material()}, domain(s),
      silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{.width = s.kernel}, std::move(flow)},
      silt::Heat{silt::HeatConduction{.conductivity = s.conductivity,
                                      .heat_capacity = s.grain_capacity,
                                      .youngs_modulus = 63e9,  // [Pa] of glass
                                      .start_temperature = s.cold},
                 silt::FluidConvection<silt::Gunn>{}}};
  add_floor_and_walls(sim, s, s.material());
  return sim;
}

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
GasHeat heat_of_gas(const silt::FlowSolver& flow, const Scene& s) {
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

struct Pictures {
  std::vector<std::string> grains, gas, titles;
};

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

  /// Runs for s.blowing; writes a table, a VTK series and the pictures' files to `out`.
  Pictures blow(const std::string& out) {
    auto table = silt::table(
        out + "/temperatures.csv",
        {"time [s]", "gas at the outlet [K]", "gas [K]", "grains [K]", "coldest grain [K]",
         "hottest grain [K]", "grains if mixed [K]", "grains if they keep all heat [K]",
         "heat in less heat out [J]", "heat stored in gas [J]", "heat stored in grains [J]"},
        silt::every(s_.blowing / 200), [this](const auto&) { return row(); });
    auto series = silt::vtk_series(out + "/vtk", silt::every(s_.blowing / 50));
    Pictures pictures;
    const int parts = 4;
    for (int k = 0; k < parts; ++k) {
      sim_.run(s_.blowing / parts, table, series, silt::progress());
      const std::string name = out + "/hot_" + std::to_string(k);
      silt::write_particles(name + ".vtp", sim_), write_gas(name + ".csv", flow(), s_);
      pictures.grains.push_back(name + ".vtp"), pictures.gas.push_back(name + ".csv");
      char title[40];
      std::snprintf(title, sizeof title, "%.3g s", (k + 1) * s_.blowing / parts);
      pictures.titles.push_back(title);
    }
    return pictures;
  }

  void judge(example::Summary& summary) const {
    const silt::FluidHeatBook& after = flow().heat_book();
    const GrainHeat grains = heat_of_grains(sim_, s_);
    const GasHeat gas = heat_of_gas(flow(), s_);
    const double in = after.through_sides - gas_before_.through_sides;
    const double in_gas = after.stored - gas_before_.stored;
    const double in_grains = grains.stored - grains_before_.stored;
    const double from_grains = after.from_particles - gas_before_.from_particles;
    const double anew = after.counted_anew - gas_before_.counted_anew;
    const double t = time(), rise = grains.mean - grains_before_.mean;
    summary.result("time_s", t);
    summary.result("heat_in_less_out_j", in);
    summary.result("heat_stored_in_gas_j", in_gas);
    summary.result("heat_stored_in_grains_j", in_grains);
    summary.result("heat_of_gas_counted_anew_j", anew);
    summary.result("grains_mean_k", grains.mean);
    summary.result("gas_mean_k", gas.mean);
    summary.result("gas_at_the_outlet_k", gas.out);
    summary.result("grains_if_mixed_k", mixed());
    summary.result("grains_if_they_keep_all_heat_k", all_kept());
    // Rounding: sums of heat above 0 K, a hundred times the stored heat, over thousands of steps.
    summary.check_at_most("heat_balance_over_heat_in_grains",
                          std::abs(in + anew - in_gas - in_grains) / in_grains, 1e-10);
    summary.check_at_most("heat_from_gas_less_heat_in_grains_over_it",
                          std::abs(from_grains + in_grains) / in_grains, 1e-10);
    // Residual of the pressure solver in the gas volume, and jumps of the void fraction.
    summary.check_at_most("heat_of_gas_counted_anew_over_heat_in_grains",
                          std::abs(anew) / in_grains, 0.01);
    // Second law; 1e-9: rounding.
    summary.check_at_most("hottest_k", hottest_, s_.hot_gas * (1 + 1e-9));
    summary.check_at_least("coldest_k", coldest_, s_.cold * (1 - 1e-9));
    summary.check_within("heat_in_while_the_outlet_is_cold_over_that_of_the_gas", while_cold_, 1,
                         0.01, "gas comes in hot and leaves cold; a little is conducted in");
    summary.check_at_most("rise_of_grains_over_that_of_all_heat", rise / (all_kept() - s_.cold), 1);
    summary.check_at_least("rise_of_grains_over_that_of_a_mixed_bed", rise / (mixed() - s_.cold),
                           0.95);
    summary.check_at_most("largest_overlap", sim_.peak_overlap(), sim_.guard.max_overlap);
    std::printf(
        "\nAfter %.2f s: grains at %.1f K (%.1f K if mixed, %.1f K if they kept all heat), "
        "gas at %.1f K, %.1f K at the outlet. Of %.4g J that stayed the grains have %.4g J.\n",
        t, grains.mean, mixed(), all_kept(), gas.mean, gas.out, in, in_grains);
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

  const Scene& s_;
  Sim& sim_;
  double brings_, holds_;  // [W/K] the gas, [J/K] the grains
  silt::FluidHeatBook gas_before_;
  GrainHeat grains_before_;
  double begun_;
  double coldest_, hottest_, while_cold_ = 0;  // [K], [K]; [-] heat in over that of the gas
};

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
  const Pictures pictures = bed.blow(options.out);

  example::Summary summary;
  add_inputs(summary, s, U, options.threads);
  bed.judge(summary);
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
