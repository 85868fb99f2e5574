// silt - BSD-3-Clause, see LICENSE
//
// Possible savings in a coupled run: a force held over a fluid step, or drag that follows each
// particle's velocity; fluid values per particle, or on cells; a drag coefficient that is kept
// while changes are small; and fluid steps of 1 to 100 particle steps. Two scenes: a bubbling bed,
// and a dilute periodic system of colliding particles cooled by the drag of the gas. Reference:
// followed drag, recomputed at each step, one fluid step per particle step.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/fluid.hpp>

#include "study/studies.hpp"

namespace economy_study {

namespace {

constexpr double d = 1e-3;  // [m]
using Law = silt::HertzMindlin;
const Law::Material glass{2e5, 0.3, 0.8, 0.3};

struct Way {
  bool follows = true;
  silt::FollowedDrag drag{};
  int steps = 20;  // particle steps a fluid step
};

/// Calls `visit` with a coupling of that kind.
template <class Visit>
auto coupled(const Way& way, silt::FlowSolver flow, const Visit& visit) {
  const auto with = [&](auto fluid) {
    fluid.steps = way.steps;
    return visit(std::move(fluid));
  };
  if (way.follows)
    return with(silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, std::move(flow), way.drag});
  return with(silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, std::move(flow)});
}

template <class Fluid>
auto scene(silt::Particles<silt::Sphere> grains, Fluid fluid, double time_step) {
  const auto& g = fluid.flow().grid();
  const silt::PeriodicBox domain{g.box(), {g.periodic(0), g.periodic(1), g.periodic(2)}};
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{glass}, domain, std::move(fluid)};
  sim.time_step = time_step, sim.threads = 1;
  return sim;
}

/// Gas at 1.2 m/s, 2.4 times the minimum fluidisation velocity, through a bed 20 diameters high.
silt::Study::Variant bed(const Way& way, double duration) {
  return [=](silt::StudyRun& run) {
    const double W = 10e-3, H = 60e-3;
    silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {W, W, H}}, {5, 5, 30}, {true, true, false}),
                          {1.2, 1.8e-5});
    flow.set_side(2, 0, silt::Inflow{{0, 0, 1.2}});
    flow.set_side(2, 1, silt::Outflow{});
    silt::Particles<silt::Sphere> grains;
    silt::Random random(1);
    for (int k = 0; k < 9 * 9 * 22; ++k) {
      const auto shift = [&] { return 0.05 * d * random.uniform(-1, 1); };
      grains.add({.position = {(k % 9 + 0.5) * W / 9 + shift(), (k / 9 % 9 + 0.5) * W / 9 + shift(),
                               (k / 81 + 0.6) * 1.1 * d + shift()},
                  .radius = 0.5 * d,
                  .density = 2500});
    }
    coupled(way, std::move(flow), [&](auto fluid) {
      auto sim = scene(std::move(grains), std::move(fluid), 1e-5);
      sim.gravity = {0, 0, -9.81};
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
      double drop = 0, height = 0, heat = 0;
      int count = 0;
      const auto look = [&](auto& s) {
        if (s.time() < 0.3 * duration) return;
        const auto& p = s.fluid().flow().pressure();
        for (int j = 0; j < 5; ++j)
          for (int i = 0; i < 5; ++i) drop += p(i, j, 0) / 25;
        const auto n = static_cast<double>(s.rows());
        silt::Vec3d mean{0, 0, 0};
        for (std::size_t k = 0; k < s.rows(); ++k) mean += (1 / n) * s.velocity(k);
        for (std::size_t k = 0; k < s.rows(); ++k) {
          const silt::Vec3d v = s.velocity(k);
          height += s.position(k).z / n;
          heat += dot(v - mean, v - mean) / (3 * n);
        }
        ++count;
      };
      run.time([&] { sim.run(duration, silt::at(silt::every(5e-4), look)); });
      run.value("pressure drop", drop / count, "Pa");
      run.value("height", 1e3 * height / count, "mm");
      run.value("fluctuation", heat / count, "m2/s2");
    });
  };
}

