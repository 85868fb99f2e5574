// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: the drum's rim, the bed's surface, pictures, summary.json with its checks.

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "drum_of_shapes/measure.hpp"
#include "support/example.hpp"

namespace drum_of_shapes {

/// The drum's rim, for pictures.
inline void write_outline(const Scene& s, const std::string& path) {
  std::vector<silt::Vec3d> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  constexpr std::uint32_t count = 180;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double turn = 2 * std::numbers::pi * k / count;
    points.push_back({s.radius * std::cos(turn), 0, s.radius * std::sin(turn)});
    points.push_back({s.radius * std::cos(turn), s.length, s.radius * std::sin(turn)});
    const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % count);
    triangles.push_back({a, b, a + 1}), triangles.push_back({b, b + 1, a + 1});
  }
  silt::write_vtp_triangles(path, points, triangles);
}

inline void write_surface(const std::string& path, const Occupancy& bed) {
  silt::CsvTable profile(path, {"x [m]", "height [m]"});
  for (int k = 0; k < 2 * Occupancy::cells; ++k)
    if (std::isfinite(bed.surface(k))) profile.add_row({bed.place(k), bed.surface(k)});
}

inline void add_inputs(example::Summary& summary, const Scene& s, int threads) {
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("shapes", s.shapes);
  summary.input("drum_radius_m", s.radius);
  summary.input("drum_length_m", s.length);
  summary.input("grain_equal_volume_radius_m", s.grain);
  summary.input("density_kg_m3", s.density);
  summary.input("rpm", s.rpm);
  summary.input("turns", s.turns);
  summary.input("youngs_modulus_pa", s.material().youngs_modulus);
  summary.input("restitution", s.material().restitution);
  summary.input("friction", s.material().friction);
  summary.input("threads", static_cast<double>(threads));
}

template <class Sim>
void add_results(example::Summary& summary, const Scene& s, const Sim& sim, const Measured& m) {
  summary.result("dynamic_angle_of_repose_deg", m.bed.angle());
  summary.result("power_w", m.power(s));
  summary.result("lost_in_contacts_w", m.impacts.lost() / s.turn());
  summary.result("torque_over_lever_of_the_weight", m.torque / m.lever);
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("particle_steps_per_s", m.particle_steps_per_s);
  summary.result("largest_overlap_over_least_radius", sim.peak_overlap());
}

inline void check_run(example::Summary& summary, const Scene& s, const Measured& m, bool quick) {
  // Angular momentum, for all shapes: averaged over a turn, the drum's torque balances the moment
  // of the grains' weight about its axis. Fails for a torque without friction or rolling
  // resistance, or about another point.
  summary.check_within("torque_over_lever_of_the_weight", m.torque / m.lever, 1, 0.1,
                       "200 samples of a turn: 2 % of noise in their mean; 60 grains in their "
                       "first turn were 5 % off");
  // Energy: the drum's work equals the dissipation. Fails for a spectrum that misses contacts or
  // counts them twice.
  const bool first_turn = s.turns < 2;
  summary.check_within("lost_in_contacts_over_power", m.impacts.lost() / s.turn() / m.power(s), 1,
                       first_turn ? 0.3 : 0.1,
                       first_turn ? "the first turn raises the bed, too: 14 % with 60 grains"
                                  : "contacts that last through the turn are not counted: 900 "
                                    "grains were 1.2 % off");
  // Grains in a drum without friction would have a level surface.
  summary.check_at_least("dynamic_angle_of_repose_deg", m.bed.angle(), 15);
  if (!quick && s.particles == Scene{}.particles && s.rpm == Scene{}.rpm &&
      s.shapes == Scene{}.shapes)
    summary.check_within("dynamic_angle_of_repose_deg", m.bed.angle(), 39.6, 4,
                         "the run of docs/shapes.md; a drum's angle is good to some 2 degrees");
}

/// Draws the drum at the end and the spectrum of impacts; false if it could not.
inline bool draw_run(const std::string& out, const Scene& s) {
  return example::draw({"draw", out + "/end.vtp", "--colour", "shape", "--walls", out + "/drum.vtp",
                        "--names", "spheres,super-ellipsoids,cubes", "--title",
                        silt::text(s.rpm, " rpm"), "--out", out + "/drum.png"}) &&
         example::draw({"curves", out + "/impacts.csv", "--x", "lost energy", "--y",
                        "between grains,at the drum", "--y-label",
                        "contacts a grain and class [1/s]", "--log", "xy", "--title",
                        "Impact energy spectrum", "--out", out + "/impacts.png"});
}

}  // namespace drum_of_shapes
