// silt - BSD-3-Clause, see LICENSE
//
// Wall pressure in a round silo above a cone, after filling and during discharge: on rings of the
// cylinder wall over height, beside Janssen's law, and on the cone's facets.

#include "hopper/silo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "hopper/silo_measure.hpp"
#include "hopper/silo_scene.hpp"

namespace silo {
namespace {

/// Pressures over height, from the outlet up the cone and the cylinder. Janssen's curve is that of
/// the bed during discharge; the curve of the weight above is that of the bed at rest, which is
/// higher.
void write_walls(const std::string& path, const Scene& s, const std::array<Rings, 2>& rings,
                 const std::array<Rows, 2>& rows, const Janssen& law) {
  const auto& [rest, flow] = rings;
  silt::CsvTable table(
      path, {"height [m]", "at rest [Pa]", "while emptied [Pa]", "Janssen while emptied [Pa]",
             "weight above at rest [Pa]", "cone at rest [Pa]", "cone while emptied [Pa]"});
  const double none = std::nan("");
  for (std::size_t k = 0; k < s.rows(); ++k) {
    const double row = s.cone() / static_cast<double>(s.rows());  // [m]
    table.add_row({(static_cast<double>(k) + 0.5) * row, none, none, none, none,
                   rows[0].pressure(k), rows[1].pressure(k)});
  }
  for (std::size_t k = 0; k < std::min(rest.filled(), flow.filled()); ++k)
    table.add_row({s.cone() + (static_cast<double>(k) + 0.5) * s.ring(), rest.pressure(k),
                   flow.pressure(k), law.pressure(flow.depth(k)),
                   rest.density() * g * rest.depth(k), none, none});
}

}  // namespace

int load_walls(double wall_friction, const example::Options& options) {
  const example::Stopwatch watch;
  Scene s;
  s.wall_friction = wall_friction;
  if (options.quick) s.wide = 10, s.outlet = 6, s.emptying = 0.2;
  const std::string& out = options.out;
  silt::make_folder(out);
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  std::printf("filling with %zu grains\n", sim.size());
  sim.run(s.settling(), silt::progress());

  std::array rings{Rings(s), Rings(s)};
  std::array rows{Rows(s), Rows(s)};
  rings[0].add(sim), rows[0].add(sim);
  const double weight = g * sim.total_mass();
  double borne = 0;
  for (std::size_t w = 0; w < sim.walls(); ++w) borne -= sim.wall(w).force.z;
  const double held = -sim.wall("mantle").force.z / weight;
  const double facets_off =
      silt::norm(rows[0].sum() - sim.wall("cone").force) / silt::norm(sim.wall("cone").force);
  silt::write_facet_loads(out + "/cone_at_rest.vtp", sim, "cone");
  silt::write_particles(out + "/silo_at_rest.vtp", sim);

  std::printf("emptying\n");
  sim.remove_wall(sim.wall_number("lid"));
  sim.run(s.emptying / 3, silt::progress());
  sim.run(2 * s.emptying / 3, silt::progress(), silt::at(silt::every(1e-3), [&](const auto& now) {
            rings[1].add(now), rows[1].add(now);
          }));
  const Rings& flow = rings[1];
  const Janssen law = Janssen::of(flow, s);
  write_walls(out + "/walls.csv", s, rings, rows, law);
  example::Summary summary;
  summary.input("grains", static_cast<double>(s.grains()));
  summary.input("diameter_m", s.diameter());
  summary.input("wall_friction", s.wall_friction);
  summary.result("bulk_density_kg_m3", law.rho);
  summary.result("shear_over_pressure_while_emptied", law.m);
  summary.result("pressure_over_vertical_stress_while_emptied", law.K);
  summary.result("held_by_the_mantle_at_rest_over_weight", held);
  summary.result("wall_time_s", watch.seconds());
  summary.check_within("borne_by_walls_at_rest_over_weight", borne / weight, 1, 0.03,
                       "what is left of the bed's bouncing");
  summary.check_at_most("facets_against_force_of_the_cone", facets_off, 1e-9);
  summary.check_at_most("shear_over_pressure_over_friction", law.m / s.wall_friction, 1);
  summary.check_at_least("shear_over_pressure_over_friction", law.m / s.wall_friction, 0.6);
  summary.check_at_most("pressure_while_emptied_off_janssen_rms", law.off(flow),
                        options.quick ? 0.2 : 0.15);
  summary.write(out + "/summary.json");
  const bool drawn = example::draw({"curves", out + "/walls.csv", "--x", "height", "--y",
                                    "weight above at rest,at rest,cone at rest,Janssen while "
                                    "emptied,while emptied,cone while emptied",
                                    "--y-label", "pressure on the wall [Pa]", "--title",
                                    "Mantle and cone of a silo", "--out", out + "/walls.png"});
  summary.print_checks();
  std::printf("Look at: %s%s/walls.csv, %s/cone_at_rest.vtp (ParaView), %s/summary.json; %.0f s\n",
              drawn ? (out + "/walls.png, ").c_str() : "", out.c_str(), out.c_str(), out.c_str(),
              watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace silo
