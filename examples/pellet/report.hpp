// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: sizes of the pieces, pictures, summary.json with its checks.

#include <algorithm>
#include <string>

#include "pellet/measure.hpp"
#include "support/example.hpp"

namespace pellet {

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

template <class Sim>
void add_inputs(example::Summary& summary, const Scene& s, const Sim& sim, const Tumbling& m) {
  summary.input("pellets", static_cast<double>(s.pellets));
  summary.input("spheres", static_cast<double>(sim.size()));
  summary.input("bonds", static_cast<double>(m.bonds));
  summary.input("strength_kpa", s.strength);
  summary.input("weibull_modulus", s.scatter);
  summary.input("rpm", s.rpm);
  summary.input("turns", s.turns);
  summary.input("pellet_mass_kg", m.mass);
}

template <class Sim>
void add_results(example::Summary& summary, const Sim& sim, const Pieces& end, const Tumbling& m) {
  const auto e = sim.energy();
  summary.result("broken_bonds_over_all",
                 static_cast<double>(sim.broken_bonds()) / static_cast<double>(m.bonds));
  summary.result("fines", end.fines);
  summary.result("pieces", end.count);
  summary.result("work_of_the_drum_j", e.walls);
  summary.result("broken_j", e.bond_breaking);
  summary.result("damped_in_bonds_j", e.bond_damping);
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
}

template <class Sim>
void check_run(example::Summary& summary, const Scene& s, const Sim& sim, const Pieces& end,
               const Tumbling& m) {
  const auto e = sim.energy();
  summary.check_within("mass_of_pieces_over_pellets",
                       end.mass / (m.mass * static_cast<double>(s.pellets)), 1, 1e-12, "rounding");
  summary.check_within(
      "bonds_held_and_broken_over_made",
      static_cast<double>(sim.bonds() + sim.broken_bonds()) / static_cast<double>(m.bonds), 1, 0,
      "counts");
  summary.check_within("energy_of_breaks_over_ledger",
                       e.bond_breaking > 0 ? m.lost / e.bond_breaking : 1, 1, 1e-9, "rounding");
  summary.check_at_most("fines_that_grew_together", m.grown, 1e-12);
  summary.check_within("energy_unexplained_over_dissipated", e.residual() / e.dissipated(), 0, 1e-3,
                       "friction at meshes and turned arms, first order in the step");
  if (s.strength > 0)
    summary.check_at_least("bonds_broken", static_cast<double>(sim.broken_bonds()), 1);
  else
    summary.check_at_most("bonds_broken", static_cast<double>(sim.broken_bonds()), 0);
}

/// Draws the pieces at the end and over the turns; false if it could not.
inline bool draw_run(const std::string& out, const Scene& s) {
  return example::draw({"draw", out + "/end.vtp", "--walls", out + "/walls.vtp", "--colour",
                        "piece over pellet", "--title",
                        silt::text("After ", s.turns, " turns, coloured by the mass of the piece"),
                        "--out", out + "/drum.png"}) &&
         example::draw({"curves", out + "/pieces.csv", "--x", "turns", "--y",
                        "largest piece,broken bonds,fines", "--log", "y", "--y-label",
                        "share of a pellet, of all bonds, of all mass [-]", "--title",
                        silt::text("Pellets of bonds of ", s.strength, " kPa"), "--out",
                        out + "/pieces.png"});
}

}  // namespace pellet
