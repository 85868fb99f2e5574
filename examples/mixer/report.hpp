// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of the runs: particles with their colours, summary.json with its checks.

#include <string>
#include <vector>

#include "mixer/measure.hpp"
#include "support/example.hpp"

namespace mixer {

/// Grains with their colour and layer, and the walls.
template <class Sim>
void picture(const Sim& sim, const Kinds& kinds, const std::string& name) {
  std::vector<int> colour, layer;
  silt::write_particles(name + ".vtp", sim, [&](const auto& of, auto& fields, const auto& places) {
    for (const auto k : places)
      colour.push_back(kinds.right[of.id(k)]), layer.push_back(kinds.upper[of.id(k)]);
    fields.add("colour", colour), fields.add("layer", layer);
  });
  silt::write_walls(name + "_walls.vtp", sim);
}

/// torque: of the servo [N m]
inline void add_inputs(example::Summary& summary, const Scene& s, double torque) {
  summary.input("grains", static_cast<double>(s.grains)), summary.input("rpm", s.rpm);
  summary.input("radius of the vessel [mm]", 1e3 * s.radius);
  summary.input("mean radius of the grains [mm]", 1e3 * s.grain);
  summary.input("friction", s.friction), summary.input("wall friction", s.wall_friction);
  summary.input("gain of the servo", s.gain);
  summary.input("torque of the servo [N m]", torque);
}

/// Results and checks of one run.
inline void check(example::Summary& summary, const Run& run, bool quick) {
  const std::string name = run.target == 0 ? "fixed speed: " : "fixed torque: ";
  summary.result(name + "samples", run.samples);
  summary.result(name + "grains a sample", run.grains_a_sample);
  summary.check_at_most(name + "index of colours at the start", run.start, 1e-9);
  summary.check_at_most(name + "index of layers at the start", run.start_layers, 1e-9);
  summary.check_within(name + "index of random mixtures", run.random[0], 1, 4 * run.random[1],
                       "four standard errors of 100 mixtures");
  double given = 0, booked = 0;
  for (const Stage& t : run.stages) {
    const std::string of = name + t.name + ": ";
    summary.result(of + "torque [N m]", t.torque);
    summary.result(of + "its deviation over 5 ms, of the mean", t.swing / t.torque);
    summary.result(of + "speed [1/min]", 60 * t.rate());
    summary.result(of + "power [W]", t.work / t.seconds);
    summary.result(of + "index of colours", t.index);
    summary.result(of + "index of layers", t.layers);
    given += t.given, booked += t.booked;
    // While the blades are raised, work is also done at their hinges.
    if (t.name == "blades are raised") continue;
    if (run.target == 0)
      summary.check_within(of + "torque times angle over energy held and dissipated",
                           t.work / t.booked, 1, 1e-3, "error of the ledger");
    else
      summary.result(of + "torque times angle over energy held and dissipated", t.work / t.booked);
  }
  summary.check_within(name + "work of the blades over energy held and dissipated, all",
                       given / booked, 1, 1e-3, "error of the ledger");
  if (run.target != 0) {
    summary.check_within(name + "torque over that of the servo, blades laid back",
                         run.stages[1].torque / run.target, 1, 0.01, "slides of the bed");
    summary.check_within(name + "torque over that of the servo, blades upright",
                         run.stages.back().torque / run.more, 1, 0.03, "slides of the bed");
    summary.check_at_most(name + "speed over that with more torque, blades upright",
                          run.stages[3].rate() / run.stages[4].rate(), 0.1);
  }
  summary.check_at_least(name + "index of colours at the end", run.stages.back().index,
                         quick ? 0.6 : 0.95);
  summary.check_at_most(name + "grains outside", run.lost, 0);
  summary.check_within(name + "mass at the end over that at the start", run.mass / run.mass_before,
                       1, 1e-14, "rounding of the sum");
  summary.check_at_most(name + "mean overlap over mean diameter", run.overlap, 0.01);
}

/// The torque of a flowing bed hardly depends on the speed: 1 % more at 8 % more speed.
inline void compare_speeds(example::Summary& summary, const Scene& s, const Run& speed,
                           const Run& torque) {
  const double speeds = torque.stages[1].rate() / speed.stages[1].rate();
  const std::string name = "fixed torque: speed over the fixed one, blades laid back";
  if (s.share == 1)
    summary.check_within(name, speeds, 1, 0.25, "3 % of the torque");
  else
    summary.result(name, speeds);
}

}  // namespace mixer
