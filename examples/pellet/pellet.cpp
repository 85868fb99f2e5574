// silt - BSD-3-Clause, see LICENSE
//
// Pellets tumble in a drum with a bar: agglomerates of bonded spheres, whose bonds break. The
// result is the mass fraction lost in small pieces, over the turns of the drum, as in durability
// tests. The pellets settle with unbreakable bonds; the drum rotates from that checkpoint on.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

#include "support/example.hpp"

namespace {

using Law = silt::HertzMindlin;
using silt::Vec3d;

struct Scene {
  std::size_t pellets = 24;
  double radius = 3e-3, length = 12e-3;  // [m] of a pellet, a cylinder
  double sphere = 0.75e-3;               // [m]
  double density = 1200;                 // [kg/m3] of the spheres
  double strength = 30;                  // [kPa] of bonds, in pull and shear, mean; 0: unbreakable
  double scatter = 4;                    // [-] Weibull modulus
  double drum = 0.03, width = 0.03;      // [m] radius, and length of a period along the axis
  double rpm = 50;
  double turns = 2;
  double sieve = 0.05;  // [-] of a pellet's mass: pieces below it are fines

  double rate() const { return rpm * std::numbers::pi / 30; }  // [rad/s]
  Law::Material material() const {
    return {.youngs_modulus = 4e6, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.5};
  }
  silt::ParallelBond bonds() const {
    const double most = strength > 0 ? 1e3 * strength : std::numeric_limits<double>::infinity();
    return {.youngs_modulus = 4e6,
            .tensile_strength = most,
            .shear_strength = most,
            .damping = 0.2,
            .weibull_modulus = scatter};
  }
};

/// Mass of the piece that contains a sphere, over that of a pellet [-].
using Piece = silt::Field<"piece over pellet [-]">;

auto make_simulation(const Scene& s) {
  const silt::Box period{{-s.drum, 0, -s.drum}, {s.drum, s.width, s.drum}};
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       silt::Contacts<Law>{s.material()},
                       silt::PeriodicBox{period, {false, true, false}},
                       silt::Bonds{s.bonds()},
                       silt::EnergyLedger{},
                       Piece{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, -s.width, 0}, {0, 2 * s.width, 0}, s.drum, silt::Side::Inside},
               s.material(), {.name = "drum"});
  // Too thick for a sphere to get around: 20 % of the drum's radius. It goes down first.
  sim.add_wall(silt::box_mesh({0.8 * s.drum, 0, -1.5e-3}, {1.01 * s.drum, s.width, 1.5e-3}),
               s.material(), {.name = "bar"});
  return sim;
}

/// Whether no sphere is within `room` [m] of x, including periodic images.
template <class Sim>
bool is_free(const Sim& sim, const Scene& s, const Vec3d& x, double room) {
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    Vec3d d = sim.position(k) - x;
    d.y -= s.width * std::round(d.y / s.width);
    if (norm(d) < room + s.sphere) return false;
  }
  return true;
}
/// As many pellets as fit without touching, in random orientations. Returns their number.
template <class Sim>
std::size_t add_pellets(Sim& sim, const Scene& s, silt::Random& random, std::size_t placed) {
  // Spheres at an end that are too far from the others for a bond are left out.
  const auto pellet = silt::largest_piece(silt::agglomerate(
      silt::CylinderRegion{{0, 0, -0.5 * s.length}, {0, 0, 0.5 * s.length}, s.radius},
      {.radius = s.sphere}, 0.3 * s.sphere, {.density = s.density}));
  const double room = std::hypot(s.length, 2 * s.radius) * 1.02;  // [m] from centre to centre
  const double reach = s.drum - 0.5 * room;
  for (double z = -reach; z <= reach; z += room)
    for (double x = -reach; x <= reach; x += room)
      for (double y = 0.5 * room; y + 0.5 * room <= s.width; y += room) {
        if (placed == s.pellets || std::hypot(x, z) > reach) continue;
        if (x > 0.8 * s.drum - 0.5 * room && std::abs(z) < 0.5 * room + 1.5e-3)
          continue;  // the bar
        if (!is_free(sim, s, {x, y, z}, 0.5 * room)) continue;
        const Vec3d axis{random.normal(), random.normal(), random.normal()};
        const auto turn =
            silt::rotation_about((1 / norm(axis)) * axis, random.uniform(0, std::numbers::pi));
        silt::add_bonded(sim, silt::placed(pellet, {x, y, z}, turn));
        ++placed;
      }
  return placed;
}
/// Saves the pellets at rest in the drum at rest: they fall in batches, and nothing breaks.
void settle(Scene s, const std::string& checkpoint, std::size_t threads) {
  s.strength = 0;
  auto sim = make_simulation(s);
  sim.threads = threads;
  silt::Random random(7);
  for (std::size_t placed = 0; placed < s.pellets;) {
    const std::size_t before = std::exchange(placed, add_pellets(sim, s, random, placed));
    silt::require(placed > before, "only ", placed, " of ", s.pellets,
                  " pellets have room in the drum; give --pellets at most that");
    sim.run(0.15);
  }
  sim.run(0.25);
  silt::save_checkpoint(sim, checkpoint);
}

