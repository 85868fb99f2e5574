// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of a run: lines of the boxes, layers of grains, summary.json with its checks,
// pictures.

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hopper/measure.hpp"
#include "support/example.hpp"

namespace hopper {

/// Boxes and floor as lines for the pictures.
inline void write_outlines(const Scene& s, const std::string& path) {
  auto triangles = box_triangles(s);
  for (const auto& t : floor_triangles(s)) triangles.push_back(t);
  const silt::TriangleMesh mesh(triangles);
  silt::write_vtp_triangles(path, mesh.vertices(), mesh.triangles());
}

/// Cells in the vertical plane through the middle of the hopper, from its orifice to above the
/// filling.
inline silt::CoarseGrid middle_layer(const Scene& s) {
  const double cell = 2.5e-3, half = cell / 2, low = s.orifice_height() - 0.01,
               high = s.funnel_top() + 1.1 * s.bulk_height();  // [m]
  return {{{0, s.width / 2 - half, low}, {s.width, s.width / 2 + half, high}},
          {static_cast<int>(s.width / cell), 1, static_cast<int>((high - low) / cell)}};
}

/// A field of grains for write_particles: six layers, as in the paper's figure. The lattice is
/// filled from below, so ids increase with height.
inline auto layers(const Scene& s) {
  return [n = s.particles, values = std::make_shared<std::vector<std::uint32_t>>()](
             const auto& at, silt::VtkFields& fields, const auto& places) {
    values->clear();
    for (const auto k : places)
      values->push_back(static_cast<std::uint32_t>(6 * std::size_t{at.id(k)} / n));
    fields.add("layer", *values);
  };
}

/// What there is to draw.
struct Pictures {
  std::vector<std::string> grains{}, titles{};  // files of snapshots
  bool has_chains = false, has_flow = false;
};

inline void add_inputs(example::Summary& summary, const Scene& s, const std::string& precision,
                       const example::Options& options) {
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("density_kg_m3", s.density);
  summary.input("diameter_min_m", 2 * s.r_min);
  summary.input("diameter_max_m", 2 * s.r_max);
  summary.input("youngs_modulus_pa", s.material().youngs_modulus);
  summary.input("poisson_ratio", s.material().poisson_ratio);
  summary.input("restitution", s.material().restitution);
  summary.input("friction", s.material().friction);
  summary.input("box_width_m", s.width);
  summary.input("orifice_m", s.orifice);
  summary.input("floor", std::string(s.flat ? "flat" : "funnel, 45 degrees"));
  summary.input("time_step_s", s.time_step);
  summary.input("settling_time_s", s.settling_time());
  summary.input("sort", s.sort);
  summary.input("precision", precision);
  summary.input("threads", static_cast<double>(options.threads));
  summary.input("seed", 1.0);
  summary.input("restart", options.restart);
}

/// What came out; a run from a checkpoint has not seen all of it.
struct Outcome {
  double total = 0, out = 0;    // [kg] of all grains, and below the orifice
  double rate = 0, theory = 0;  // [kg/s]; by Beverloo
};

template <class Sim>
void add_results(example::Summary& summary, const Sim& sim, const Rest& rest,
                 const Discharge& curve, const Outcome& o, bool whole) {
  summary.result("solid_fraction_settled", rest.fraction);
  if (whole) {
    summary.result("discharge_rate_kg_s", o.rate);
    summary.result("discharge_rate_over_beverloo", o.rate / o.theory);
    summary.result("time_of_half_s", curve.time_of(0.5, o.total));
    summary.result("time_of_99_percent_s", curve.time_of(0.99, o.total));
  }
  summary.result("beverloo_rate_kg_s", o.theory);
  summary.result("discharged_share", o.out / o.total);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("kinetic_energy_at_rest_over_weight_times_diameter", rest.energy);
  summary.result("most_contacts", curve.most_contacts);
  summary.result("steps", static_cast<double>(sim.step()));
}

inline void report_contacts(example::Summary& summary, const Press& p) {
  summary.result("coordination_number_at_rest", p.coordination);
  summary.result("coordination_number_without_rattlers", p.without_rattlers);
  summary.check_at_most("contacts_against_wall_forces_over_weight", p.contacts_off, 1e-4);
  // No check: the bed is not quite at rest when the orifice opens (3 % with --quick).
  summary.result("weight_on_walls_off_by", p.weight_off);
}

template <class Sim>
void check_run(example::Summary& summary, const Scene& s, const Sim& sim, const Rest& rest,
               const Outcome& o, bool whole) {
  // If the guard's limit is lower (small grains, high rooms), the value is reported without a
  // check.
  const double deepest = overlap_of_fall(s);
  if (deepest < sim.guard.max_overlap)
    summary.check_at_most("largest_overlap_over_radius", sim.peak_overlap(), deepest);
  if (whole) {
    summary.check_at_most("at_rest_before_opening", rest.energy, 1e-3);
    summary.check_at_least("discharge_rate_over_beverloo", o.rate / o.theory, 0.85);
    summary.check_at_most("discharge_rate_over_beverloo", o.rate / o.theory, 1.15);
  }
  if (!s.flat) summary.check_at_least("discharged_share", o.out / o.total, 0.99);
}

/// Whether all pictures could be drawn.
///   theory: Beverloo's mass flow [kg/s]
inline bool draw_run(const std::string& out, const Scene& s, const Pictures& pictures,
                     double theory) {
  std::vector<std::string> arguments{"draw"};
  arguments.insert(arguments.end(), pictures.grains.begin(), pictures.grains.end());
  for (const char* a : {"--colour", "layer", "--view", "front", "--cut"}) arguments.push_back(a);
  arguments.push_back(silt::text("y=", s.width / 2));
  arguments.insert(arguments.end(), {"--walls", out + "/outlines.vtp", "--title"});
  arguments.insert(arguments.end(), pictures.titles.begin(), pictures.titles.end());
  arguments.insert(arguments.end(), {"--out", out + "/snapshots.png"});
  const std::string layer = out + "/flow.csv", chains = out + "/contacts_at_rest.vtp";
  return example::draw(arguments) &&
         (!pictures.has_flow ||
          example::draw({"cells", layer, "--value", "speed", "--least", "solid fraction=0.2",
                         "--walls", out + "/outlines.vtp", "--title", "Mean speed, middle layer",
                         "--out", out + "/flow.png"})) &&
         (!pictures.has_chains ||
          example::draw({"draw", chains, "--slab",
                         silt::text("y=", s.width / 2 - 3e-3, ",", s.width / 2 + 3e-3), "--walls",
                         out + "/outlines.vtp", "--title", "Before opening", "--out",
                         out + "/chains.png"})) &&
         example::draw({"curves", out + "/discharge.csv", "--x", "time", "--y", "mass below",
                        "--reference", silt::text("Beverloo:", theory, ",", 0), "--title",
                        "Discharge", "--out", out + "/discharge.png"}) &&
         example::draw({"curves", out + "/discharge.csv", "--x", "time", "--y",
                        "contacts,time per step", "--title", "Contacts and time per step", "--out",
                        out + "/contacts.png"});
}

}  // namespace hopper
