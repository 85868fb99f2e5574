// silt - BSD-3-Clause, see LICENSE
//
// A spiral jet mill: four air jets drive grains round a flat chamber. They break at its wall and on
// each other until they are dust, which leaves with the air through a central tube. The air is
// incompressible and turbulent, with two-way coupling.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp tables and checks.

#include <array>
#include <cstdio>
#include <string>

#include "jet_mill/measure.hpp"
#include "jet_mill/report.hpp"
#include "jet_mill/scene.hpp"
#include "support/example.hpp"

namespace jet_mill {
namespace {

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  if (!options.restart.empty()) silt::load_checkpoint(sim, options.restart);

  Watch watch(s);
  auto looks = silt::at(silt::every(watch.interval()), [&](const auto& now) { watch.look(now); });
  auto sizes = silt::table(
      options.out + "/sizes_over_time.csv",
      {"time [s]", "dust x10 [m]", "dust x50 [m]", "dust x90 [m]", "grains x10 [m]",
       "grains x50 [m]", "grains x90 [m]"},
      silt::every(s.duration / 50), [](const auto& now) {
        const auto dust = quantiles(now.dust()), there = quantiles(silt::sizes_present(now));
        return std::array{now.time(), dust[0], dust[1], dust[2], there[0], there[1], there[2]};
      });
  sim.run(s.duration - sim.time(), looks, sizes,
          silt::breakage_table(options.out + "/breakage.csv", silt::every(s.duration / 50)),
          silt::vtk_series(options.out + "/vtk", silt::every(s.duration / 10)),
          silt::checkpoints(options.out + "/last.silt", silt::every(s.duration / 5)),
          silt::progress());
  silt::write_particles(options.out + "/end.vtp", sim);
  write_tables(options.out, s, sim, watch.mean());

  example::Summary summary;
  add_inputs(summary, s);
  add_results(summary, sim, watch);
  summary.result("wall_time_s", whole.seconds());
  check_run(summary, sim, watch);
  summary.write(options.out + "/summary.json");
  const auto m = sim.mass_balance();
  std::printf("\nBroken: %.0f at walls, %.0f on each other. Of %.2f mg fed, %.1f %% are dust.\n",
              static_cast<double>(sim.broken(silt::BreakCause::Wall)),
              static_cast<double>(sim.broken(silt::BreakCause::Pair)), 1e6 * m.fed,
              100 * m.dust / m.fed);
  const bool drawn = example::run_script(
      SILT_JET_MILL_SCRIPT, {options.out, silt::text(s.radius), silt::text(s.outlet),
                             silt::text(s.post), silt::text(s.nozzle), silt::text(s.offset)});
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/breakage.csv, %s/product.csv, %s/summary.json\n",
              drawn ? (options.out + "/mill.png, " + options.out + "/milling.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace jet_mill

int main(int argc, char** argv) {
  example::Command command("A spiral jet mill: grains break at its wall and on each other");
  jet_mill::Scene scene;
  command.add("--jets", scene.jets, 20, 200, "Speed of the gas in the nozzles [m/s]");
  command.add("--rate", scene.rate, 1e-5, 1e-2, "Feed rate [kg/s]");
  command.add("--strength", scene.strength, 1e-3, 1e3, "Median strength of grains of 0.3 mm [N]");
  double dust = 1e6 * scene.dust, softened = 2e6 * scene.full_radius;
  command.add("--dust", dust, 5, 250, "Diameter below which fragments are dust [um]");
  command.add("--softened", softened, 0, 300, "Diameter below which grains are softened [um]");
  command.add("--duration", scene.duration, 1e-4, 10, "Duration [s]");
  bool fine = false;
  command.add_flag("--fine", fine, "Flow cells of 0.5 mm instead of 1 mm");
  return command.run(argc, argv, [&] {
    if (command.options.quick && !command.given("--duration")) scene.duration = 5e-3;
    if (fine) scene.cell = 0.5e-3;
    scene.dust = 1e-6 * dust, scene.full_radius = 0.5e-6 * softened;
    return jet_mill::simulate(scene, command.options);
  });
}
