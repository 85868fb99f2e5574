// silt - BSD-3-Clause, see LICENSE
// The time step that silt chooses for polyhedra that break.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "refusal.hpp"

namespace breakage_polyhedra_step_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

/// Four stones of 9 mm above a plate that they hit at `speed` [m/s]; most of them break.
auto drop(double speed, silt::BreakStep step) {
  const silt::HertzMindlin::Material rock{
      .youngs_modulus = 5e9, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.4};
  silt::Particles<silt::Polyhedron> stones;
  const auto form = stones.add_form(stone().scaled(5));
  for (int k = 0; k < 4; ++k)
    stones.add({.form = form,
                .position = {0.015 * (k % 2), 0.015 * (k / 2), 0.0055},
                .orientation = silt::rotation_about({1, 0, 0}, 0.4 * k),
                .density = 2600,
                .velocity = {0, 0, -speed}});
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{rock},
                       silt::EnergyLedger{},
                       silt::Breakage{silt::WeibullStrength{.scale = 0.0002 * speed * speed / 4,
                                                            .at_diameter = 10e-3,
                                                            .exponent = 2,
                                                            .modulus = 4},
                                      silt::EnergyEquivalence{},
                                      silt::GaudinSchuhmann{.exponent = 0.8, .coarsest = 0.7},
                                      {.dust_below = 2e-3, .most_fragments = 20, .step = step}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rock, silt::WallSetup{.name = "plate"});
  sim.guard.max_overlap = 0.6;
  return sim;
}

TEST_CASE(
    "breakage of polyhedra: cells are hardly lighter at their tips than the step reckons with") {
  std::vector<double> lightness;
  silt::Random random(5);
  for (const std::uint64_t seed : {1, 2, 3})
    for (const std::size_t count : {4, 12, 40}) {
      std::vector<double> shares(count, 1.0 / static_cast<double>(count));
      for (const auto& cell : silt::laguerre_cells(stone(seed), std::span(shares), random)) {
        double most = 0;
        for (const auto& spot : silt::BodyForm<silt::Polyhedron>(cell).spots)
          most = std::max(most, spot.lightness);
        lightness.push_back(most);
      }
    }
  std::sort(lightness.begin(), lightness.end());
  CHECK(lightness[lightness.size() * 97 / 100] < silt::detail::SmallestCell::lightness);
  CHECK(lightness[lightness.size() / 2] > 0.35 * silt::detail::SmallestCell::lightness);
  // Contacts last as lightness^-0.4: the guard's limit is 2.5 times the step.
  CHECK(lightness.back() < 16);
}

TEST_CASE("breakage of polyhedra: the step that silt chooses for them resolves their cells") {
  // Catches the step of a sphere of dust_below, which is two to three times as long as that of a
  // cell of its volume: the guard stops the run as the first cells turn.
  for (const double speed : {2.0, 6.0}) {
    auto living = drop(speed, silt::BreakStep::SmallestLiving);
    double least = 1;  // [s]
    living.run(4e-3, [&](const auto& s) { least = std::min(least, s.step_length()); });
    auto sim = drop(speed, silt::BreakStep::SmallestPossible);
    sim.run(4e-3);
    CHECK(sim.broken() >= 4);
    CHECK(sim.size() > 15);
    CHECK(sim.step_length() < 1.6 * least);
    CHECK(sim.step_length() > 0.4 * least);
    const auto e = sim.energy();
    CHECK(std::abs(e.residual()) < 0.01 * e.initial);
  }
}

TEST_CASE("breakage: a time step that silt chose and that becomes too long: who chose it") {
  const auto stopped = [](bool living, bool set) {
    silt::Particles<silt::Sphere> grains;
    for (const double x : {0.0, 0.01})
      grains.add(
          {.position = {x, 0, 0}, .radius = 1e-3, .density = 2165, .velocity = {0.05, 0, 0}});
    auto sim =
        simulation(std::move(grains), policy({.dust_below = 0.9e-3,
                                              .step = living ? silt::BreakStep::SmallestLiving
                                                             : silt::BreakStep::SmallestPossible}));
    sim.run(1e-6);
    if (set) sim.time_step = sim.step_length();
    sim.set_velocity(0, {20, 0, 0});
    return refusal([&] { sim.run(1e-4); });
  };
  const auto own = stopped(false, false);
  has(own, "above its limit");
  has(own,
      "; silt chose the time step, for slower or heavier ones: take BreakageRules.step = "
      "BreakStep::SmallestLiving, which follows them, or set a smaller Simulation::time_step or a "
      "softer material");
  const auto set = stopped(false, true);
  has(set, "; set a smaller Simulation::time_step or a softer material");
  CHECK(set.find("silt chose") == set.npos);
  const auto living = stopped(true, false);
  CHECK(living.find("SmallestLiving") == living.npos);
}

}  // namespace breakage_polyhedra_step_test
