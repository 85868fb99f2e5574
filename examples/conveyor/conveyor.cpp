// silt - BSD-3-Clause, see LICENSE
//
// A transfer point between two belts. Ore and fines enter on a belt, which throws them at a hinged
// plate; they fall onto a second belt, which carries them away at a right angle. Results of
// interest for a plant: throughput, residence time, power of the belts, and position of the plate.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp pictures and checks.

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "conveyor/measure.hpp"
#include "conveyor/report.hpp"
#include "conveyor/scene.hpp"
#include "support/example.hpp"

namespace conveyor {
namespace {

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  const std::string& out = options.out;

  SteadyFlow steady(s, sim);
  auto means = silt::at(silt::every(0.005), [&](const auto&) { steady.look(); });
  auto table =
      silt::table(out + "/transfer.csv",
                  {"time [s]", "fed [kg]", "held [kg]", "carried off [kg]", "spilled [kg]",
                   "angle of the plate [deg]"},
                  silt::every(0.02), [](const auto& at) {
                    return std::array{at.time(),         at.inlet(0).mass,
                                      Held(at).mass,     at.outlet(0).mass,
                                      at.outlet(1).mass, at.wall("plate").state.way * 180 / M_PI};
                  });
  auto frames = silt::vtk_series(out + "/vtk", silt::every(0.05));
  auto drive_upper = silt::wall_series(out + "/upper_belt.csv", "upper belt", silt::every(0.05));
  auto drive_lower = silt::wall_series(out + "/lower_belt.csv", "lower belt", silt::every(0.05));
  const auto run = [&](double duration, auto&&... more) {
    sim.run(duration, table, means, frames, drive_upper, drive_lower,
            silt::on_failure(out + "/failed", silt::every(0.5)), silt::progress(), more...);
  };
  run(s.steady());
  steady.begin();
  run(s.measured, silt::contact_series(out + "/vtk", silt::every(0.05)));
  const Steady m = steady.read(s.measured);

  example::Summary summary;
  add_inputs(summary, s);
  add_results(summary, s, sim, m);
  summary.result("wall_time_s", whole.seconds());
  check_run(summary, s, sim, m);
  summary.write(out + "/summary.json");
  silt::write_particles(out + "/end.vtp", sim);
  silt::write_walls(out + "/walls.vtp", sim);
  silt::write_contacts(out + "/contacts.vtp", sim);
  const bool drawn = draw_run(out);
  std::printf(
      "\n%.3g kg/s come and %.3g leave, %.3g s later; the belts need %.3g W, the plate hangs at "
      "%.3g degrees.\n",
      m.in, m.off, m.age, m.power(s), m.hangs);
  summary.print_checks();
  const auto named = [&](const char* file) { return out + "/" + file; };
  std::printf(
      "Look at: %s%s (ParaView), %s, %s, %s\n",
      drawn ? (named("transfer.png") + ", mass.png, plate.png, belts.png, chains.png, ").c_str()
            : "",
      named("vtk").c_str(), named("transfer.csv").c_str(), named("upper_belt.csv").c_str(),
      named("summary.json").c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace conveyor

int main(int argc, char** argv) {
  example::Command command("A transfer of ore between two conveyor belts, by a hinged plate");
  conveyor::Scene scene;
  command.leave_out("--restart");
  command.add("--rate", scene.rate, 0.1, 20, "Feed rate [kg/s]");
  command.add("--upper", scene.upper, 0.2, 3, "Speed of the upper belt [m/s]");
  command.add("--lower", scene.lower, 0.2, 3, "Speed of the lower belt [m/s]");
  command.add("--plate", scene.plate_mass, 0.2, 50, "Mass of the hinged plate [kg]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--rate")) scene.rate = 0.6;
      scene.measured = 1.5;
    }
    return conveyor::simulate(scene, command.options);
  });
}
