// silt - BSD-3-Clause, see LICENSE
//
// Hopper discharge at the scale of D. Markauskas, A. Kaceniauskas, A. Maknickas, Information
// Technology and Control 40 (2011) 287: 100 000 or 300 000 spheres settle in a square hopper, the
// orifice of 40 x 40 mm opens, and they flow into an identical box below. What the paper does not
// give (density, Poisson ratio, sizes of the boxes) is stated here. With --silo a round silo above
// a cone instead, and its wall pressure (silo.cpp).
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp pictures and checks.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <type_traits>

#include "hopper/measure.hpp"
#include "hopper/report.hpp"
#include "hopper/scene.hpp"
#include "hopper/silo.hpp"
#include "support/example.hpp"

namespace {

using namespace hopper;

/// The rows of discharge.csv, which also go into `curve`.
auto discharge_table(const Scene& s, const std::string& path, std::int64_t step, Discharge& curve) {
  return silt::table(
      path,
      {"time [s]", "mass below [kg]", "particles below [-]", "contacts [-]", "kinetic energy [J]",
       "time per step [ms]"},
      silt::every(0.005),
      [&s, &curve, clock = example::Stopwatch(), step, before = 0.0](const auto& sim) mutable {
        const Below below(sim, s.orifice_height());
        const auto contacts = static_cast<double>(sim.touching_pairs());
        curve.most_contacts = std::max(curve.most_contacts, contacts);
        const double seconds = clock.seconds();
        const double steps = static_cast<double>(sim.step() - step);
        // The first row has no steps to time: nan, which pictures leave out.
        const double per_step = steps > 0 ? (seconds - before) / steps : std::nan("");
        step = sim.step(), before = seconds;
        const double since = sim.time() - s.settling_time();
        curve.time.push_back(since), curve.mass.push_back(below.mass);
        return std::array{std::round(1e9 * since) / 1e9,  // without digits of rounding
                          below.mass,
                          static_cast<double>(below.count),
                          contacts,
                          sim.kinetic_energy(),
                          1e3 * per_step};
      });
}

/// Runs from when the orifice has opened until nothing flows any more.
template <class Sim, class Checkpoints>
Discharge discharge(const Scene& s, Sim& sim, double total, const std::string& out,
                    Checkpoints& save, Pictures& pictures) {
  Discharge curve;
  auto table = discharge_table(s, out + "/discharge.csv", sim.step(), curve);
  // The flow field in the middle layer: means from the start of discharge until half of the mass
  // has passed.
  auto flow = silt::coarse_grained(middle_layer(s), silt::GaussianKernel{.width = 1.5e-3},
                                   silt::every(0.01));
  auto series = silt::vtk_series(out + "/vtk", silt::every(0.02), layers(s));
  const auto snapshot = [&](const std::string& name, double since) {
    pictures.grains.push_back(out + "/snapshot_" + name + ".vtp");
    pictures.titles.push_back(silt::text(since, " s after opening"));
    silt::write_particles(pictures.grains.back(), sim, layers(s));
  };
  const double opening = s.settling_time(), end = s.particles >= 200000 ? 6.0 : 3.0;  // [s]
  for (int k = 0; sim.time() < opening + end; ++k) {
    const double next = k < 4 ? opening + s.moments[k] : sim.time() + 0.1;
    if (next <= sim.time()) continue;  // before the restart
    if (k >= 1 && k < 3)
      sim.run(next - sim.time(), table, series, save, flow, silt::progress());
    else
      sim.run(next - sim.time(), table, series, save, silt::progress());
    if (k < 4) snapshot(silt::text(s.moments[k], "s"), s.moments[k]);
    if (k < 3 || curve.mass.size() <= 20) continue;
    const double lately = curve.mass.back() - curve.mass[curve.mass.size() - 20];
    if (curve.mass.back() > 0.99999 * total || lately < 1e-4 * total) break;
  }
  if (pictures.grains.empty()) snapshot("end", std::round(1e3 * (sim.time() - opening)) / 1e3);
  pictures.has_flow = flow.fields().samples() > 0;
  if (pictures.has_flow) flow.fields().write_csv(out + "/flow.csv");
  return curve;
}

template <class Precision>
int simulate(const Scene& scene, const example::Options& options) {
  const std::string precision = std::is_same_v<Precision, silt::Mixed> ? "mixed" : "double";
  const example::Stopwatch whole;
  auto sim = make_simulation(scene, Precision{});
  sim.threads = options.threads;
  const double opening = scene.settling_time();
  if (!options.restart.empty()) silt::load_checkpoint(sim, options.restart);
  silt::make_folder(options.out);

  example::Summary summary;
  add_inputs(summary, scene, precision, options);
  std::printf(
      "%zu spheres of 1.95-2.35 mm, %zu + %zu bytes a particle and contact, dt = %g s, %s "
      "precision\n",
      sim.size(), sim.bytes_per_particle, sim.bytes_per_contact, scene.time_step,
      precision.c_str());
  silt::write_stl(options.out + "/floor.stl", floor_triangles(scene));
  write_outlines(scene, options.out + "/outlines.vtp");
  auto save = silt::checkpoints(options.out + "/checkpoint.silt", silt::every(0.1));
  Pictures pictures;
  const double total = sim.total_mass();  // [kg]

  if (sim.time() < opening) {
    std::printf("filling\n");
    sim.run(opening - sim.time(), save, silt::progress());
  }
  const Rest rest = look_at_rest(scene, sim, total);
  if (sim.time() < opening + 0.5 * scene.time_step) {  // also of a checkpoint from before
    if (sim.has_contacts()) {
      pictures.has_chains = true;
      silt::write_contacts(options.out + "/contacts_at_rest.vtp", sim);
      report_contacts(summary, look_at_contacts(sim, total));
    }
    sim.remove_wall(lid);
  }

  std::printf("discharging\n");
  const Discharge curve = discharge(scene, sim, total, options.out, save, pictures);
  Outcome o{.total = total, .out = Below(sim, scene.orifice_height()).mass};
  o.rate = curve.rate(o.out);
  o.theory = beverloo(scene.orifice, scene.r_min + scene.r_max, rest.fraction * scene.density);
  const bool from_start = options.restart.empty();
  add_results(summary, sim, rest, curve, o, from_start);
  summary.result("wall_time_s", whole.seconds());
  summary.result("overlap_of_the_fall_over_radius", overlap_of_fall(scene));
  if (const auto limit = sim.time_step_limit(3.0))
    summary.result("time_step_over_limit", sim.step_length() / *limit);
  check_run(summary, scene, sim, rest, o, from_start);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_run(options.out, scene, pictures, o.theory);

  std::printf(
      "\nDischarge %.3f kg/s, Beverloo %.3f kg/s (ratio %.3f); %.1f %% of %.3f kg left the "
      "hopper in %.2f s.\nLargest overlap %.2f %% of the radius; %zu of %zu particles; %.0f s.\n",
      o.rate, o.theory, o.rate / o.theory, 100 * o.out / o.total, o.total,
      curve.time.empty() ? 0 : curve.time.back(), 100 * sim.peak_overlap(), sim.size(),
      scene.particles, whole.seconds());
  summary.print_checks();
  std::printf(
      "Look at: %s/%s\n         %s/vtk/particles.pvd (ParaView), %s/discharge.csv, "
      "%s/summary.json\n",
      options.out.c_str(),
      drawn ? "snapshots.png, flow.png, chains.png, discharge.png, contacts.png" : "",
      options.out.c_str(), options.out.c_str(), options.out.c_str());
  if (!drawn) std::printf("(no pictures: they need Python 3 with numpy and matplotlib)\n");
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Hopper discharge of 100 000 or 300 000 spheres into a box below");
  Scene scene;
  bool unsorted = false, mixed = false, round = false;
  double wall_friction = 0.3;
  command.add("--particles", scene.particles, 1000, 10000000, "Number of spheres");
  command.add("--density", scene.density, 1, 20000, "Density of the grains [kg/m3]");
  command.add_flag("--flat", scene.flat, "A flat floor around the orifice instead of a funnel");
  command.add_flag("--mixed", mixed, "Compute pairs of particles in float (silt::Mixed)");
  command.add_flag("--no-sort", unsorted, "Never sort the particles in memory");
  command.add_flag("--silo", round, "Run a round silo over a cone instead: pressure on its walls");
  command.add("--wall-friction", wall_friction, 0.05, 0.5,
              "With --silo: friction of grains on the wall [-]");
  return command.run(argc, argv, [&] {
    for (const char* other :
         {"--restart", "--particles", "--density", "--flat", "--mixed", "--no-sort"})
      silt::require(!round || !command.given(other), "--silo is a scene of its own; leave ", other,
                    " out");
    if (round) return silo::load_walls(wall_friction, command.options);
    scene.sort = !unsorted;
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 10000;
      scene.width = 0.05;
      scene.orifice = 0.025;
      const double moments[4] = {0.1, 0.25, 0.35, 0.65};
      std::copy(moments, moments + 4, scene.moments);
    }
    return mixed ? simulate<silt::Mixed>(scene, command.options)
                 : simulate<silt::Double>(scene, command.options);
  });
}
