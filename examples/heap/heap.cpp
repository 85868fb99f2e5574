// silt - BSD-3-Clause, see LICENSE
//
// A heap by column collapse: grains settle between a wall and a gate in a channel, which is
// periodic across; the gate is removed, and they slide on a floor with glued grains until they are
// at rest. Results: slope, run-out and solid fraction of the heap, for spheres with and without
// rolling resistance, cubes, superellipsoids, multi-spheres or a mixture of all.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp pictures and checks.

#include <cstdio>
#include <string>

#include "heap/measure.hpp"
#include "heap/report.hpp"
#include "heap/scene.hpp"
#include "support/example.hpp"

namespace heap {
namespace {

/// Lets the grains settle, and takes the gate away until they are at rest.
template <class Sim>
Collapse collapse(const Scene& s, Sim& sim, const std::string& out) {
  std::printf("settling\n");
  sim.run(s.settling, silt::progress());
  const Heap bed(s, sim);
  const double bed_height = Sphere::volume(s.grain) * static_cast<double>(s.particles) /
                            (bed.solid_fraction() * s.length * s.width);
  write_picture(out + "/before.vtp", sim);

  std::printf("collapsing\n");
  sim.remove_wall(Scene::gate);
  const double opened = sim.time(), slice = 0.05;  // [s]
  auto series = silt::vtk_series(out + "/vtk", silt::every(slice));
  do sim.run(slice, series);
  while (Heap(s, sim).kinetic_energy() > s.at_rest && sim.time() - opened < s.longest);
  write_picture(out + "/after.vtp", sim);
  return {bed, Heap(s, sim), opened, sim.time(), bed_height, s.length};
}

template <class Sim>
int simulate(const Scene& s, const example::Options& options, Sim sim) {
  const example::Stopwatch watch;
  sim.threads = options.threads;
  silt::make_folder(options.out);
  const Collapse run = collapse(s, sim, options.out);
  write_surface(options.out + "/surface.csv", run.heap);

  example::Summary summary;
  add_inputs(summary, s, options.threads);
  add_results(summary, sim, run);
  summary.result("wall_time_s", watch.seconds());
  check_run(summary, s, run, options.quick);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_run(options.out, s, run.ended - run.opened);
  std::printf("\nAngle of repose %.1f degrees, run-out %.2f times the column, %zu %s.\n",
              run.heap.angle(), run.run_out(), run.heap.grains(), s.shapes.c_str());
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/surface.csv, %s/summary.json; %.0f s\n",
              drawn ? (options.out + "/heap.png, ").c_str() : "", options.out.c_str(),
              options.out.c_str(), options.out.c_str(), watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace heap

int main(int argc, char** argv) {
  example::Command command("A column of grains collapses to a heap; its angle of repose");
  using namespace heap;
  Scene scene;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 50, 1000, "Number of grains");
  command.add("--shapes", scene.shapes,
              {"cubes", "spheres", "rough-spheres", "super-ellipsoids", "multi-spheres", "mix"},
              "Shapes of the grains; rough-spheres resist rolling");
  command.add("--rolling-friction", scene.rolling, 0, 2, "Rolling friction of rough-spheres [-]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 120;
      scene.length = 0.0528;
    }
    silt::require(!command.given("--rolling-friction") || scene.shapes == "rough-spheres",
                  "--rolling-friction is of --shapes rough-spheres alone: there are no rolling "
                  "models for bodies with edges, nor have spheres one unless they are rough");
    const auto& options = command.options;
    if (scene.shapes != "rough-spheres")
      return simulate(scene, options,
                      make_simulation<Grains>(scene, silt::Contacts<Law>{scene.material()}));
    return simulate(scene, options, make_simulation<Sphere>(scene, rough_contacts(scene)));
  });
}
