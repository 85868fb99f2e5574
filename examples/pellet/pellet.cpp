// silt - BSD-3-Clause, see LICENSE
//
// Pellets tumble in a drum with a bar: agglomerates of bonded spheres, whose bonds break. The
// result is the mass fraction lost in small pieces, over the turns of the drum, as in durability
// tests. The pellets settle with unbreakable bonds; the drum rotates from that checkpoint on.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp pictures and checks.

#include <cstdio>
#include <string>

#include "pellet/measure.hpp"
#include "pellet/report.hpp"
#include "pellet/scene.hpp"
#include "support/example.hpp"

namespace pellet {
namespace {

/// Turns the drum from now on; leaves tables and series.
template <class Sim>
void tumble(Sim& sim, const Scene& s, Tumbling& m, const std::string& out) {
  begin_to_turn(sim, s);
  const double turn = s.turn();
  sim.run(s.turns * turn,
          silt::on_bond_break([&](const silt::BondBreak& b) { m.lost += b.energy; }),
          silt::table(out + "/pieces.csv",
                      {"time [s]", "turns [-]", "broken bonds [-]", "fines [-]",
                       "largest piece [-]", "pieces [-]"},
                      silt::every(turn / 50), [&](const auto& at) { return m.look(at, s); }),
          silt::at(silt::every(turn / 10), [&](auto& at) { mark_pieces(at, m.mass); }),
          silt::vtk_series(out + "/vtk", silt::every(turn / 10)),
          silt::bond_series(out + "/vtk", silt::every(turn / 10)), silt::progress());
  mark_pieces(sim, m.mass);
  silt::write_particles(out + "/end.vtp", sim);
  silt::write_walls(out + "/walls.vtp", sim);
  write_sizes(out + "/sizes.csv", sim, m.mass);
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  const std::string settled = options.out + "/settled.silt";
  settle(s, settled, options.threads);
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, settled, {.materials = true});  // bonds get their strength
  Tumbling m{.start = sim.time(),
             .mass = sim.total_mass() / static_cast<double>(s.pellets),
             .bonds = sim.bonds()};
  example::Summary summary;
  add_inputs(summary, s, sim, m);
  tumble(sim, s, m, options.out);
  const Pieces end = pieces_of(sim, s, m.mass);
  add_results(summary, sim, end, m);
  summary.result("wall_time_s", whole.seconds());
  check_run(summary, s, sim, end, m);
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_run(options.out, s);
  std::printf(
      "\n%.1f %% of %zu bonds broken; %.1f %% of the mass in pieces below %.0f %% of a pellet.\n",
      100.0 * static_cast<double>(sim.broken_bonds()) / static_cast<double>(m.bonds), m.bonds,
      100 * end.fines, 100 * s.sieve);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/pieces.csv, %s/sizes.csv, %s/summary.json\n",
              drawn ? (options.out + "/drum.png, " + options.out + "/pieces.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace pellet

int main(int argc, char** argv) {
  example::Command command("Bonded pellets in a tumbling drum: what breaks off, over its turns");
  pellet::Scene scene;
  command.leave_out("--restart");
  command.add("--pellets", scene.pellets, 1, 24, "Number of pellets");
  command.add("--strength", scene.strength, 0, 1e6,
              "Mean strength of the bonds [kPa]; 0: unbreakable");
  command.add("--scatter", scene.scatter, 0, 50, "Weibull modulus of the strength; 0: none");
  command.add("--rpm", scene.rpm, 1, 100, "Turns of the drum per minute");
  command.add("--turns", scene.turns, 0.1, 1000, "Turns of the drum");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--pellets")) scene.pellets = 6;
      if (!command.given("--turns")) scene.turns = 0.8;
    }
    return pellet::simulate(scene, command.options);
  });
}
