// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: summary.json with its checks, pictures.

#include <cmath>
#include <string>

#include "conveyor/measure.hpp"
#include "support/example.hpp"

namespace conveyor {

inline void add_inputs(example::Summary& summary, const Scene& s) {
  summary.input("feed_kg_s", s.rate);
  summary.input("upper_belt_m_s", s.upper);
  summary.input("lower_belt_m_s", s.lower);
  summary.input("plate_mass_kg", s.plate_mass);
  summary.input("steady_from_s", s.steady());
  summary.input("measured_s", s.measured);
}

template <class Sim>
void add_results(example::Summary& summary, const Scene& s, const Sim& sim, const Steady& m) {
  summary.result("fed_kg_s", m.in);
  summary.result("carried_off_kg_s", m.off);
  summary.result("spilled_kg", sim.outlet(1).mass);
  summary.result("grains_at_the_end", static_cast<double>(sim.size()));
  summary.result("leaves_with_m_s", m.leaves_with);
  summary.result("age_at_the_end_of_the_belts_s", m.age);
  summary.result("upper_belt_w", m.upper * s.upper);
  summary.result("lower_belt_w", m.lower * s.lower);
  summary.result("upper_belt_w_over_feed_times_speed_squared", m.upper / (m.in * s.upper));
  summary.result("plate_hangs_at_deg", m.hangs);
  summary.result("grains_turn_the_plate_by_n_m", m.turned_by);
  summary.result("its_weight_turns_it_by_n_m", m.weight_turns);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("steps", static_cast<double>(sim.step()));
}

template <class Sim>
void check_run(example::Summary& summary, const Scene& s, const Sim& sim, const Steady& m) {
  const double scatter = s.scatter(s.measured);
  summary.check_within("fed_kg_s", m.in, s.rate, 4 * scatter * s.rate,
                       "four standard deviations of grains of random masses");
  summary.check_within("carried_off_over_fed", m.off / m.in, 1, 3 * std::sqrt(2.0) * scatter,
                       "three, as those that leave came earlier than those that come");
  const auto gone = sim.outlet(0).count + sim.outlet(1).count;
  summary.check_within(
      "grains_held_and_gone_over_placed",
      static_cast<double>(sim.size() + gone) / static_cast<double>(sim.inlet(0).placed), 1, 0,
      "numbers");
  summary.check_within(
      "mass_held_and_gone_over_fed",
      (Held(sim).mass + sim.outlet(0).mass + sim.outlet(1).mass) / sim.inlet(0).mass, 1, 1e-10,
      "rounding of sums");
  summary.check_within("torque_on_plate_over_weight", m.turned_by / m.weight_turns, 1, 0.05,
                       "it still swings at the ends of the interval");
  summary.check_within("push_of_walls_over_momentum_carried_off", m.push / (m.off * m.leaves_with),
                       1, scatter + 0.05, "what is on the belts has changed by the end");
  summary.check_within(
      "push_of_upper_belt_and_skirts_over_feed_times_speed", m.upper_push / (m.in * s.upper), 1,
      scatter + 0.05,
      "what is on the belt has changed by the end; grains come with no speed along it");
  summary.check_at_most("spilled_over_fed", sim.outlet(1).mass / sim.inlet(0).mass, 0.01);
}

/// Pictures of a run whose tables and files are there; false if they could not be drawn.
inline bool draw_run(const std::string& out) {
  return example::draw({"draw", out + "/end.vtp", "--colour", "age", "--walls", out + "/walls.vtp",
                        "--title", "Ore, by its age", "--out", out + "/transfer.png"}) &&
         example::draw({"curves", out + "/transfer.csv", "--x", "time", "--y",
                        "fed,held,carried off", "--y-label", "mass [kg]", "--title", "Mass",
                        "--out", out + "/mass.png"}) &&
         example::draw({"curves", out + "/transfer.csv", "--x", "time", "--y", "angle of the plate",
                        "--title", "The plate", "--out", out + "/plate.png"}) &&
         example::draw({"curves", out + "/upper_belt.csv", out + "/lower_belt.csv", "--labels",
                        "upper belt", "lower belt", "--x", "time", "--y", "force x,force y",
                        "--y-label", "force of the ore [N]", "--title",
                        "Forces of the ore on the belts", "--out", out + "/belts.png"}) &&
         example::draw({"draw", out + "/contacts.vtp", "--walls", out + "/walls.vtp", "--title",
                        "Contact forces at the end", "--out", out + "/chains.png"});
}

}  // namespace conveyor
