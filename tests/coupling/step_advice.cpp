// silt - BSD-3-Clause, see LICENSE
//
// What a coupled run is stopped with: a shorter step is advised where it helps, and only there.

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

namespace step_advice_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Particles;
using silt::Sphere;

namespace {

constexpr double W = 8e-3, H = 24e-3;

/// A law of a user's that is wrong.
struct NoNumber {
  static constexpr const char* name = "NoNumber";
  template <class Real>
  Real normalised(const Real&, const Real& Re) const {
    return Re * Real(std::numeric_limits<double>::quiet_NaN());
  }
};

FlowSolver column(double density, double viscosity, double inflow) {
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 12}, {true, true, false}),
                  {density, viscosity});
  flow.set_side(2, 0, silt::Inflow{{0, 0, inflow}});
  flow.set_side(2, 1, silt::Outflow{});
  return flow;
}

template <class Drag>
auto scene(const Drag& drag, FlowSolver flow, double density, double time_step,
           std::optional<int> steps) {
  Particles<Sphere> grains;
  for (int k = 0; k < 36; ++k)
    grains.add({.position = {(k % 6 + 0.5) * W / 6, (k / 6 + 0.5) * W / 6, H / 2},
                .radius = 0.5e-3,
                .density = density});
  silt::CoupledFlow fluid{drag, silt::Kernel{}, std::move(flow)};
  fluid.steps = steps;
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{{2e5, 0.3, 0.5, 0.3}},
                       silt::PeriodicBox{{{0, 0, 0}, {W, W, H}}, {true, true, false}},
                       std::move(fluid)};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step, sim.threads = 1;
  return sim;
}

template <class Sim>
std::string sentence(Sim& sim, double duration) {
  try {
    sim.run(duration);
  } catch (const silt::SimulationError& error) {
    return error.what();
  }
  return {};
}

bool says(const std::string& sentence, const char* words) {
  return sentence.find(words) != std::string::npos;
}

/// The number behind `words`.
double number_after(const std::string& sentence, const std::string& words) {
  const auto at = sentence.find(words);
  REQUIRE_MESSAGE(at != std::string::npos, sentence);
  return std::stod(sentence.substr(at + words.size()));
}

}  // namespace

TEST_CASE("a flow that crosses more than a cell: the steps that are advised help") {
  const auto run = [](int steps, double time_step) {
    auto sim = scene(silt::Gidaspow{}, column(1.2, 1.8e-5, 2), 2500, time_step, steps);
    return sentence(sim, 4e-3);
  };
  const std::string stopped = run(100, 2e-5);
  CAPTURE(stopped);
  CHECK(says(stopped, "crosses"));
  CHECK(says(stopped, "CoupledFlow.steps"));
  const double fewer = number_after(stopped, " s, ");
  CHECK(fewer < 100);
  CHECK(run(static_cast<int>(0.8 * fewer), 2e-5) == "");  // between grains it is faster
}

TEST_CASE("a drag law that gives no number: it is named, and no shorter step is advised") {
  for (const double time_step : {2e-5, 1e-6}) {
    auto sim = scene(NoNumber{}, column(1.2, 1.8e-5, 0.5), 2500, time_step, 10);
    const std::string stopped = sentence(sim, 1e-2);
    CAPTURE(stopped);
    CHECK(says(stopped, "FlowSolver: the drag"));
    CHECK(says(stopped, "for any step, however short"));
    CHECK_FALSE(says(stopped, "at most"));
  }
}

TEST_CASE("a velocity of the flow that is no number: no shorter step is advised") {
  FlowSolver flow = column(1.2, 1.8e-5, 0.5);
  flow.velocity(2)(1, 1, 3) = std::numeric_limits<double>::quiet_NaN();
  std::string stopped;
  try {
    flow.step(1e-4), flow.step(1e-4);
  } catch (const silt::Error& error) {
    stopped = error.what();
  }
  CAPTURE(stopped);
  CHECK(says(stopped, "FlowSolver: the velocity"));
  CHECK_FALSE(says(stopped, "use a step"));
}

TEST_CASE("light grains under a fluid step longer than a contact: refused, by density ratio") {
  // Their contacts would swing: docs/fluid.md. 20 kg/m3 in water.
  const auto run = [](std::optional<int> steps, double density) {
    auto sim = scene(silt::Gidaspow{}, column(1000, 1e-3, 0.01), density, 4e-6, steps);
    return sentence(sim, 2e-3);
  };
  const std::string stopped = run(50, 20);
  CAPTURE(stopped);
  CHECK(says(stopped, "particles of 0.02"));
  CHECK(says(stopped, "of the fluid's density"));
  const auto most = static_cast<int>(number_after(stopped, "set it to at most "));
  CHECK(most >= 2);
  CHECK(most < 50);
  CHECK(run(most, 20) == "");
  CHECK(run(std::nullopt, 20) == "");
  CHECK(run(50, 2500) == "");
}

}  // namespace step_advice_test
