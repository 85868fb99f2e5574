// silt - BSD-3-Clause, see LICENSE
// Restarts with other rules of breakage or other materials: the time step.
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <silt/io/checkpoint.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"

namespace breakage_restart_rules_test {

using namespace breakage_scene;  // NOLINT: of this test alone

/// Grains far apart that fly.
auto flight(silt::BreakageRules rules, const silt::HertzMindlin::Material& solid = salt) {
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 4; ++k)
    grains.add({.position = {0.01 * k, 0, 0},
                .radius = 1e-3,
                .density = 2165,
                .velocity = {0, 0, 5.0 + k}});
  return silt::Simulation{std::move(grains), silt::Contacts<silt::HertzMindlin>{solid},
                          silt::EnergyLedger{}, policy(std::move(rules))};
}
using Flight = decltype(flight({}));

struct Saved {
  std::string file = (std::filesystem::temp_directory_path() / "silt_breakage_rules").string();
  double step;  // [s]
  explicit Saved(Flight sim) {
    sim.run(1e-5);
    step = sim.step_length();
    silt::save_checkpoint(sim, file);
  }
  ~Saved() { std::filesystem::remove(file); }
  void load(Flight& sim) const { silt::load_checkpoint(sim, file, {.materials = true}); }
  /// [s] after a restart.
  double continued(Flight sim) const {
    load(sim);
    sim.run(1e-6);
    return sim.step_length();
  }
};
double fresh(Flight sim) {
  sim.run(0);
  return sim.step_length();
}
auto stiffer() {
  auto of = salt;
  of.youngs_modulus *= 2;
  return of;
}
constexpr auto living = silt::BreakStep::SmallestLiving;

TEST_CASE(
    "restart with another dust_below, another material: the time step of a fresh simulation") {
  // Catches the step of the file: twice as long at half the diameter, four times at a quarter, at
  // which the guard stops the run.
  const Saved saved(flight({.dust_below = 0.4e-3}));
  for (const double dust : {0.2e-3, 0.1e-3}) {
    const double step = saved.continued(flight({.dust_below = dust}));
    CHECK(step == near(fresh(flight({.dust_below = dust}))).epsilon(1e-12));
    CHECK(step < 0.55 * saved.step);
  }
  CHECK(saved.continued(flight({.dust_below = 0.4e-3}, stiffer())) ==
        near(fresh(flight({.dust_below = 0.4e-3}, stiffer()))).epsilon(1e-12));
}
TEST_CASE("restart with other rules: what is short enough stays, and what the program sets") {
  const Saved saved(flight({.dust_below = 0.4e-3}));
  auto slippery = salt;
  slippery.friction = 0.1;
  CHECK(saved.continued(flight({.dust_below = 0.4e-3})) == saved.step);
  CHECK(saved.continued(flight({.dust_below = 0.4e-3}, slippery)) == saved.step);
  CHECK(saved.continued(flight({.dust_below = 0.8e-3})) == saved.step);
  auto set = flight({.dust_below = 0.3e-3});
  set.time_step = saved.step;
  CHECK(saved.continued(std::move(set)) == saved.step);
}
TEST_CASE("restart with another material: a step that follows the smallest that are there") {
  const silt::BreakageRules rules{.dust_below = 0.4e-3, .step = living};
  const Saved saved(flight(rules));
  CHECK(saved.continued(flight(rules, stiffer())) ==
        near(fresh(flight(rules, stiffer()))).epsilon(1e-12));
  CHECK(saved.continued(flight(rules)) == saved.step);
  // Other rules, with the same grains: no change until smaller ones are born.
  auto sim = flight({.dust_below = 0.2e-3, .step = living});
  saved.load(sim);
  sim.run(1e-6);
  CHECK(sim.step_length() == saved.step);
  sim.break_particle(0);
  sim.run(1e-6);
  CHECK(sim.step_length() < 0.6 * saved.step);
}

}  // namespace breakage_restart_rules_test
