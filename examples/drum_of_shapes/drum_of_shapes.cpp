// silt - BSD-3-Clause, see LICENSE
//
// A rotating drum with spheres, superellipsoids and polyhedra of equal volume together, after
// figure 22 of the review by X. Ma et al. on CFD-DEM of non-spherical particles. The review gives
// neither sizes nor speed; those used here are stated in Scene. With --shapes all are of one kind,
// to compare the dynamic angles of repose.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp pictures and checks.

#include <cstdint>
#include <cstdio>
#include <string>

#include "drum_of_shapes/measure.hpp"
#include "drum_of_shapes/report.hpp"
#include "drum_of_shapes/scene.hpp"
#include "support/example.hpp"

namespace drum_of_shapes {
namespace {

/// The turns of the drum, from now on; leaves tables and series.
template <class Sim>
Measured turn(Sim& sim, const Scene& s, const std::string& out) {
  Measured m(s, sim.time());
  auto table = silt::table(
      out + "/drum.csv", {"time [s]", "power [W]", "kinetic energy [J]", "contacts a grain [-]"},
      silt::every(s.turn() / 200), [&](const auto& at) { return m.look(at, s); });
  const example::Stopwatch clock;
  const std::int64_t first = sim.step();
  sim.run(s.turns * s.turn(), table, silt::vtk_series(out + "/vtk", silt::every(s.turn() / 20)),
          silt::on_contact_end([&](const silt::ContactEvent& impact) {
            if (m.is_last_turn(s, impact.end)) m.impacts.add(impact);
          }),
          silt::progress());
  m.particle_steps_per_s =
      static_cast<double>(sim.size()) * static_cast<double>(sim.step() - first) / clock.seconds();
  silt::write_surfaces(out + "/end.vtp", sim);
  write_surface(out + "/surface.csv", m.bed);
  m.impacts.write(out + "/impacts.csv", static_cast<double>(sim.size()), s.turn());
  return m;
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  const auto start = not_yet();
  auto sim = make_simulation(s, start);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  std::printf("filling\n");
  fill(sim, s);
  std::printf("turning\n");
  write_outline(s, options.out + "/drum.vtp");
  *start = sim.time();
  const Measured m = turn(sim, s, options.out);

  example::Summary summary;
  add_inputs(summary, s, options.threads);
  add_results(summary, s, sim, m);
  summary.result("wall_time_s", whole.seconds());
  check_run(summary, s, m, options.quick);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_run(options.out, s);
  std::printf(
      "\nDynamic angle of repose %.1f degrees, power %.3g W, %zu grains, %.3g grain-steps/s.\n",
      m.bed.angle(), m.power(s), sim.size(), m.particle_steps_per_s);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk/surfaces.pvd (ParaView), %s/drum.csv, %s/summary.json\n",
              drawn ? (options.out + "/drum.png, " + options.out + "/impacts.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace drum_of_shapes

int main(int argc, char** argv) {
  example::Command command("Spheres, super-ellipsoids and polyhedra in a rotating drum");
  drum_of_shapes::Scene scene;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 30, 1200,
              "Number of particles, of all shapes together");
  command.add("--rpm", scene.rpm, 1, 100, "Turns of the drum per minute");
  command.add("--turns", scene.turns, 1, 100, "Turns of the drum; the last is measured");
  command.add("--shapes", scene.shapes, {"mix", "spheres", "super-ellipsoids", "cubes"},
              "Shapes of the grains");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 150;
      if (!command.given("--turns")) scene.turns = 1;
      if (!command.given("--rpm")) scene.rpm = 40;
      scene.radius = 0.03, scene.length = 0.025;
    }
    return drum_of_shapes::simulate(scene, command.options);
  });
}
