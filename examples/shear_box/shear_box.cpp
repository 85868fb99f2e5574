// silt - BSD-3-Clause, see LICENSE
//
// Direct shear test of soil mechanics. A box is split at mid-height: its lower half moves sideways,
// a lid under a dead weight presses on the sample. A dense and a loose sample of spheres, each at
// three normal stresses: shear stress and lid height over displacement, Mohr-Coulomb lines, and
// dilatancy against Taylor's rule.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp tables and checks.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "shear_box/measure.hpp"
#include "shear_box/report.hpp"
#include "shear_box/scene.hpp"
#include "support/example.hpp"

namespace shear_box {
namespace {

/// One test: a sample under one normal stress.
Test run(const Scene& s, bool is_dense, double stress, const example::Options& options) {
  const example::Stopwatch watch;
  Test t;
  t.name = is_dense ? "dense" : "loose", t.stress = stress;
  const std::string sample = options.out + "/" + t.name + ".silt";
  auto sim = make_box(s, is_dense, options.threads);
  silt::load_checkpoint(sim, sample);
  sim.set_drive("lid", press(s, stress));
  if (!come_to_rest(sim, s, stress))
    std::printf("%s: it does not come to rest before the shear\n", t.title().c_str());
  t.grains = sim.size();
  t.void_ratio = s.area() * height(sim) / solid_volume(sim) - 1;
  t.contacts = 2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size());
  t.overlap = mean_overlap(sim) / s.diameter;
  load_lid(sim, s, stress);
  std::vector<Vec3d> start(sim.rows());
  std::vector<double> moved;  // [mm]
  for (std::size_t k = 0; k < sim.rows(); ++k) start[sim.id(k)] = sim.position(k);
  const double ramp = 0.1 * s.diameter / s.speed();
  for (const char* wall : {"lower half", "floor"})
    sim.set_motion(wall, shear_from(sim.time(), s.speed(), ramp));
  constexpr std::size_t points = 120, late = 40;
  const double piece = (s.travel * s.diameter / s.speed() + 0.5 * ramp) / points;
  Shear shear(sim, t);
  for (std::size_t k = 0; k < points - late; ++k) shear.piece(piece);
  shear_on(sim, shear, s, t, late, piece);
  write(options.out, s, t);
  if (is_dense && stress == s.stress.back()) {
    silt::write_particles(options.out + "/end.vtp", sim,
                          [&](const auto& of, auto& fields, const auto& places) {
                            moved.clear();
                            for (const auto k : places)
                              moved.push_back(1e3 * (of.position(k).x - start[of.id(k)].x));
                            fields.add("displacement [mm]", moved);
                          });
    silt::write_contacts(options.out + "/contacts.vtp", sim);
  }
  std::printf("%-14s  peak %.3f, residual %.3f, lid up by %.2f mm, %.0f s\n", t.title().c_str(),
              t.at_peak(ratio), t.residual(ratio), 1e3 * t.curve.back().rise, watch.seconds());
  std::fflush(stdout);
  return t;
}

int simulate(const Scene& s, const example::Options& options) {
  silt::make_folder(options.out);
  const example::Stopwatch watch;
  std::vector<Test> tests;
  for (const bool is_dense : {true, false}) {
    prepare(s, is_dense, options.threads, options.out + (is_dense ? "/dense.silt" : "/loose.silt"));
    std::printf("%s sample: made after %.0f s\n", is_dense ? "dense" : "loose", watch.seconds());
    std::fflush(stdout);
    for (const double stress : s.stress) tests.push_back(run(s, is_dense, stress, options));
  }
  example::Summary summary;
  add_inputs(summary, s);
  summary.result("seconds", watch.seconds());
  double overlap = 0;
  for (const Test& t : tests) check_test(summary, s, t), overlap = std::max(overlap, t.overlap);
  check_samples(summary, s, tests);
  summary.check_at_most("mean overlap over mean diameter", overlap, options.quick ? 2e-3 : 1.2e-3);
  summary.check_at_most("inertial number", s.inertial, 1e-2);
  summary.write(options.out + "/summary.json");
  write_mohr(options.out, s, tests);
  summary.print_checks();
  const double sheared = s.travel * s.diameter;
  example::run_script(SILT_SHEAR_BOX_SCRIPT,
                      {options.out, silt::text(s.L()), silt::text(s.W()), silt::text(s.split()),
                       silt::text(sheared), silt::text(s.height * s.diameter - s.split())});
  return summary.all_hold() ? 0 : 1;
}

}  // namespace
}  // namespace shear_box

int main(int argc, char** argv) {
  example::Command command(
      "Direct shear test of a dense and a loose sample of spheres under three normal stresses",
      example::Kind::Cases, "out/shear_box");
  shear_box::Scene s;
  command.add("--friction", s.friction, 0.05, 2, "Friction between particles [-]");
  command.add("--wall-friction", s.wall_friction, 0, 1, "Friction on the sides of the box [-]");
  command.add("--length", s.length, 10, 200, "Length of the box, in grain diameters");
  command.add("--width", s.width, 5, 100, "Width of the box, in grain diameters");
  command.add("--height", s.height, 6, 100, "Height of the sample, in grain diameters");
  command.add("--travel", s.travel, 1.5, 20, "Displacement of the lower half, in grain diameters");
  command.add("--inertial-number", s.inertial, 1e-5, 5e-2,
              "Inertial number at the lowest stress [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    if (options.quick) {
      if (!command.given("--length")) s.length = 16;
      if (!command.given("--width")) s.width = 8;
      if (!command.given("--height")) s.height = 8;
      if (!command.given("--travel")) s.travel = 2.5;
      if (!command.given("--inertial-number")) s.inertial = 1e-2;
      s.stiffness = 3e4;
    }
    return shear_box::simulate(s, options);
  });
}
