// silt - BSD-3-Clause, see LICENSE
//
// Dilute pneumatic conveying through a bend of 90 degrees: air and spheres from a horizontal pipe
// into a vertical one (hv), from a vertical pipe into a horizontal one (vh), or from horizontal to
// horizontal (hh). Behind the bend, particles form a rope along its outer wall, which disperses.
// Two runs: in the simplified model the gas sees the drag of the particles but not their volume, in
// the traditional, volume-averaged model both. Pipe of 50 mm; the same mesh, generated here, is the
// wall for particles and gas.
//
// The pipe starts along x, bends about z and continues along y; only gravity differs. The set-up is
// scene.hpp; measure.hpp has what is measured, report.hpp tables and checks.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "bend/measure.hpp"
#include "bend/report.hpp"
#include "bend/scene.hpp"
#include "support/example.hpp"

namespace bend {
namespace {

/// One model of the gas.
Run run(const Scene& s, const example::Options& options, bool simplified) {
  const std::string name = simplified ? "simplified" : "traditional";
  std::printf("%s model\n", name.c_str());
  const example::Stopwatch watch;
  auto sim =
      make_simulation(s, simplified ? silt::MomentumModel::Simplified : silt::MomentumModel::A);
  sim.threads = options.threads;

  Run done{Measured(s)};
  double samples = 0;
  const silt::Grid& grid = sim.fluid().flow().grid();
  const int middle = grid.nz() / 2, column = static_cast<int>((0 - grid.box().min.y) / s.cell());
  auto sample = silt::at(silt::every(2e-3), [&](const auto& now) {
    done.clipped = std::max(done.clipped, now.fluid().last_step().clipped);
    if (now.time() < s.from()) return;
    done.measured.add(now);
  });
  // Particles that appear at the inlet displace gas instantly, which gives pressure noise in the
  // traditional model. The pressure is therefore averaged at times unrelated to the inlet's.
  auto pressures = silt::at(silt::every(1.37e-4), [&](const auto& now) {
    if (now.time() < s.from()) return;
    done.drop += now.fluid().flow().pressure()(1, column, middle), ++samples;
  });
  sim.run(s.duration, sample, pressures, silt::progress());
  silt::write_particles(options.out + "/" + name + ".vtp", sim);

  const auto& flow = sim.fluid().flow();
  const double in = flow.flow_rate(0, 0), out = flow.flow_rate(1, flow.grid().ny());
  done.flow_error = std::abs(out / in - 1);
  done.y_plus = flow.wall_units().mean;
  done.drop /= std::max(1.0, samples);
  done.placed = static_cast<double>(sim.inlet(0).placed);
  done.left = static_cast<double>(sim.outlet(0).count);
  done.inside = static_cast<double>(sim.size());
  done.fluid_steps = static_cast<double>(sim.fluid().fluid_steps());
  done.seconds = watch.seconds();
  return done;
}

int simulate(const Scene& s, const example::Options& options) {
  silt::make_folder(options.out);
  const Run simple = run(s, options, true), full = run(s, options, false);
  write_tables(options.out, simple, full);
  example::Summary summary;
  add_inputs(summary, s, options.threads);
  report_run(summary, simple, "simplified"), report_run(summary, full, "traditional");
  compare_models(summary, s, simple, full);
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(SILT_BEND_SCRIPT, {options.out, s.kind});
  print_runs(s, simple, full);
  summary.print_checks();
  std::printf("Look at: %s%s/across.csv, %s/along.csv, %s/points.csv, %s/summary.json\n",
              drawn ? (options.out + "/bend.png, ").c_str() : "", options.out.c_str(),
              options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace bend

int main(int argc, char** argv) {
  example::Command command("Pneumatic conveying through a bend: two models of the gas",
                           example::Kind::Run, "out/bend");
  bend::Scene scene;
  command.leave_out("--restart");
  command.add(
      "--case", scene.kind, {"hv", "vh", "hh"},
      "Bend from horizontal to vertical, vertical to horizontal, or horizontal to horizontal");
  command.add("--closure", scene.closure, {"mixing-length", "k-epsilon"},
              "Turbulence closure of the gas");
  command.add("--cells", scene.cells, 5, 20, "Cells of the gas per diameter");
  command.add("--duration", scene.duration, 0.05, 10,
              "Duration [s]; the last three fifths are measured");
  command.add_flag("--full", scene.full,
                   "Pipes of 0.5 and 1 m, 3 s, 12 cells per diameter, as published");
  return command.run(argc, argv, [&] {
    if (scene.full) {
      scene.inlet = 0.5, scene.outlet = 1;
      if (!command.given("--duration")) scene.duration = 3;
      if (!command.given("--cells")) scene.cells = 12;
    }
    if (command.options.quick) {
      silt::require(!scene.full, "--quick and --full are two things; take one");
      scene.inlet = 0.1, scene.outlet = 0.1;
      if (!command.given("--duration")) scene.duration = 0.12;
      if (!command.given("--cells")) scene.cells = 5;
    }
    return bend::simulate(scene, command.options);
  });
}
