// silt - BSD-3-Clause, see LICENSE
// Rules and functions that cannot be: a sentence before the run begins, and nothing has changed.
#include <cmath>

#include <doctest/doctest.h>

#include <silt/breakage/t10_sizes.hpp>
#include <silt/contact/jkr.hpp>

#include "breakage/scene.hpp"
#include "refusal.hpp"

namespace breakage_refusals_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

silt::Particles<silt::Sphere> grain() {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2165, .velocity = {0, 0, -1}});
  return one;
}
std::string refused(const Policy& of) {
  return refusal([&] {
    auto sim = simulation(grain(), of);
    sim.gravity = {0, 0, -9.81};
    sim.run(1e-6);
  });
}

TEST_CASE("breakage: rules that cannot be") {
  has(refused(policy({.dust_below = 0})), "BreakageRules.dust_below = 0 [m] must be");
  has(refused(policy({.dust_below = NAN})), "BreakageRules.dust_below = nan [m] must be");
  has(refused(policy({.dust_below = 2.5e-3})),
      "BreakageRules.dust_below = 0.0025 [m] is not below the diameter of the largest particle, "
      "0.002 m: whatever broke would be dust; lower it");
  has(refused(policy({.dust_below = 1e-4, .most_fragments = 0})),
      "BreakageRules.most_fragments = 0 [-] must be at least 1");
  has(refused(policy({.dust_below = 1e-4, .separation_speed = -1})),
      "BreakageRules.separation_speed = -1 [m/s] must");
  has(refused(policy({.dust_below = 1e-4, .materials = {3}})),
      "BreakageRules.materials names material 3, but the contacts have 1");
}

TEST_CASE("breakage: functions that cannot be") {
  has(refused(policy({.dust_below = 1e-4},
                     {.median = 0, .at_diameter = 1, .exponent = 1, .spread = 3})),
      "LogLogisticStrength.median = 0");
  auto creates = policy({.dust_below = 1e-4});
  creates.sizes.coarsest = 1.2;
  has(refused(creates), "GaudinSchuhmann.coarsest = 1.2");
  auto tired = policy({.dust_below = 1e-4});
  tired.fatigue.kappa = 2;
  has(refused(tired), "PowerFatigue.kappa = 2");
}

// Catches loads in J taken for forces: t10 was 0.556 in place of 0.261.
TEST_CASE("breakage: a function with a unit of its own has that of the loads") {
  const auto sim = simulation(grain());
  const auto checked = [&](auto equivalence, const auto& sizes, const auto& fatigue) {
    return refusal([&] {
      silt::Breakage(strong, equivalence, sizes, fatigue, {.dust_below = 1e-4}).check(sim);
    });
  };
  const silt::T10Sizes left_out{.limit = 0.6, .rate = 0.05, .unit = {}},
      of_energies{.limit = 0.6, .rate = 0.05, .unit = silt::LoadUnit::Energy};
  const silt::TavaresFatigue tired{.gamma = 5, .unit = {}};
  has(checked(silt::EnergyEquivalence{}, left_out, silt::NoFatigue{}),
      "Breakage: the breakage function has .unit = LoadUnit::Force, which is Force if left out, "
      "but "
      "loads are of LoadUnit::Energy by the equivalence: set .unit = silt::LoadUnit::Energy");
  has(checked(silt::HertzEquivalence{}, of_energies, silt::NoFatigue{}),
      "the breakage function has .unit = LoadUnit::Energy");
  has(checked(silt::EnergyEquivalence{}, of_energies, tired),
      "the fatigue has .unit = LoadUnit::Force");
  has(checked(silt::EnergyEquivalence{}, of_energies, silt::NoFatigue{}), "nothing was refused");
  has(checked(silt::HertzEquivalence{}, left_out, tired), "nothing was refused");
}

/// More mass below than there is.
struct Creates {
  double finer(double x, const silt::Broken& b) const { return 1.5 * x / b.diameter; }
  double largest(const silt::Broken& b) const { return b.diameter; }
  void check() const {}
};

TEST_CASE("breakage: a function of one's own that creates mass, loads that nobody can tell") {
  {
    silt::Simulation sim{
        grain(), silt::Contacts<silt::HertzMindlin>{salt},
        silt::Breakage{strong, silt::HertzEquivalence{}, Creates{}, {.dust_below = 1e-4}}};
    sim.gravity = {0, 0, -9.81};
    has(refusal([&] { sim.run(1e-6); }), "finer(");
  }
  const silt::Jkr::Material sticky{
      .youngs_modulus = 1e8, .poisson_ratio = 0.3, .work_of_adhesion = 0.01};
  silt::Simulation sim{
      grain(), silt::Contacts<silt::Jkr>{sticky},
      silt::Breakage{
          strong, silt::HertzEquivalence{}, silt::GaudinSchuhmann{1, 0.8}, {.dust_below = 1e-4}}};
  sim.gravity = {0, 0, -9.81};
  has(refusal([&] { sim.run(1e-6); }),
      "HertzEquivalence: Impact.elastic_force = nan [N]: the contact law has no closed form for "
      "it; "
      "use PowerEquivalence, EnergyEquivalence or ForceEquivalence");
}

/// A load that is no number, a fatigue that makes stronger.
struct Lost {
  static constexpr silt::LoadUnit unit = silt::LoadUnit::Force;
  double load(const silt::Impact& impact) const { return impact.speed > 0.9 ? NAN : 0; }
  void check() const {}
};
struct Hardens {
  double weakened(double strength, double) const { return 2 * strength; }
  void check() const {}
};

TEST_CASE("breakage: functions of one's own that go wrong stop the run, with the particle") {
  const auto stopped = [](auto of) {
    silt::Simulation sim{grain(), silt::Contacts<silt::HertzMindlin>{salt}, std::move(of)};
    sim.add_wall(silt::Plane{{0, 0, -1.1e-3}, {0, 0, 1}}, salt);
    return refusal([&] { sim.run(1e-3); });
  };
  const silt::BreakageRules rules{.dust_below = 1e-4};
  const silt::GaudinSchuhmann sizes{1, 0.8};
  has(stopped(silt::Breakage{strong, Lost{}, sizes, rules}),
      "the equivalence's load() gives nan for particle 0 of diameter 0.00");
  has(stopped(silt::Breakage{strong, silt::HertzEquivalence{}, sizes, Hardens{}, rules}),
      "the fatigue's weakened() gives ");
}

}  // namespace breakage_refusals_test
