// silt - BSD-3-Clause, see LICENSE
//
// Powder on a vibrated metal plate: contacts charge the grains until their own charge prevents
// further transfer. Then the plate is turned over: image forces hold small grains, large ones fall.
//
// The frame is that of the plate, as image planes cannot move; vibration is a body force in it. The
// grains are soft, and an impact charges them (E/E_soft)^(2/5) times as much as the real solid:
// --area-factor corrects this. Van der Waals forces, which also hold such grains, and air are left
// out.

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/silt.hpp>

#include "charged_powder/measure.hpp"
#include "charged_powder/scene.hpp"
#include "support/example.hpp"

namespace {

using powder::Scene, powder::Charges, powder::Sticking;
using silt::ElectricCharge;

template <class Sim>
void write_grains(const std::string& path, const Sim& sim) {
  std::vector<double> charge;
  silt::write_particles(path, sim,
                        [&](const auto& at, silt::VtkFields& fields, const auto& places) {
                          for (const auto k : places)
                            charge.push_back(1e15 * at.template field<ElectricCharge>(k));
                          fields.add("charge [fC]", charge);
                        });
}

/// Vibrates the plate, and turns it over when the grains are at rest.
template <class Sim>
Sticking run(Sim& sim, const Scene& s, const std::string& out, Charges& charges) {
  const auto count = silt::on_contact_begin([&](const silt::ContactEvent& c) {
    if (c.wall != silt::no_wall && c.normal_speed > 0)
      charges.impacts[c.a] += s.charging(sim.radius(sim.find(c.a)), c.normal_speed);
  });
  auto table =
      silt::table(out + "/charge.csv", {"time [s]", "mean of all grains", "closed form"},
                  silt::every(2e-3), [&](const auto& now) {
                    charges.look(now);
                    return std::array<double, 3>{now.time(), charges.sum / charges.saturation,
                                                 charges.expected / charges.saturation};
                  });
  auto series = silt::vtk_series(out + "/vtk", silt::every(0.01));
  sim.run(s.early(), count, table, series, silt::progress());
  write_grains(out + "/early.vtp", sim);
  sim.run(s.shaken + s.rest - sim.time(), count, table, series, silt::progress());
  write_grains(out + "/charged.vtp", sim);
  charges.look(sim);

  std::vector<double> radius(s.particles), hold(s.particles);  // [m], [-] of each id
  for (std::size_t k = 0; k < sim.rows(); ++k)
    radius[sim.id(k)] = sim.radius(k),
    hold[sim.id(k)] = s.image_over_weight(sim.radius(k), sim.template field<ElectricCharge>(k));
  sim.gravity = {0, 0, s.g};
  sim.add_outlet({{-1, -1, 20 * s.r_max}, {1, 1, 1}});
  sim.run(s.falling, series, silt::progress());
  write_grains(out + "/turned.vtp", sim);
  Sticking sticking;
  for (std::size_t id = 0; id < s.particles; ++id) {
    const std::size_t k = sim.find(static_cast<silt::ParticleId>(id));
    sticking.add(s, radius[id], hold[id], k < sim.rows() && sim.position(k).z < 2 * s.r_max);
  }
  sticking.write(s, out + "/sticking.csv");
  return sticking;
}

bool draw(const Scene& s, const std::string& out) {
  return example::draw({"draw", out + "/early.vtp", out + "/charged.vtp", out + "/turned.vtp",
                        "--colour", "charge [fC]", "--view", "top", "--title",
                        silt::text("Shaken for ", s.early(), " s"),
                        silt::text("Shaken for ", s.shaken, " s"), "Stick to the plate turned over",
                        "--out", out + "/powder.png"}) &&
         example::draw({"curves", out + "/charge.csv", "--x", "time", "--y",
                        "mean of all grains,closed form", "--y-label",
                        "charge over its largest value", "--title",
                        "Charging by contact with a shaken plate", "--out", out + "/charge.png"}) &&
         example::draw({"curves", out + "/sticking.csv", "--x", "radius", "--y",
                        "by their own image", "--marks", "that stick", "--marks-label",
                        "that stick", "--y-label", "share of the grains [%]", "--title",
                        "Who stays on a plate that is turned over", "--out",
                        out + "/sticking.png"});
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  Charges charges(s);
  const Sticking sticking = run(sim, s, options.out, charges);
  const double share = charges.sum / charges.saturation, grains = static_cast<double>(s.particles);

  example::Summary summary;
  summary.input("particles", grains);
  summary.input("radius_min_m", s.r_min);
  summary.input("radius_max_m", s.r_max);
  summary.input("shaken_s", s.shaken);
  summary.input("frequency_hz", s.frequency);
  summary.input("speed_m_s", s.speed);
  summary.input("voltage_v", s.voltage);
  summary.input("transfer_distance_m", s.delta);
  summary.input("area_factor", s.area_factor);
  summary.result("charge_of_all_c", charges.sum);
  summary.result("charge_over_saturation", share);
  summary.result("grains_that_stick", sticking.sum);
  summary.result("radius_at_limit_m", s.radius_at_limit(share));
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_within("charge_over_that_of_the_plate", charges.sum / charges.given, 1, 1e-9,
                       "rounding: what one end of a contact gets the other loses");
  // Charging stops at the contact potential difference: no grain exceeds that charge.
  summary.check_at_most("largest_charge_over_saturation", charges.most, 1);
  summary.check_within("charge_over_closed_form", charges.sum / charges.expected, 1, 0.02,
                       "overlaps are those of free impacts, and rest and other grains add to them");
  summary.check_at_most("charge_off_closed_form_at_any_time", charges.off, 0.02);
  summary.check_at_most("grains_lost",
                        grains - static_cast<double>(sim.size() + sim.outlet(0).count), 0);
  // Near the limit, images of other grains can hold a grain too: those within 10 % are not judged,
  // and a few more are tolerated.
  summary.check_at_most("grains_not_as_their_image_says", sticking.wrong / sticking.judged, 0.05);
  summary.check_at_least("grains_that_stick", sticking.sum, 1);
  summary.check_at_least("grains_that_fall", grains - sticking.sum, 1);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw(s, options.out);
  std::printf(
      "\n%.3g pC on %zu grains, %.1f %% of what they take; %.0f stick to the plate turned over.\n",
      1e12 * charges.sum, s.particles, 100 * share, sticking.sum);
  summary.print_checks();
  const std::string& out = options.out;
  std::printf(
      "Look at: %s%s/vtk (ParaView), %s/charge.csv, %s/sticking.csv, %s/summary.json\n",
      drawn ? (out + "/powder.png, " + out + "/charge.png, " + out + "/sticking.png, ").c_str()
            : "",
      out.c_str(), out.c_str(), out.c_str(), out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Powder that charges on a shaken plate, and sticks to it");
  Scene scene;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 50, 20000, "Number of grains");
  command.add("--shaken", scene.shaken, 0.01, 100, "Time for which the plate is shaken [s]");
  command.add("--voltage", scene.voltage, 0.05, 2,
              "Work function of the plate less that of the powder [eV]");
  command.add("--area-factor", scene.area_factor, 1e-3, 100,
              "Ratio of the area that charges to the contact area");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 100;
      if (!command.given("--shaken")) scene.shaken = 1.2;
      if (!command.given("--area-factor")) scene.area_factor = 2;
    }
    return simulate(scene, command.options);
  });
}
