// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: surface, pictures, summary.json with its checks.

#include <cmath>
#include <string>
#include <vector>

#include "heap/measure.hpp"
#include "support/example.hpp"

namespace heap {

/// Known results for heaps of 500 grains of each shape (docs/shapes.md, A heap).
struct Known {
  std::string shapes;
  double angle, ratio;  // [degrees]; [-] run-out over aspect ratio
};
inline const std::vector<Known> known{
    {"spheres", 18.2, 1.22},       {"rough-spheres", 25.8, 0.93}, {"super-ellipsoids", 24.7, 0.95},
    {"multi-spheres", 24.0, 1.03}, {"cubes", 23.8, 0.84},         {"mix", 24.5, 1.08}};

/// Fails for missing friction: a packing of frictionless spheres has 5.8 degrees (P.-E. Peyneau,
/// J.-N. Roux, Phys. Rev. E 78 (2008) 011307), and its front runs to the channel's end. For missing
/// rolling resistance: rough spheres would behave like spheres. For contacts that stick: the column
/// would not collapse.
inline void check_slopes(example::Summary& summary, const Scene& s, bool quick, double angle,
                         double ratio) {
  if (quick) {
    summary.check_within(
        "angle_of_repose_deg", angle, 23, 6,
        "120 grains of any shape lay at 19 to 27 degrees; one heap tells its angle "
        "to some 5");
    return;
  }
  const bool as_known = s.particles == Scene{}.particles && s.rolling == Scene{}.rolling;
  for (const auto& of : known) {
    if (!as_known || of.shapes != s.shapes) continue;
    summary.check_within("angle_of_repose_deg", angle, of.angle, 5,
                         "the heap of docs/shapes.md; one heap of 500 tells its angle to some 5");
    summary.check_within("run_out_over_aspect_ratio", ratio, of.ratio, 0.25,
                         "the heap of docs/shapes.md; a front of single grains is known to +-2, "
                         "of ten grains along the column");
  }
  if (!as_known) summary.check_at_least("angle_of_repose_deg", angle, 12);
}

template <class Sim>
void write_picture(const std::string& path, const Sim& sim) {
  if constexpr (Sim::has_surfaces)
    silt::write_surfaces(path, sim);
  else
    silt::write_particles(path, sim);
}

inline void write_surface(const std::string& path, const Heap& heap) {
  silt::CsvTable surface(path, {"x [m]", "height [m]"});
  for (int k = 0; k < heap.columns(); ++k) surface.add_row({heap.place(k), heap.height(k)});
}

inline void add_inputs(example::Summary& summary, const Scene& s, int threads) {
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("shapes", s.shapes);
  summary.input("grain_equal_volume_radius_m", s.grain);
  summary.input("column_length_m", s.length);
  summary.input("channel_width_m", s.width);
  summary.input("density_kg_m3", s.density);
  summary.input("youngs_modulus_pa", s.material().youngs_modulus);
  summary.input("restitution", s.material().restitution);
  summary.input("friction", s.material().friction);
  summary.input("rolling_friction", s.shapes == "rough-spheres" ? s.rolling : 0.0);
  summary.input("threads", static_cast<double>(threads));
}

template <class Sim>
void add_results(example::Summary& summary, const Sim& sim, const Collapse& c) {
  summary.result("angle_of_repose_deg", c.heap.angle());
  summary.result("aspect_ratio_of_the_column", c.aspect());
  summary.result("run_out_over_column_length", c.run_out());
  summary.result("run_out_over_aspect_ratio", c.run_out() / c.aspect());
  summary.result("solid_fraction_before", c.bed.solid_fraction());
  summary.result("solid_fraction_after", c.heap.solid_fraction());
  summary.result("kinetic_energy_over_weight_times_diameter", c.heap.kinetic_energy());
  summary.result("time_to_rest_s", c.ended - c.opened);
  summary.result("largest_overlap_over_least_radius", sim.peak_overlap());
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
}

inline void check_run(example::Summary& summary, const Scene& s, const Collapse& c, bool quick) {
  // Fails for a heap that never comes to rest: contacts that generate energy.
  summary.check_at_most("kinetic_energy", c.heap.kinetic_energy(), s.at_rest);
  // Fails for a heap that reaches the wall at the channel's end: its run-out would mean nothing.
  summary.check_at_most("front_m", c.heap.front(), s.channel - s.diameter());
  check_slopes(summary, s, quick, c.heap.angle(), c.run_out() / c.aspect());
}

/// Draws the column and the heap that came to rest after some seconds; false if it could not.
inline bool draw_run(const std::string& out, const Scene& s, double seconds) {
  const bool mixed = s.shapes == "mix";
  std::vector<std::string> picture{"draw", out + "/before.vtp", out + "/after.vtp", "--colour",
                                   mixed ? "shape" : "id"};
  if (mixed)
    picture.insert(picture.end(), {"--names", "spheres,multi-spheres,super-ellipsoids,cubes"});
  else
    picture.insert(picture.end(), {"--range", silt::text("0,", s.particles)});
  for (const auto& word : {std::string("--title"),
                           std::string(mixed ? "before" : "ids as they were filled in, from below"),
                           silt::text("at rest, ", std::round(100 * seconds) / 100, " s later"),
                           std::string("--out"), out + "/heap.png"})
    picture.push_back(word);
  return example::draw(picture);
}

}  // namespace heap
