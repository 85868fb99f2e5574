// silt - BSD-3-Clause, see LICENSE
//
// A fluidised bed: grains of 1 mm on a floor permeable to gas, between two walls, in a thin slice
// that is periodic in depth. The grains first settle with little friction, which gives a dense
// packing, as tapping does. Then the gas velocity is stepped up and down through minimum
// fluidisation, which gives the pressure drop over the velocity. The dense bed is held by the walls
// and carries more than its weight before it breaks up; with decreasing velocity a looser bed
// remains. Finally the gas flows at 1.5 times the minimum fluidisation velocity (--bubbling), until
// bubbles rise.
//
// The minimum fluidisation velocity is the one at which the pressure drop of the bed at rest,
// extrapolated from decreasing velocities, equals the bed's weight. It is compared with Ergun's
// equation at the bed's void fraction. The difference is explained by layers: the law summed over
// the bed's layers, with the void fraction and velocity that cells and kernel produce.
//
// Ellipsoids have drag and lift by their orientation, and are compared with that law for the
// orientations in the bed. --drag selects other laws for spheres (drag.hpp). With --hot the gas of
// the bubbling bed is hot and the grains are cold (hot_bed.cpp).
//
// The set-up is scene.hpp. measure.hpp has what is measured, law_by_layers.hpp what the drag law
// says of it, report.hpp tables, checks and pictures.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "fluidised_bed/hot_bed.hpp"
#include "fluidised_bed/law_by_layers.hpp"
#include "fluidised_bed/measure.hpp"
#include "fluidised_bed/report.hpp"
#include "fluidised_bed/scene.hpp"
#include "support/example.hpp"

namespace fluidised {
namespace {

/// Blows the bed at s.bubbling times minimum fluidisation; leaves series, gauges, means and
/// pictures.
template <class Sim>
Bubbling bubble(const Scene& s, Sim& sim, Bed<Sim>& bed, const Fluidisation& found,
                const std::string& out, Pictures& pictures) {
  auto series = silt::vtk_series(out + "/vtk", silt::every(0.02));
  // Readings of pressure gauges in a side wall as bubbles pass, and the mean void fraction.
  const double floor = 0.5 * s.cell;
  auto gauges = silt::pressure_taps(out + "/taps.csv",
                                    {{"floor", {0, 0, floor}, 2},
                                     {"middle", {0, 0, 0.5 * found.height}, 2},
                                     {"above", {0, 0, 0.9 * s.high * s.cell}, 2}},
                                    silt::every(1e-3));
  const double x = s.width() / 2, y = s.depth() / 2;  // [m] of the axis
  auto probes =
      silt::flow_probes(out + "/probes.csv",
                        {{"low", {x, y, 0.4 * found.height}}, {"high", {x, y, 0.8 * found.height}}},
                        silt::every(1e-3));
  auto profile = silt::flow_profile(out + "/axis", "axis", {x, y, 0}, {x, y, s.high * s.cell},
                                    2 * s.high + 1, silt::every(0.05));
  auto average = silt::flow_average(out, silt::every(5e-4));
  pictures.add(sim, s, "at rest");
  const double begun = sim.time();
  bed.blow(s.bubbling * found.measured, 0.25 * s.blowing, series);
  Bubbling b;
  for (int k = 0; k < 3; ++k) {
    b.means.go_on(bed.measure(0.25 * s.blowing, series, gauges, probes, profile, average));
    b.highest = std::max(b.highest, bed.top());
    char title[40];
    std::snprintf(title, sizeof title, "%.2f s", sim.time() - begun);
    pictures.add(sim, s, title);
  }
  b.bears_more = write_heights(out + "/heights.csv", average.mean(), s);
  return b;
}

template <class Shape>
int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  std::printf("settling\n");
  auto sim = make_simulation(s, settle<Shape>(s, options.threads));
  sim.threads = options.threads;
  Bed bed(s, sim);
  sim.run(s.relaxing, silt::progress());
  const double dense = bed.voidage(bed.height());

