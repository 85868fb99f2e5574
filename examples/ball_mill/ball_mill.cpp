// silt - BSD-3-Clause, see LICENSE
//
// The laboratory ball mill of B. Doroszek et al., Minerals 14 (2024) 407: angle of repose in three
// drums beside that of recordings, torque and power, impact energies; with --scan over restitution
// and friction. The set-up is scene.hpp, with slurry slurry.hpp.

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "ball_mill/dry.hpp"
#include "ball_mill/measure.hpp"
#include "ball_mill/scene.hpp"
#include "ball_mill/wet.hpp"
#include "support/example.hpp"

namespace {

using namespace ball_mill;

void add_inputs(example::Summary& summary, const Scene& s) {
  summary.input("case", s.name), summary.input("length_m", s.length);
  summary.input("end_walls", !s.periodic), summary.input("youngs_modulus_pa", s.modulus);
  summary.input("restitution", s.restitution), summary.input("friction", s.friction);
  summary.input("turns", s.turns), summary.input("turns_before", s.before);
  summary.input("frames", static_cast<double>(s.frames));
  summary.input("seed", static_cast<double>(s.seed));
}

void check(example::Summary& summary, const Scene& s, const DryRun& run, bool quick) {
  const double power = run.work / run.seconds;
  summary.result("balls", static_cast<double>(run.balls)), summary.result("mass_kg", run.mass);
  summary.result("angle_of_repose_deg", run.surface.angle);
  summary.result("angle_in_the_recording_deg", s.drum().angle);
  summary.result("angle_in_the_recording_with_ore_deg", s.drum().angle_dry);
  summary.result("error_of_the_line_deg", run.surface.error);
  summary.result("scatter_about_the_line_mm", 1e3 * run.surface.line.deviation);
  summary.result("power_w", power), summary.result("torque_n_m", power / s.rate());
  summary.result("power_w_per_kg", power / run.mass);
  summary.result("largest_power_w", run.largest_power);
  summary.result("impacts", static_cast<double>(run.impacts));
  summary.result("time_step_s", run.step);
  summary.result("mean_overlap_over_mean_diameter", run.contact_overlap);

  // As printed in the paper, to its digits.
  const double printed = s.name == "300" ? 24.8 : s.name == "400" ? 21.1 : 18.7;
  summary.check_within("turns_a_minute", turns_a_minute(s.drum()), printed, 0.05,
                       "the paper's digits");
  std::size_t wanted = 0;
  for (const std::size_t n : ball_counts(s.drum(), s.length)) wanted += n;
  summary.check_within("balls_over_those_of_bonds_charge",
                       static_cast<double>(run.balls) / static_cast<double>(wanted), 1, 1e-12,
                       "none is left out");
  summary.check_within(
      "steel_over_volume_of_the_drum",
      run.mass / steel_density / (std::numbers::pi * s.radius() * s.radius() * s.length), filling,
      0.004, "whole balls");
  summary.check_within("work_of_the_drum_over_energy_held_and_dissipated", run.work / run.booked, 1,
                       1e-3, "error of the ledger, and of torque times angle");
  // In steady motion angular momentum is constant: the drum's torque balances the moment of the
  // weight.
  summary.check_within("torque_over_moment_of_the_weight", run.work / run.lever, 1,
                       quick ? 0.05 : 0.02, "what the bed's swing adds over the turns");
  summary.check_within("lost_in_contacts_over_power", run.in_contacts / run.work, 1, 0.1,
                       "contacts that last beyond the end are not counted");
  summary.check_at_most("balls_outside", static_cast<double>(run.outside), 0);
  summary.check_at_most("mean_overlap_over_mean_diameter", run.contact_overlap,
                        s.modulus < 1e9 ? 3e-3 : 2e-4);
  summary.check_within("angle_of_repose_deg", run.surface.angle, 43, 8,
                       "balls that slide lie level; those that stick lie steeper");
}

int run_case(const Scene& s, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  const silt::EnergyLedger books{};
  const silt::ContactEvents events{};
  const int threads = options.threads;
  const DryRun run =
      s.periodic ? run_dry(s, filled_mill(s, threads, books, events, period(s)), options.out)
                 : run_dry(s, filled_mill(s, threads, books, events), options.out);
  example::Summary summary;
  add_inputs(summary, s);
  check(summary, s, run, options.quick);
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(
      SILT_BALL_MILL_SCRIPT, {"dry", options.out, silt::text(s.radius()),
                              silt::text(run.surface.angle), silt::text(s.drum().angle), s.name});
  std::printf("Angle of repose %.1f degrees; in the recording %.2f. Power %.1f W, %.2f W/kg.\n",
              run.surface.angle, s.drum().angle, run.work / run.seconds,
              run.work / run.seconds / run.mass);
  summary.print_checks();
  std::printf("Look at: %s%s/torque.csv, impacts.csv, surface.csv, summary.json; %.0f s\n",
              drawn ? (options.out + "/mill.png, curves.png, ").c_str() : "", options.out.c_str(),
              watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

/// The three drums over restitution and friction, each with several seeds.
int scan(Scene like, std::size_t seeds, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  silt::CsvTable table(options.out + "/scan.csv",
                       {"restitution", "friction", "angle 300 [deg]", "angle 400 [deg]",
                        "angle 500 [deg]", "scatter [deg]", "squared error [deg2]"});
  std::printf("  e     mu      300    400    500   scatter  squared error\n");
  double least = 1e300, least_e = 0, least_mu = 0, scatters = 0, lowest = 90, highest = 0;
  std::size_t runs = 0;
  const std::vector<double> es = {0.3, 0.39, 0.55}, mus = {0.2, 0.3, 0.5};
  for (const double e : es)
    for (const double mu : mus) {
      std::array<double, 3> sum{}, squares{};
      for (std::size_t seed = 1; seed <= seeds; ++seed) {
        like.seed = seed;
        const auto angles = mill_targets(e, mu, like, options.threads);
        for (std::size_t k = 0; k < 3; ++k)
          sum[k] += angles[k], squares[k] += angles[k] * angles[k];
      }
      const double n = static_cast<double>(seeds);
      std::array<double, 3> mean{};
      double variance = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        mean[k] = sum[k] / n;
        lowest = std::min(lowest, mean[k]), highest = std::max(highest, mean[k]);
        if (seeds > 1) variance += (squares[k] - n * mean[k] * mean[k]) / (n - 1) / 3;
      }
      const double error = squared_error(mean), scatter = std::sqrt(std::max(variance, 0.0));
      table.add_row({e, mu, mean[0], mean[1], mean[2], scatter, error});
      std::printf("  %.2f  %.2f  %6.2f %6.2f %6.2f  %5.2f   %6.2f\n", e, mu, mean[0], mean[1],
                  mean[2], scatter, error);
      std::fflush(stdout);
      scatters += scatter, ++runs;
      if (error < least) least = error, least_e = e, least_mu = mu;
    }
  example::Summary summary;
  add_inputs(summary, like), summary.input("seeds", static_cast<double>(seeds));
  summary.result("least_squared_error_deg2", least);
  summary.result("restitution_of_the_least", least_e);
  summary.result("friction_of_the_least", least_mu);
  summary.result("mean_scatter_of_a_run_deg", scatters / static_cast<double>(runs));
  summary.result("lowest_angle_deg", lowest), summary.result("highest_angle_deg", highest);
  summary.check_within("pairs_that_were_run", static_cast<double>(runs), 9, 0, "three by three");
  summary.check_at_least("highest_less_lowest_angle_deg", highest - lowest, 1);
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");
  std::printf(
      "Least: %.2f degrees^2 at e = %.2f, mu = %.2f. In the recordings: %.2f, %.2f, %.2f.\n", least,
      least_e, least_mu, mills[0].angle, mills[1].angle, mills[2].angle);
  summary.print_checks();
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "A laboratory ball mill: angle of repose, torque and power, energies of impacts",
      example::Kind::Cases, "out/ball_mill");
  Scene s;
  double length = 1e3 * s.length;
  Slurry slurry;
  double spacing = 1e3 * slurry.spacing, seconds = 12;
  bool real = false, do_scan = false, is_wet = false;
  std::size_t seeds = 2;
  command.add("--case", s.name, {"300", "400", "500"}, "Outer diameter of the drum [mm]");
  command.add("--length", length, 50, 300,
              "Length of the drum [mm], which the paper does not give");
  command.add_flag("--periodic", s.periodic, "No end walls: the drum repeats after its length");
  command.add("--restitution", s.restitution, 0.05, 1, "Restitution of all contacts [-]");
  command.add("--friction", s.friction, 0, 2, "Friction of all contacts [-]");
  command.add_flag("--real", real, "Young's modulus of steel, 2.1e11 Pa, instead of 1e8 Pa");
  command.add("--turns", s.turns, 0.2, 100, "Turns of the drum that are recorded");
  command.add("--before", s.before, 0.1, 100, "Turns of the drum before the recording");
  command.add("--seed", s.seed, 1, 1000000, "Seed of the initial positions of the balls");
  command.add_flag("--scan", do_scan, "Run the three drums over restitution and friction");
  command.add("--seeds", seeds, 1, 100, "Number of seeds of the scan");
  command.add_flag("--wet", is_wet,
                   "With slurry between the balls, by SPH; limits: docs/ball_mill.md");
  command.add("--spacing", spacing, 2, 11, "Spacing of the slurry's particles [mm]");
  command.add("--seconds", seconds, 0.02, 100,
              "Duration of the wet run [s]; the last two thirds are measured");
  command.add("--sound", slurry.sound, 5, 100,
              "Speed of sound of the slurry [m/s], ten times its largest speed");
  command.add("--alpha", slurry.alpha, 0, 1, "Artificial viscosity alpha of the slurry");
  command.add("--smoothing", slurry.smoothing, 0.7, 2, "Smoothing length over sqrt(3) spacings");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    s.length = 1e-3 * length;
    if (real) s.modulus = 2.1e11;
    if (options.quick) {
      if (!command.given("--turns")) s.turns = 1;
      if (!command.given("--before")) s.before = 0.5;
      if (!command.given("--seeds")) seeds = 1;
      if (!command.given("--spacing"))
        spacing = s.name == "500" ? 7.5 : s.name == "400" ? 6.5 : 4.9;
      if (!command.given("--seconds")) seconds = 0.2;
    }
    silt::require(!s.periodic || s.length >= 3 * make_up,
                  "ball_mill: --periodic needs a --length of ",
                  "at least 105 mm, three diameters of the largest ball");
    slurry.spacing = 1e-3 * spacing;
    if (is_wet) {
      silt::require(!s.periodic && !do_scan,
                    "ball_mill: --wet goes with end walls and one case; leave out --periodic and "
                    "--scan");
      return run_wet(s, slurry, seconds, options);
    }
    return do_scan ? scan(s, seeds, options) : run_case(s, options);
  });
}
