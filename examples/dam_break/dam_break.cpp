// silt - BSD-3-Clause, see LICENSE
//
// Dam break: a column of water with the width a and the height 2 a stands at a wall, is released
// and runs along the floor. Its front and height are compared with measurements, and its energy is
// followed.
//
// The set-up is scene.hpp; measure.hpp has what is measured here, measured.hpp what others
// measured, report.hpp the comparison.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>

#include "dam_break/measure.hpp"
#include "dam_break/measured.hpp"
#include "dam_break/report.hpp"
#include "dam_break/scene.hpp"
#include "support/example.hpp"

namespace dam_break {
namespace {

/// Runs to s.end; leaves a table and a series of the liquid.
template <class Water>
Record simulate(const Scene& s, Water& water, double start, const example::Options& options) {
  constexpr int per_frame = 10;
  constexpr double between = 0.02;  // T
  Record record;
  silt::CsvTable table(
      options.out + "/dam_break.csv",
      {"time [s]", "T [-]", "front [-]", "height [-]", "kinetic energy [-]", "potential energy [-]",
       "elastic energy [-]", "largest speed over sound [-]", "largest change of density [-]",
       "deep front [-]"});
  silt::VtkSeries series(options.out + "/vtk", "liquid");
  const int rows = static_cast<int>(std::lround(s.end / between));
  const std::vector<double> first = pressures(water);
  for (int k = 0; k <= rows; ++k) {
    water.run(std::max(k * between * s.unit() - water.time(), 0.0), options.threads);
    const Look l = look_at(water, start);
    if (k <= 5) record.jolt = std::max(record.jolt, change_of(first, pressures(water)));
    record.T.push_back(k * between), record.looks.push_back(l);
    table.add_row({water.time(), k * between, l.front, l.height, l.kinetic, l.potential, l.elastic,
                   l.speed, l.density, l.deep});
    if (k % per_frame != 0) continue;
    char name[32];
    std::snprintf(name, sizeof name, "liquid_%03d.vtp", k / per_frame);
    water.write(options.out + "/vtk/" + name), series.add(water.time(), name);
    std::printf("\r%3d %%", 100 * k / rows), std::fflush(stdout);
  }
  std::printf("\r");
  return record;
}

int run(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto water = make_water(s);
  silt::make_folder(options.out);
  const double start = water.particle_mass() * static_cast<double>(water.size()) * Scene::g *
                       Scene::a;  // [J] the middle is a high
  std::printf("%zu particles of %g mm%s\n", water.size(), s.spacing,
              s.three_dimensional ? ", in three dimensions" : "");
  const Record record = simulate(s, water, start, options);
  const double seconds = whole.seconds();
  example::Summary summary;
  summary.input("particles", static_cast<double>(water.size()));
  summary.input("dimensions", s.three_dimensional ? 3.0 : 2.0);
  summary.input("width_m", Scene::a);
  summary.input("sound_speed_m_s", water.liquid().sound_speed);
  summary.input("artificial_viscosity", s.alpha);
  summary.input("sticking", s.sticking ? 1.0 : 0.0);
  summary.input("threads", static_cast<double>(options.threads));
  compare_curves(summary, s, record, options.out);
  report_run(summary, s, water, record);
  summary.result("wall_time_s", seconds);
  summary.result("ns_a_particle_and_step", 1e9 * seconds / static_cast<double>(water.steps()) /
                                               static_cast<double>(water.size()));
  summary.write(options.out + "/summary.json");
  const Curve front = record.curve(&Look::front);
  const bool drawn = example::run_script(
      SILT_DAM_BREAK_SCRIPT,
      {options.out, silt::text(Scene::a), silt::text(s.across()), silt::text(s.unit()),
       silt::text(lateness(front, martin_moyce_front()))});
  summary.print_checks();
  std::printf("Look at: %s%s/dam_break.csv, vtk/liquid.pvd (ParaView), summary.json; %.0f s\n",
              drawn ? (options.out + "/dam_break.png, curves.png, ").c_str() : "",
              options.out.c_str(), seconds);
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace dam_break

int main(int argc, char** argv) {
  example::Command command("A column of water collapses: front, height and energy, by SPH",
                           example::Kind::Cases, "out/dam_break");
  dam_break::Scene scene;
  command.add("--spacing", scene.spacing, 0.5, 14.6,
              "Spacing of the particles [mm]; the column is 146 mm wide");
  command.add("--sound", scene.sound, 5, 100,
              "Speed of sound over the speed of a fall from the top of the column");
  command.add("--alpha", scene.alpha, 0, 1, "Artificial viscosity alpha");
  command.add("--end", scene.end, 3.4, 5.2, "Time t sqrt(2 g/a) at which the run ends");
  command.add_flag("--sticking", scene.sticking, "No-slip condition at floor and walls");
  command.add_flag("--three-dimensional", scene.three_dimensional,
                   "In 3D: a channel that is periodic across its width");
  return command.run(argc, argv, [&] {
    if (!command.given("--spacing") && (command.options.quick || scene.three_dimensional))
      scene.spacing = command.options.quick && scene.three_dimensional ? 14.6 : 7.3;
    return dam_break::run(scene, command.options);
  });
}
