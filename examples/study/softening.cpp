// silt - BSD-3-Clause, see LICENSE
//
// Gain and cost of softening small spheres: silt::Softened gives spheres smaller than `full_radius`
// the contact time of that radius. The time step increases by full_radius over the smallest radius.
// A poured bed shows the effect on bulk results; a fast gas shows the effect on energy and overlap,
// where the safeguard must act.

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/contact/softened.hpp>

#include "study/crowds.hpp"
#include "study/studies.hpp"

namespace softening_study {

namespace {

using Law = silt::Softened<silt::HertzMindlin>;

constexpr double smallest = 0.5e-3, largest = 2.5e-3;  // [m] radii, uniform in between
constexpr double factors[] = {1, 1.5, 2, 3, 4, 5};     // [-] full radius over the smallest

silt::Particles<silt::Sphere> wide_sizes(std::size_t count, const silt::Box& region,
                                         silt::Arrangement arrangement) {
  silt::Particles<silt::Sphere> spheres;
  spheres.fill(region, {.radius = silt::uniform(smallest, largest),
                        .density = 2500,
                        .count = count,
                        .arrangement = arrangement});
  return spheres;
}

/// Both scenes use silt's own time step, 1/20 of the shortest contact at the initial speeds.
template <class Sim>
Sim prepared(Sim sim) {
  sim.threads = 1;
  sim.guard.max_overlap = sim.guard.max_travel = 2;  // what is too deep the study wants to see
  return sim;
}

/// A bed of 1e8 Pa that falls at 1 m/s into a box and is at rest after 0.3 s.
auto bed(std::size_t count, double full_radius, double gravity) {
  const double side = 2 * largest * std::ceil(std::cbrt(static_cast<double>(count)) * 0.7);
  auto spheres = wide_sizes(count, {{0, 0, 0}, {side, side, 8 * side}}, silt::Arrangement::Lattice);
  for (std::size_t k = 0; k < spheres.size(); ++k) spheres[k].velocity = {0.3, -0.2, -1};
  auto solid = studies::glass;
  solid.youngs_modulus = 1e8;
  const Law::Material material{.solid = solid, .full_radius = full_radius};
  auto sim = prepared(silt::Simulation{std::move(spheres), silt::Contacts<Law>{material}});
  sim.gravity = {0, 0, -9.81 * gravity};
  sim.add_wall(silt::box({0, 0, 0}, {side, side, 20 * side}), material);
  return sim;
}

/// A gas at 10 m/s without drag, 1e9 Pa, e = 0.9. The time between collisions is about 0.2 ms:
/// contacts that last a noticeable part of it occur less often, and less energy is lost.
auto gas(std::size_t count, double full_radius, double faster) {
  const double mean_cube = (smallest + largest) * (smallest * smallest + largest * largest) / 4;
  const double side = std::cbrt(4.0 / 3.0 * M_PI * mean_cube * static_cast<double>(count) / 0.15);
  auto spheres = wide_sizes(count, {{0, 0, 0}, {side, side, side}}, silt::Arrangement::Random);
  silt::Random random(2);
  for (std::size_t k = 0; k < spheres.size(); ++k)
    for (double* v : {&spheres[k].velocity.x, &spheres[k].velocity.y, &spheres[k].velocity.z})
      *v = random.uniform(-10, 10) * faster;
  auto solid = studies::glass;
  solid.youngs_modulus = 1e9, solid.restitution = 0.9;
  return prepared(silt::Simulation{
      std::move(spheres),
      silt::Contacts<Law>{Law::Material{.solid = solid, .full_radius = full_radius}},
      silt::PeriodicBox{{{0, 0, 0}, {side, side, side}}, {true, true, true}}});
}

/// Steps and overlaps of both scenes.
template <class Sim>
void tell(silt::StudyRun& run, const Sim& sim) {
  run.error("worst overlap", 100 * sim.peak_overlap() / 2, "%");
  run.note("dt", 1e6 * sim.step_length(), "us");
  run.note("safeguarded", static_cast<double>(sim.safeguarded()));
}

silt::Study::Variant bed_variant(std::size_t count, double factor, double gravity = 1) {
  return [=](silt::StudyRun& run) {
    auto sim = bed(count, factor > 1 ? factor * smallest : 0, gravity);
    run.time([&] { sim.run(0.3); });
    run.value("height", 1e3 * studies::mean_height(sim), "mm");
    run.value("contacts a sphere",
              2 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size()));
    tell(run, sim);
  };
}
silt::Study::Variant gas_variant(std::size_t count, double factor, double faster = 1) {
  return [=](silt::StudyRun& run) {
    auto sim = gas(count, factor > 1 ? factor * smallest : 0, faster);
    run.time([&] { sim.run(0.002); });
    run.value("kinetic energy", 1e3 * studies::kinetic_energy(sim), "mJ");
    tell(run, sim);
  };
}

template <class Variant>
silt::Study study(const std::string& name, std::size_t count, const Variant& variant) {
  silt::Study study(name);
  study.reference("full modulus", variant(count, 1, 1));
  for (const double factor : factors)
    study.variant(factor > 1 ? silt::text("R_full = ", factor, " R_min") : "full modulus",
                  variant(count, factor, 1));
  // Sphere paths are chaotic: this is the difference of two runs with so few spheres.
  study.control("full modulus, 0.1 % off", variant(count, 1, 1.001));
  return study;
}

void summarise(const std::string& name, const silt::Study& study, example::Summary& summary) {
  const auto& rows = study.results().rows;
  studies::add_recommendation(summary, name, study);
  for (std::size_t k = 0; k < std::size(factors); ++k) {
    const std::string of = silt::text("_", name, "_factor_", factors[k]);
    const double gain = rows[k].note("dt")->value / rows[0].note("dt")->value;
    summary.result("time_step_gain" + of, gain);
    summary.result("cost_gain" + of, rows[0].cost() / rows[k].cost());
    // Contacts of spheres of R_full are then the shortest; with walls, which stay stiff, they are
    // shorter by up to 2^(1/5).
    summary.check_at_least("time_step_gain_over_factor" + of, gain / factors[k], 0.87);
    summary.check_at_most("time_step_gain_over_factor" + of, gain / factors[k], 1.0001);
  }
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::size_t count = setting.quick ? 200 : 800;
  summary.input("particles", static_cast<double>(count));
  silt::Study poured =
      study(silt::text("Softening: ", count, " spheres of 1 to 5 mm poured into a box"), count,
            [](std::size_t n, double factor, double off) { return bed_variant(n, factor, off); });
  poured.accept("error of height", 0.02);
  poured.accept("error of contacts a sphere", 0.03);
  poured.accept("worst overlap", 15);
  silt::Study flying =
      study(silt::text("Softening: ", count, " spheres of 1 to 5 mm, a gas at 10 m/s"), count,
            [](std::size_t n, double factor, double off) { return gas_variant(n, factor, off); });
  flying.accept("error of kinetic energy", 0.02);
  flying.accept("worst overlap", 15);
  studies::run_and_report(poured, setting, "bed");
  studies::run_and_report(flying, setting, "gas");
  summarise("bed", poured, summary);
  summarise("gas", flying, summary);
}

const studies::Registered here{
    "softening", "small spheres made softer: gain in time step, bulk results, overlaps", run};

}  // namespace

}  // namespace softening_study
