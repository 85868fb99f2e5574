// silt - BSD-3-Clause, see LICENSE
//
// Gain and loss of accuracy with silt::Mixed (pairs of particles in float), against the same scene
// in double. Many-particle systems are chaotic: to separate this effect, a third variant in double
// starts with a difference of 1e-9.

#include <cmath>
#include <cstdio>

#include "study/crowds.hpp"
#include "study/studies.hpp"

namespace precision_study {

namespace {

constexpr double nudge = 1 + 1e-9;

template <class Precision>
silt::Study::Variant poured(std::size_t count, Precision precision, double gravity) {
  return [=](silt::StudyRun& run) {
    auto sim = studies::poured_bed(count, precision);
    sim.gravity = {0, 0, -9.81 * gravity};
    run.time([&] { sim.run(0.15); });
    run.value("height", 1e3 * studies::mean_height(sim), "mm");
    run.value("contacts a sphere",
              2 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size()));
  };
}

template <class Precision>
silt::Study::Variant colliding(std::size_t count, Precision precision, double faster) {
  return [=](silt::StudyRun& run) {
    auto sim = studies::gas(count, precision, faster);
    run.time([&] { sim.run(0.005); });
    run.value("kinetic energy", 1e3 * studies::kinetic_energy(sim), "mJ");
    run.value("velocities", studies::velocities(sim));
  };
}

void run(const studies::Setting& setting, example::Summary& summary) {
  using silt::Double, silt::Mixed;
  const std::size_t count = setting.quick ? 500 : 4000;
  summary.input("particles", static_cast<double>(count));

  silt::Study bed(
      silt::text("Precision: ", count, " spheres poured into a box, at rest after 0.15 s"));
  bed.reference("double", poured(count, Double{}, 1));
  bed.variant("double", poured(count, Double{}, 1));
  bed.control("double, gravity + 1e-9", poured(count, Double{}, nudge));
  bed.variant("mixed", poured(count, Mixed{}, 1));
  bed.accept("error of height", 0.005);
  bed.accept("error of contacts a sphere", 0.02);
  studies::run_and_report(bed, setting, "bed");

  silt::Study gas(
      silt::text("Precision: ", count, " spheres of a granular gas, two collisions each"));
  gas.reference("double", colliding(count, Double{}, 1));
  gas.variant("double", colliding(count, Double{}, 1));
  gas.control("double, speeds + 1e-9", colliding(count, Double{}, nudge));
  gas.variant("mixed", colliding(count, Mixed{}, 1));
  gas.accept("error of velocities", 1e-4);
  studies::run_and_report(gas, setting, "gas");

  studies::add_recommendation(summary, "bed", bed);
  studies::add_recommendation(summary, "gas", gas);
  for (const auto& [name, study] : {std::pair{"bed", &bed}, std::pair{"gas", &gas}}) {
    const auto& rows = study->results().rows;
    summary.result(silt::text("double_over_mixed_cost_", name), rows[0].cost() / rows[2].cost());
    for (const auto& e : rows[0].errors)
      summary.check_at_most(silt::text("double_again: ", e.name), e.value, 0);  // the same bits
    for (const auto& b : study->results().bounds)
      summary.check_at_most(silt::text("mixed: ", b.error), rows[2].error(b.error)->value, b.limit);
  }
}

const studies::Registered here{"precision", "double against mixed: a bed and a granular gas", run};

}  // namespace

}  // namespace precision_study