struct Pieces {
  double fines, largest, count;  // [-] share of all mass, of a pellet's; number of pieces
  double mass;                   // [kg] of all
};
template <class Sim>
Pieces pieces_of(const Sim& sim, const Scene& s, double pellet) {
  const auto all = silt::fragments(sim);
  Pieces p{0, 0, static_cast<double>(all.mass.size()), 0};
  for (const double m : all.mass) {
    p.mass += m, p.largest = std::max(p.largest, m / pellet);
    if (m < s.sieve * pellet) p.fines += m;
  }
  p.fines /= p.mass;
  return p;
}
/// Marks each sphere with its piece, for pictures.
template <class Sim>
void mark_pieces(Sim& sim, double pellet) {
  const auto all = silt::fragments(sim);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<"piece over pellet [-]">(k) = all.mass[all.of[k]] / pellet;
}

/// Pieces by mass: the mass fraction in smaller pieces.
template <class Sim>
void write_sizes(const std::string& file, const Sim& sim, double pellet) {
  auto mass = silt::fragments(sim).mass;
  std::sort(mass.begin(), mass.end());
  double all = 0, below = 0;
  for (const double m : mass) all += m;
  silt::CsvTable table(file, {"mass over a pellet's [-]", "share of all mass below [-]"});
  for (const double m : mass) below += m, table.add_row({m / pellet, below / all});
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  const std::string settled = options.out + "/settled.silt";
  settle(s, settled, options.threads);
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, settled, {.materials = true});  // bonds get their strength
  const double start = sim.time();                           // [s]
  const silt::Rotation turning{.centre = {0, 0, 0}, .axis = {0, 1, 0}, .rate = s.rate()};
  for (const char* wall : {"drum", "bar"}) sim.set_motion(wall, silt::from(start, turning));
  const double pellet = sim.total_mass() / static_cast<double>(s.pellets);  // [kg]
  const std::size_t made = sim.bonds();
  example::Summary summary;
  summary.input("pellets", static_cast<double>(s.pellets));
  summary.input("spheres", static_cast<double>(sim.size()));
  summary.input("bonds", static_cast<double>(made));
  summary.input("strength_kpa", s.strength);
  summary.input("weibull_modulus", s.scatter);
  summary.input("rpm", s.rpm);
  summary.input("turns", s.turns);
  summary.input("pellet_mass_kg", pellet);

  const double turn = 60 / s.rpm;  // [s]
  double lost = 0, last = 0, fell = 0;
  const auto watch = [&](const auto& at) {
    const Pieces p = pieces_of(at, s, pellet);
    fell = std::max(fell, last - p.fines), last = p.fines;
    return std::array<double, 6>{at.time() - start,
                                 (at.time() - start) / turn,
                                 static_cast<double>(at.broken_bonds()) / static_cast<double>(made),
                                 p.fines,
                                 p.largest,
                                 p.count};
  };
  sim.run(s.turns * turn, silt::on_bond_break([&](const silt::BondBreak& b) { lost += b.energy; }),
          silt::table(options.out + "/pieces.csv",
                      {"time [s]", "turns [-]", "broken bonds [-]", "fines [-]",
                       "largest piece [-]", "pieces [-]"},
                      silt::every(turn / 50), watch),
          silt::at(silt::every(turn / 10), [&](auto& at) { mark_pieces(at, pellet); }),
          silt::vtk_series(options.out + "/vtk", silt::every(turn / 10)),
          silt::bond_series(options.out + "/vtk", silt::every(turn / 10)), silt::progress());

  mark_pieces(sim, pellet);
  silt::write_particles(options.out + "/end.vtp", sim);
  silt::write_walls(options.out + "/walls.vtp", sim);
  write_sizes(options.out + "/sizes.csv", sim, pellet);
  const Pieces end = pieces_of(sim, s, pellet);
  const auto e = sim.energy();
  summary.result("broken_bonds_over_all",
                 static_cast<double>(sim.broken_bonds()) / static_cast<double>(made));
  summary.result("fines", end.fines);
  summary.result("pieces", end.count);
  summary.result("work_of_the_drum_j", e.walls);
  summary.result("broken_j", e.bond_breaking);
  summary.result("damped_in_bonds_j", e.bond_damping);
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_within("mass_of_pieces_over_pellets",
                       end.mass / (pellet * static_cast<double>(s.pellets)), 1, 1e-12, "rounding");
  summary.check_within(
      "bonds_held_and_broken_over_made",
      static_cast<double>(sim.bonds() + sim.broken_bonds()) / static_cast<double>(made), 1, 0,
      "counts");
  summary.check_within("energy_of_breaks_over_ledger",
                       e.bond_breaking > 0 ? lost / e.bond_breaking : 1, 1, 1e-9, "rounding");
  summary.check_at_most("fines_that_grew_together", fell, 1e-12);
  summary.check_within("energy_unexplained_over_dissipated", e.residual() / e.dissipated(), 0, 1e-3,
                       "friction at meshes and turned arms, first order in the step");
  if (s.strength > 0)
    summary.check_at_least("bonds_broken", static_cast<double>(sim.broken_bonds()), 1);
  else
    summary.check_at_most("bonds_broken", static_cast<double>(sim.broken_bonds()), 0);
  summary.write(options.out + "/summary.json");
  const bool drawn =
      example::draw({"draw", options.out + "/end.vtp", "--walls", options.out + "/walls.vtp",
                     "--colour", "piece over pellet", "--title",
                     silt::text("After ", s.turns, " turns, coloured by the mass of the piece"),
                     "--out", options.out + "/drum.png"}) &&
      example::draw({"curves", options.out + "/pieces.csv", "--x", "turns", "--y",
                     "largest piece,broken bonds,fines", "--log", "y", "--y-label",
                     "share of a pellet, of all bonds, of all mass [-]", "--title",
                     silt::text("Pellets of bonds of ", s.strength, " kPa"), "--out",
                     options.out + "/pieces.png"});
  std::printf(
      "\n%.1f %% of %zu bonds broken; %.1f %% of the mass in pieces below %.0f %% of a pellet.\n",
      100.0 * static_cast<double>(sim.broken_bonds()) / static_cast<double>(made), made,
      100 * end.fines, 100 * s.sieve);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/pieces.csv, %s/sizes.csv, %s/summary.json\n",
              drawn ? (options.out + "/drum.png, " + options.out + "/pieces.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Bonded pellets in a tumbling drum: what breaks off, over its turns");
  Scene scene;
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
    return simulate(scene, command.options);
  });
}
