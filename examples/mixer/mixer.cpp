// silt - BSD-3-Clause, see LICENSE
//
// A bladed mixer. Grains of two colours lie side by side, and two blades stir them: in one run at a
// fixed speed, in the other with a fixed torque (ServoTorque). Then the tilted blades are raised
// until they are upright (set_mesh). Results: torque, angle and power over time, and Lacey's mixing
// index, of the colours and of layers that were initially on top of one another.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp the checks.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "mixer/measure.hpp"
#include "mixer/report.hpp"
#include "mixer/scene.hpp"
#include "support/example.hpp"

namespace mixer {
namespace {

/// A run of the filled mixer: at a fixed speed, or with a torque `target` [N m]; `more` for upright
/// blades.
Run mix(const Scene& s, const std::string& file, double target, double more,
        const example::Options& options) {
  Run run;
  run.name = target == 0 ? "speed" : "torque", run.target = target, run.more = more;
  std::printf("fixed %s\n", run.name.c_str());
  auto sim = make_mixer(s, options.threads);
  sim.remove_wall("chute");
  silt::load_checkpoint(sim, file, {.motions = true});
  const Kinds kinds(sim, s);
  run.mass_before = sim.total_mass();
  run.start = kinds.mixed(sim, kinds.right).index();
  run.start_layers = kinds.mixed(sim, kinds.upper).index();
  const bool pictures = target == 0;
  if (pictures) picture(sim, kinds, options.out + "/start");
  if (target == 0)
    sim.set_motion("blade", turning(sim.time(), s.rate()));
  else
    sim.set_drive("blade", motor(s, target));
  Watch watch(sim, s, kinds, options.out + "/index_" + run.name + ".csv");
  auto series =
      silt::wall_series(options.out + "/blade_" + run.name + ".csv", "blade", silt::every(10e-3));
  run.stages.push_back(watch.stage("first turn", s.turn(), series));
  if (pictures) picture(sim, kinds, options.out + "/one");
  run.stages.push_back(watch.stage("blades laid back", (s.turns - 1) * s.turn(), series));
  if (pictures) picture(sim, kinds, options.out + "/mixed");
  // The blades are raised over half the time of a turn, from rest to rest.
  const double from = sim.time(), raised = 0.5 * s.turn();
  auto raise = silt::at(silt::every(0.5 * sim.step_length()), [&](auto& at) {
    const double share = std::min((at.time() + at.step_length() - from) / raised, 1.0);
    at.set_mesh("blade", blades(s, s.slant_after(share)));
  });
  run.stages.push_back(watch.stage("blades are raised", raised, series, raise));
  if (target != 0) {
    run.stages.push_back(watch.stage("blades upright, same torque", 0.5 * s.turn(), series));
    sim.set_drive("blade", motor(s, more));
  }
  run.stages.push_back(watch.stage("blades upright", s.pitched * s.turn(), series));
  if (pictures) picture(sim, kinds, options.out + "/end");
  look_back(sim, s, kinds, run);
  return run;
}

int simulate(const Scene& s, const example::Options& options) {
  silt::make_folder(options.out);
  const example::Stopwatch watch;
  const std::string file = options.out + "/charged.silt";
  charge(s, options.threads, file);
  std::printf("charged after %.0f s\n", watch.seconds());
  std::vector<Run> runs{mix(s, file, 0, 0, options)};
  runs.push_back(mix(s, file, s.share * runs[0].stages[1].torque,
                     s.share * runs[0].stages.back().torque, options));
  example::Summary summary;
  add_inputs(summary, s, runs[1].target);
  for (const Run& run : runs) check(summary, run, options.quick);
  compare_speeds(summary, s, runs[0], runs[1]);
  summary.result("seconds", watch.seconds());
  summary.write(options.out + "/summary.json");
  summary.print_checks();
  example::run_script(SILT_MIXER_SCRIPT, {options.out, silt::text(s.radius),
                                          silt::text(runs[1].target), silt::text(runs[1].more)});
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace mixer

int main(int argc, char** argv) {
  example::Command command(
      "A bladed mixer at a fixed speed and with a fixed torque: torque, power, "
      "Lacey's index of mixing",
      example::Kind::Cases, "out/mixer");
  mixer::Scene s;
  command.add("--grains", s.grains, 200, 100000, "Number of grains");
  command.add("--rpm", s.rpm, 10, 120, "Speed of the run at a fixed speed [1/min]");
  command.add("--turns", s.turns, 1.5, 100,
              "Turns of that run before the blades are raised; the other run takes the same time");
  command.add("--raised", s.pitched, 0.2, 100,
              "Turns of that run after the blades are raised; the other run takes the same time");
  command.add("--friction", s.friction, 0, 2, "Friction between grains [-]");
  command.add("--wall-friction", s.wall_friction, 0, 2, "Friction on vessel and blades [-]");
  command.add("--share", s.share, 0.2, 3,
              "Torque of the other run over the mean torque at the fixed speed");
  command.add("--gain", s.gain, 1e-3, 1, "Gain of its servo [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    if (options.quick) {
      if (!command.given("--grains")) s.grains = 700;
      if (!command.given("--turns")) s.turns = 2;
      if (!command.given("--raised")) s.pitched = 0.5;
      s.radius = 42e-3;
    }
    return mixer::simulate(s, options);
  });
}
