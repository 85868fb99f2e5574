// silt - BSD-3-Clause, see LICENSE
//
// Three choices of the time step with breakage: for the smallest possible fragment, for the
// smallest existing one (BreakStep::SmallestLiving), and with smaller grains made softer
// (Softened). Two scenes: a shower onto a plate, in which most grains break at once, and a dilute
// feed onto an inclined plate, whose product leaves before the next grain breaks.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <silt/breakage/equivalence.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/contact/softened.hpp>
#include <silt/io/break_observers.hpp>

#include "study/crowds.hpp"
#include "study/studies.hpp"

namespace breakage_step_study {

namespace {

using Law = silt::Softened<silt::HertzMindlin>;

constexpr double dust_below = 0.3e-3;  // [m] diameter

/// How a variant chooses its step.
struct Way {
  silt::BreakStep step = silt::BreakStep::SmallestPossible;
  double full_diameter = 0;  // [m] below which grains are softened
  double share = 1;          // [-] of silt's own step
  double faster = 1;         // [-] speeds at the start
};

Law::Material salt(const Way& way) {
  Law::Material m{
      .solid = {.youngs_modulus = 2e9, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.3},
      .full_radius = 0.5 * way.full_diameter};
  if (way.full_diameter == 0) m.deepest = INFINITY;
  return m;
}

auto scene(silt::Particles<silt::Sphere> grains, const Way& way) {
  silt::Simulation sim{
      std::move(grains), silt::Contacts<Law>{salt(way)},
      silt::Breakage{silt::LogLogisticStrength{
                         .median = 16, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3},
                     silt::HertzEquivalence{},
                     silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
                     silt::PowerFatigue{.kappa = 0.1, .psi = 3},
                     {.dust_below = dust_below, .step = way.step}}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.guard.max_overlap = sim.guard.max_travel = 2;  // what is too deep the study wants to see
  return sim;
}

auto shower(std::size_t count, const Way& way) {
  const double side = 2.6e-3 * std::ceil(std::sqrt(static_cast<double>(count) / 4));
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 2e-3}, {side, side, 0.012}}, {.radius = silt::uniform(0.9e-3, 1.1e-3),
                                                    .density = 2165,
                                                    .count = count,
                                                    .velocity = {0, 0, -12 * way.faster}});
  auto sim = scene(std::move(grains), way);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt(way));
  return sim;
}

/// Grains of 2 mm fall at 8 m/s, 500 per second, onto a plate at 45 degrees; their products leave
/// through outlets.
auto feed(const Way& way) {
  auto sim = scene({}, way);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 1}}, salt(way));
  sim.add_inlet(silt::Box{{0.002, 0, 0.02}, {0.012, 0.03, 0.025}},
                {.radius = silt::uniform(0.9e-3, 1.1e-3),
                 .density = 2165,
                 .rate = 500,
                 .velocity = {0, 0, -8 * way.faster}});
  sim.add_outlet(silt::Box{{0.025, -1, -1}, {1, 1, 1}});
  sim.add_outlet(silt::Box{{-1, -1, -1}, {1, 1, -0.025}});
  sim.add_outlet(silt::Box{{-1, -1, 0.035}, {1, 1, 1}});
  sim.add_outlet(silt::Box{{-1, -1, -1}, {-0.005, 1, 1}});
  for (const double y : {-1.01, 0.04}) sim.add_outlet(silt::Box{{-1, y, -1}, {1, y + 1, 1}});
  return sim;
}

/// Mass fractions of the product finer than some sizes.
template <class Sim>
std::vector<double> sizes_of(const Sim& sim) {
  silt::SizeTable product = silt::sizes_present(sim);
  product.merge(sim.dust()), product.merge(sim.left());
  std::vector<double> finer;
  for (const double mm : {0.1, 0.3, 0.6, 1.0, 1.5}) finer.push_back(product.finer(1e-3 * mm));
  return finer;
}

template <class Scene>
silt::Study::Variant variant(const Scene& scene, double duration, bool energy, const Way& way) {
  return [=](silt::StudyRun& run) {
    auto sim = scene(way);
    if (way.share < 1) sim.run(1e-9), sim.time_step = way.share * sim.step_length();
    run.time([&] { sim.run(duration); });
    run.value("broken", static_cast<double>(sim.broken()));
    run.value("sizes", sizes_of(sim));
    if (energy) run.value("kinetic energy", 1e3 * studies::kinetic_energy(sim), "mJ");
    run.note("steps", static_cast<double>(sim.step()));
    run.note("mean dt", 1e6 * sim.time() / static_cast<double>(sim.step()), "us");
    run.note("worst overlap", 100 * sim.peak_overlap() / 2, "%");
    run.note("safeguarded", static_cast<double>(sim.safeguarded()));
  };
}

template <class Scene>
silt::Study study(const std::string& name, const Scene& scene, double duration, bool energy) {
  constexpr auto living = silt::BreakStep::SmallestLiving;
  silt::Study study(name);
  const auto with = [&](const Way& way) { return variant(scene, duration, energy, way); };
  study.reference("smallest possible, half the step", with({.share = 0.5}));
  study.variant("smallest possible", with({}));
  study.variant("smallest living", with({.step = living}));
  for (const double mm : {0.6, 1.0, 1.5, 2.0})
    study.variant(silt::text("softened below ", mm, " mm"), with({.full_diameter = 1e-3 * mm}));
  study.variant("softened below 1 mm, living", with({.step = living, .full_diameter = 1e-3}));
  // Grain paths are chaotic: this is the difference of two runs with so few grains.
  study.control("half the step, 0.1 % faster", with({.share = 0.5, .faster = 1.001}));
  return study;
}

void summarise(const std::string& name, const silt::Study& study, example::Summary& summary) {
  const auto& rows = study.results().rows;
  studies::add_recommendation(summary, name, study);
  for (const std::size_t k : {1, 2, 3, 4, 5, 6}) {
    summary.result(silt::text("cost_gain_", name, "_", rows[k].name),
                   rows[0].cost() / rows[k].cost());
    summary.result(silt::text("steps_share_", name, "_", rows[k].name),
                   rows[k].note("steps")->value / rows[0].note("steps")->value);
  }
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::size_t count = setting.quick ? 100 : 600;
  const double duration = setting.quick ? 0.1 : 0.8;  // [s] of the feed
  summary.input("particles", static_cast<double>(count));
  silt::Study falling = study(
      silt::text("Time step and breakage: a shower of ", count, " grains"),
      [count](const Way& way) { return shower(count, way); }, 2e-3, true);
  silt::Study fed = study(
      "Time step and breakage: a thin feed", [](const Way& way) { return feed(way); }, duration,
      false);
  for (auto* one : {&falling, &fed})
    one->accept("error of broken", 0.03), one->accept("error of sizes", 0.03);
  studies::run_and_report(falling, setting, "shower");
  studies::run_and_report(fed, setting, "feed");
  summarise("shower", falling, summary);
  summarise("feed", fed, summary);
  // Fails for a step that never increases again, and for one that never is that of the fragments.
  const auto& rows = fed.results().rows;
  const double share = rows[1].note("steps")->value / rows[0].note("steps")->value;
  summary.check_at_most("feed_steps_of_smallest_living_over_possible", share, 0.9);
  summary.check_at_least("feed_steps_of_smallest_living_over_possible", share, 0.1);
}

const studies::Registered here{
    "breakage-step", "time step where grains break: smallest possible, smallest living, softened",
    run};

}  // namespace

}  // namespace breakage_step_study
