// silt - BSD-3-Clause, see LICENSE
//
// Low-speed impact: a metal ball, a free body made of a mesh, falls from several heights onto a bed
// of grains and stops in it. The bed settles once; each drop continues from its checkpoint in a
// modified scene: with the ball, another restitution and another time step. One more run continues
// with tilted gravity; it gives the angle of repose for the depth law.
//
// The set-up is scene.hpp; measure.hpp has what is measured, laws.hpp the laws that are fitted to
// it, report.hpp tables and checks.

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "crater/laws.hpp"
#include "crater/measure.hpp"
#include "crater/report.hpp"
#include "crater/scene.hpp"
#include "support/example.hpp"

namespace crater {
namespace {

Bed settle(const Scene& s, const example::Options& options) {
  std::printf("%zu grains settle\n", s.grains());
  auto sim = make_simulation(s, true);
  sim.threads = options.threads;
  run_until_rest(s, sim);
  const Surface surface(s, sim);
  const std::string file = options.out + "/bed.silt";
  silt::save_checkpoint(sim, file);
  return {file,           State(sim), surface.level(), surface.fraction(), sim.step_length(),
          surface.slope()};
}

/// [degrees] The bed continues with tilted gravity, and flows until its surface is no steeper.
double repose(const Scene& s, const Bed& bed, const example::Options& options) {
  std::printf("gravity tilted by %.0f degrees\n", s.tilt);
  auto sim = make_simulation(s, false);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, bed.file, {.materials = true});
  const double angle = s.tilt * std::numbers::pi / 180;
  sim.gravity = {g * std::sin(angle), 0, -g * std::cos(angle)};
  run_until_rest(s, sim);
  silt::write_particles(options.out + "/tilted.vtp", sim);
  return s.tilt - Surface(s, sim).slope() + bed.slope;
}

/// One drop, from the checkpoint; the `last` writes pictures of its way down.
Outcome fall(const Scene& s, const Bed& bed, const Drop& drop, bool last,
             const example::Options& options) {
  std::printf("%.0f kg/m3 from %.0f mm\n", drop.density, 1e3 * drop.height);
  Outcome out;
  out.drop = drop;
  auto sim = make_simulation(s, false, drop);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, bed.file, {.materials = true, .walls = true});
  sim.time_step = 0.9 * bed.step;
  const State before(sim);
  out.changed = before.differ(bed.state);

  Watch watch(s, bed, out, sim);
  if (last) watch.take_picture(options.out);
  auto samples = silt::at(silt::every(0.5e-3), [&](const auto& at) { watch(at); });
  auto frames = silt::vtk_series(options.out + "/vtk", silt::every(0.01));
  const double start = sim.time(), slice = 0.01;  // [s]
  double was = 0;
  do {
    was = watch.depth(sim);
    if (last)
      sim.run(slice, samples, frames, silt::progress());
    else
      sim.run(slice, samples, silt::progress());
  } while ((std::abs(watch.depth(sim) - was) > 1e-3 * s.body() || out.stopped == 0) &&
           sim.time() - start < s.longest);
  silt::MeanLoad at_rest(sim, "body");
  sim.run(2 * slice, samples, silt::progress());
  out.bears = at_rest.read(sim).force.z / (watch.mass() * g);

  watch.close_books(sim);
  out.depth = watch.depth(sim), out.total = drop.height + out.depth;
  out.overlap = sim.peak_overlap();
  out.mass = watch.mass();
  const auto millimetres = std::round(1e3 * drop.height);
  write_drop(silt::text(options.out, '/', drop.density, '_', millimetres), sim, before,
             watch.mass(), out);
  return out;
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  const Bed bed = settle(s, options);
  const double angle = repose(s, bed, options), mu = std::tan(angle * std::numbers::pi / 180);
  std::vector<Outcome> all;
  for (const double density : s.densities)
    for (const double height : s.heights)
      all.push_back(fall(s, bed, {density, height * s.body(), bed.level},
                         density == s.densities.back() && height == s.heights.back(), options));
  const auto fit = fit_depths(s, bed, all);
  std::vector<ForceLaw> laws;
  for (const double density : s.densities) laws.emplace_back(density, all);
  example::Summary summary;
  summary.input("grains", static_cast<double>(s.grains()));
  summary.input("ball_over_grain", s.diameter);
  summary.input("pot_over_ball", s.wide);
  summary.input("friction", s.friction);
  summary.result("bed_level_over_ball", bed.level / s.body());
  summary.result("bed_solid_fraction", bed.fraction);
  summary.result("angle_of_repose_deg", angle);
  report_drops(summary, s, bed, mu, all);
  check_books(summary, s, bed, all);
  check_depths(summary, s, bed, mu, fit, all, options.quick);
  check_forces(summary, s, laws, options.quick);
  summary.result("wall_time_s", whole.seconds());
  summary.write(options.out + "/summary.json");
  write_depths(options.out + "/depths.csv", s, bed, mu, fit, laws, all);
  const bool drawn = example::run_script(
      SILT_CRATER_SCRIPT, {options.out, silt::text(bed.level), silt::text(s.body())});
  std::printf(
      "\nDepth as the height of fall to the power %.3f +- %.3f, the density to %.3f +- %.3f.\n",
      fit.value[1], fit.error[1], fit.value[2], fit.error[2]);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/depths.csv, %s/summary.json; %.0f s\n",
              drawn ? (options.out + "/crater.png, depth.png, ").c_str() : "", options.out.c_str(),
              options.out.c_str(), options.out.c_str(), whole.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace crater

int main(int argc, char** argv) {
  example::Command command("A ball of metal falls onto a bed of grains and stops in it",
                           example::Kind::Cases, "out/crater");
  crater::Scene scene;
  command.add("--diameter", scene.diameter, 2, 30, "Diameter of the ball, in grain diameters");
  command.add("--wide", scene.wide, 2, 20, "Diameter of the pot, in ball diameters");
  command.add("--deep", scene.deep, 2, 10, "Depth of the bed, in ball diameters");
  command.add("--seed", scene.seed, 1, 1000000, "Seed of the packing of the bed");
  command.add("--friction", scene.friction, 0.05, 2, "Friction between grains [-]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--diameter")) scene.diameter = 5;
      if (!command.given("--wide")) scene.wide = 4.5;
      scene.heights = {1, 6};
    }
    return crater::simulate(scene, command.options);
  });
}