  std::printf("gas up and down\n");
  // The dense bed breaks up somewhat later, as the walls hold it.
  const Curve curve = step_gas(s, bed, 1.1 * s.velocity_by(law_of(sim, s), dense));
  const auto found = find_fluidisation<Shape>(s, sim, bed, curve);
  write_curve(options.out + "/pressure_drop.csv", s, curve, found);

  std::printf("bubbling at %.2f m/s\n", s.bubbling * found.measured);
  Pictures pictures{options.out};
  const Bubbling bubbling = bubble(s, sim, bed, found, options.out, pictures);

  example::Summary summary;
  add_inputs(summary, s, options.threads);
  add_results(summary, s, sim, dense, curve, found, bubbling);
  summary.result("wall_time_s", watch.seconds());
  check_run(summary, s, sim, curve, found, bubbling);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_run(options.out, s, pictures, found);
  print_results(s, found, bubbling);
  summary.print_checks();
  print_files(options.out, drawn, watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace fluidised

int main(int argc, char** argv) {
  example::Command command("A fluidised bed: pressure drop over gas velocity, then bubbles");
  fluidised::Scene scene;
  bool hot = false;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 1000, 100000, "Number of particles");
  command.add("--shape", scene.shape, {"sphere", "ellipsoid"},
              "Spheres, or ellipsoids of the same volume, 1.5 times as long as thick");
  command.add(
      "--drag", scene.drag, {"gidaspow", "syamlal", "own"},
      "Drag law of spheres: Gidaspow, Syamlal and O'Brien (calibrated), or the one of drag.hpp");
  command.add("--bubbling", scene.bubbling, 1.2, 5,
              "Gas velocity of the bubbling bed over the minimum fluidisation velocity");
  command.add("--step", scene.step, 0.02, 0.25, "Step of the gas velocity [m/s]");
  command.add("--blowing", scene.blowing, 0.1, 20, "Time for which the bed bubbles [s]");
  command.add_flag("--hot", hot, "Hot gas through the cold bubbling bed: temperatures over time");
  command.add("--gas", scene.hot_gas, 300, 600,
              "With --hot: temperature of the gas [K]; grains begin at 300 K");
  command.add("--heat-capacity", scene.grain_capacity, 1, 2000,
              "With --hot: heat capacity of the grains [J/(kg K)]");
  return command.run(argc, argv, [&] {
    silt::require(!hot || scene.shape == "sphere",
                  "--hot is for spheres; leave --shape ellipsoid out");
    silt::require(!command.given("--drag") || (!hot && scene.shape == "sphere"),
                  "--drag is for spheres in gas without heat; leave --hot and --shape out");
    if (hot && !command.given("--blowing")) scene.blowing = command.options.quick ? 0.3 : 1.5;
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 1200;
      if (!hot && !command.given("--blowing")) scene.blowing = 0.2;
      if (!command.given("--step")) scene.step = 0.15;
      scene.across = 8, scene.deep = 4, scene.high = 64;
      scene.relaxing = 0.015, scene.averaging = 0.01, scene.plateau = 0.05;
      scene.settling = 0.05, scene.most_off = 0.03;
    } else {
      // The same bed height for any number of grains, except for few.
      const double deep = 4 * static_cast<double>(scene.particles) / 5000;
      scene.deep = std::max(4, static_cast<int>(std::round(deep)));
    }
    if (hot) return fluidised::blow_hot(scene, command.options);
    // Laws that decrease faster with the void fraction.
    if (scene.shape != "sphere" || scene.drag == "syamlal") scene.most_off *= 1.5;
    // With other laws the bed is packed differently; with --quick layers vary by up to 1.9 %.
    if (scene.drag != "gidaspow") scene.by_layers *= 1.5;
    return scene.shape == "sphere"
               ? fluidised::simulate<silt::Sphere>(scene, command.options)
               : fluidised::simulate<silt::SuperEllipsoid>(scene, command.options);
  });
}
