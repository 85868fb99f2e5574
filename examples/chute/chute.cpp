// silt - BSD-3-Clause, see LICENSE
//
// Wear of a transfer chute: ore falls onto a steep steel plate, slides down, passes a bend and
// leaves. A batch is fed and leaves entirely: the whole batch has passed each place. Wear by
// sliding (Archard) and by impacts (Finnie) is compared with values from contacts and impacts
// recorded by other means, with the friction work, and with a sliding block.
//
// The set-up is scene.hpp; measure.hpp has what is measured and closed forms, report.hpp tables and
// checks.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "chute/measure.hpp"
#include "chute/report.hpp"
#include "chute/scene.hpp"
#include "support/example.hpp"

namespace chute {
namespace {

/// Feeds the batch until all of it has left; returns the outflow [kg/s] in the steady part.
template <class Sim>
double run(Sim& sim, const Scene& s, const std::string& out, Seen& seen) {
  auto contacts =
      silt::at(silt::every(Seen::sample), [&](const auto& now) { seen.read_contacts(now, s); });
  const auto impacts = silt::on_contact_begin([&](const silt::ContactEvent& c) {
    if (c.wall != silt::no_wall && c.normal_speed > 0) seen.note(c, sim.mass(sim.find(c.a)), s);
  });
  auto table =
      silt::table(out + "/worn.csv",
                  {"time [s]", "in the scene [-]", "left [kg]", "sliding [mm3]", "impacts [mm3]"},
                  silt::every(0.01), [](const auto& now) {
                    return std::array<double, 5>{now.time(), static_cast<double>(now.size()),
                                                 now.outlet(0).mass,
                                                 1e9 * silt::worn_volume<Sliding>(now, "chute"),
                                                 1e9 * silt::worn_volume<Cutting>(now, "chute")};
                  });
  auto series = silt::vtk_series(out + "/vtk", silt::every(0.05));
  const auto go_on = [&](double time) {
    sim.run(time, table, contacts, impacts, series, silt::progress());
  };
  const double feeding = s.batch / s.rate, filled = std::min(0.5 * feeding, 0.8);  // [s]
  go_on(filled);
  const double before = sim.outlet(0).mass;
  go_on(feeding - filled);
  const double flow = (sim.outlet(0).mass - before) / (sim.time() - filled);
  silt::write_particles(out + "/flow.vtp", sim);
  while (sim.size() > 0 && sim.time() < feeding + 5) go_on(0.1);
  silt::write_wear<Sliding>(out + "/sliding.vtp", sim, "chute");
  silt::write_wear<Cutting>(out + "/impacts.vtp", sim, "chute");
  return flow;
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  Seen seen{Worn(s), Worn(s)};
  const double flow = run(sim, s, options.out, seen);
  const Worn slid = worn_by<Sliding>(sim, s), cuts = worn_by<Cutting>(sim, s);
  const double fed = sim.outlet(0).mass, grains = static_cast<double>(sim.inlet(0).placed);
  write_tables(s, options.out, slid, cuts, seen, fed);

  example::Summary summary;
  add_inputs(summary, s);
  summary.result("sliding_mm3_per_t", 1e12 * slid.all / fed);
  summary.result("impacts_mm3_per_t", 1e12 * cuts.all / fed);
  summary.result("grains", grains);
  summary.result("flow_kg_s", flow);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_at_most("grains_lost", grains - static_cast<double>(sim.outlet(0).count), 0);
  summary.check_within("mass_over_grains_times_mean", fed / (grains * s.mean_mass()), 1,
                       1.05 / std::sqrt(grains), "three standard errors of the sizes drawn");
  summary.check_within("flow_out_over_rate", flow / s.rate, 1, 0.05,
                       "sizes drawn, and what is in the chute, vary");
  check_wear(summary, s, slid, cuts, seen, silt::worn_volume<Rubbing>(sim, "chute"), fed);
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(SILT_CHUTE_SCRIPT, {options.out, silt::text(1e11 / fed)});
  std::printf("\n%.3g kg have slid down: %.3g mm3/t worn by sliding, %.3g mm3/t by impacts.\n", fed,
              1e12 * slid.all / fed, 1e12 * cuts.all / fed);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk, %s/sliding.vtp (ParaView), %s/profile.csv, %s/summary.json\n",
              drawn ? (options.out + "/wear.png, " + options.out + "/profile.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace chute

int main(int argc, char** argv) {
  example::Command command("Wear of a transfer chute by sliding and impacts");
  chute::Scene scene;
  command.leave_out("--restart");
  command.add("--batch", scene.batch, 0.5, 1000, "Mass of the batch [kg]");
  command.add("--rate", scene.rate, 0.1, 5, "Feed rate [kg/s]");
  command.add("--friction", scene.friction, 0.1, 0.45, "Friction of ore on steel [-]");
  command.add("--steep", scene.steep, 45, 65, "Slope of the plate [degrees]");
  command.add("--facet", scene.facet, 2e-3, 0.02, "Size of the mesh's facets [m]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--batch")) scene.batch = 2;
      if (!command.given("--rate")) scene.rate = 1.2;
      scene.width = 0.07;
    }
    return chute::simulate(scene, command.options);
  });
}