/// 6.5 % of grains of 0.2 mm in an otherwise quiescent gas; drag and collisions reduce their
/// granular temperature.
silt::Study::Variant cooling(const Way& way, double duration) {
  return [=](silt::StudyRun& run) {
    const double small = 0.2e-3, W = 4e-3;
    silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {W, W, W}}, {8, 8, 8}, {true, true, true}),
                          {1.2, 1.8e-5});
    silt::Particles<silt::Sphere> grains;
    silt::Random random(2);
    for (int k = 0; k < 1000; ++k) {
      const auto any = [&] { return random.uniform(-1, 1); };
      grains.add({.position = {(k % 10 + 0.5) * W / 10, (k / 10 % 10 + 0.5) * W / 10,
                               (k / 100 + 0.5) * W / 10},
                  .radius = 0.5 * small,
                  .density = 500,
                  .velocity = {0.4 * any(), 0.4 * any(), 0.4 * any()}});
    }
    coupled(way, std::move(flow), [&](auto fluid) {
      auto sim = scene(std::move(grains), std::move(fluid), 2e-6);
      const auto temperature = [&] {
        double sum = 0;
        for (std::size_t k = 0; k < sim.rows(); ++k)
          sum += dot(sim.velocity(k), sim.velocity(k)) / 3 / static_cast<double>(sim.rows());
        return sum;
      };
      run.time([&] { sim.run(0.5 * duration); });
      run.value("temperature halfway", temperature(), "m2/s2");
      run.time([&] { sim.run(0.5 * duration); });
      run.value("temperature", temperature(), "m2/s2");
      double energy = 0;
      const auto& f = sim.fluid().flow();
      for (int d3 = 0; d3 < 3; ++d3)
        for (int k = 0; k < 8; ++k)
          for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) energy += std::pow(f.velocity(d3)(i, j, k), 2) / 512;
      run.value("gas", energy, "m2/s2");
    });
  };
}

struct Named {
  std::string name;
  Way way;
};

std::vector<Named> ways(bool quick, double cell) {
  std::vector<Named> all;
  const std::vector<int> counts =
      quick ? std::vector<int>{5, 50} : std::vector<int>{1, 2, 5, 10, 20, 50, 100};
  for (const int n : counts) all.push_back({silt::text("held, ", n), {false, {}, n}});
  for (const int n : counts) all.push_back({silt::text("followed, ", n), {true, {}, n}});
  const int n = quick ? 5 : 20;
  for (const double tolerance : {0.01, 0.02, 0.05, 0.1})
    if (!quick || tolerance == 0.05)
      all.push_back(
          {silt::text("followed, ", n, ", lazy ", tolerance), {true, {.tolerance = tolerance}, n}});
  for (const int size : {1, 2, 4})
    if (!quick || size == 2)
      all.push_back({silt::text("followed, ", n, ", cells ", size, " d"),
                     {true, {.cell = size * cell, .tolerance = 0}, n}});
  return all;
}

template <class Scene>
silt::Study study(const std::string& title, const Scene& scene, double duration, double diameter,
                  bool quick) {
  silt::Study study(title);
  study.reference("followed, 1", scene(Way{true, {}, 1}, duration));
  for (const Named& named : ways(quick, diameter))
    study.variant(named.name, scene(named.way, duration));
  return study;
}

void run(const studies::Setting& setting, example::Summary& summary) {
  silt::Study dilute = study("Coupling economies: a dilute crowd cools, 1000 spheres", cooling,
                             setting.quick ? 2e-3 : 4e-3, 0.2e-3, setting.quick);
  dilute.accept("error of temperature", 0.01);
  studies::run_and_report(dilute, setting, "dilute");
  studies::add_recommendation(summary, "dilute", dilute);
  for (const auto& row : dilute.results().rows)
    if (row.name == "followed, 5" && !row.failed())
      summary.check_at_most("followed_5_temperature_error",
                            row.error("error of temperature")->value, 0.01);

  silt::Study bubbling = study("Coupling economies: a bubbling bed, 1782 spheres", bed,
                               setting.quick ? 0.01 : 0.05, d, setting.quick);
  bubbling.accept("error of pressure drop", 0.02);
  studies::run_and_report(bubbling, setting, "bed");
  studies::add_recommendation(summary, "bed", bubbling);
}

const studies::Registered here{
    "economy", "a coupled run: held or followed drag, cells, lazy drag, fluid steps", run};

}  // namespace

}  // namespace economy_study
