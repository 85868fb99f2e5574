// silt - BSD-3-Clause, see LICENSE
// What is said at the end of a run in which nothing came near to breaking, or all burst.
//   grains that were asked to break are counted; one sentence a run, with other counts each
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/io/break_warnings.hpp>
#include <silt/io/progress.hpp>

#include "breakage/scene.hpp"
#include "refusal.hpp"

namespace breakage_warnings_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has;

silt::LogLogisticStrength of_median(double median) {
  return {.median = median, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};
}
/// The warnings after 120 grains have hit the corner, on_warnings() told the same.
template <class S>
std::vector<std::string> warned(S sim) {
  sim.time_step = 1.5e-7;
  std::vector<std::string> told;
  sim.run(6e-4, silt::on_warnings([&](const std::string& w) { told.push_back(w); }));
  CHECK(silt::break_warnings(sim) == told);
  return told;
}

TEST_CASE("break_warnings: strengths in other units, at the end of a run") {
  const silt::BreakageRules rules{.dust_below = 0.3e-3};
  const auto said = warned(shower(120, policy(rules, of_median(8000))));  // in mN
  CHECK(said.size() == 1);
  has(said.at(0), "Breakage: nothing broke, and of ");
  has(said.at(0), " loads the largest was 0.0");
  has(said.at(0), "strengths are in N (1 mN is 0.001 N)");
  has(said.at(0), "youngs_modulus in Pa");
  has(said.at(0), " m/s; ");
  // Grains that break, that come near it, and that hit each other a few times alone.
  CHECK(warned(shower(120, policy(rules))).empty());
  CHECK(warned(shower(120, policy(rules, of_median(80)))).empty());
  CHECK(warned(shower(4, policy(rules, of_median(8000)))).empty());
}

TEST_CASE("break_warnings: energies, and forces of contacts") {
  const auto with = [](auto equivalence, double median) {
    silt::Particles<silt::Sphere> grains;
    for (int k = 0; k < 20; ++k)
      grains.add({.position = {3e-3 * k, 0, 1.001e-3},
                  .radius = 1e-3,
                  .density = 2165,
                  .velocity = {0, 0, -2}});
    silt::Simulation sim{
        std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
        silt::Breakage{
            of_median(median), equivalence, silt::GaudinSchuhmann{1, 0.8}, {.dust_below = 0.3e-3}}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
    return warned(std::move(sim));
  };
  // 1.8e-5 J and some 5 N.
  has(with(silt::EnergyEquivalence{}, 1).at(0), "strengths are in J (1 mJ is 0.001 J)");
  CHECK(with(silt::EnergyEquivalence{}, 6e-5).empty());
  has(with(silt::ForceEquivalence{}, 1e4).at(0), "strengths are in N");
  CHECK(with(silt::ForceEquivalence{}, 20).empty());
}

TEST_CASE("break_warnings: most that break do so under loads far above their strengths") {
  const silt::BreakageRules rules{.dust_below = 0.3e-3};
  auto in_mm = strong;
  in_mm.at_diameter = 2;
  std::vector<std::string> told;
  auto hear = silt::on_warnings([&](const std::string& w) { told.push_back(w); });
  auto sim = shower(40, policy(rules, in_mm));
  sim.time_step = 1.5e-7, sim.guard.max_overlap = 0.9;
  for (int again = 0; again < 3; ++again) sim.run(2e-4, hear);
  REQUIRE(told.size() == 1);
  has(told[0], "Breakage: most grains that broke did so under more than 100 times their strength");
  has(told[0], "strengths are in N");
  has(told[0], "at_diameter too: 2 mm is 0.002 m");
  // Strengths of a twentieth, and grains that are asked to break.
  CHECK(warned(shower(40, policy({.dust_below = 1e-3}, of_median(0.4)))).empty());
  silt::BrokenLoads broken;
  const std::vector<silt::BreakEvent> asked(
      20, {.strength = 1, .load = 1000, .cause = silt::BreakCause::Asked});
  broken.add(asked);
  CHECK_FALSE(broken.is_odd());
  std::vector<silt::BreakEvent> hit(10, {.strength = 1, .load = 1000});
  for (std::size_t k = 0; k < 5; ++k) hit[k].load = 99;
  broken.add(hit);
  CHECK_FALSE(broken.is_odd());
  broken.add({hit.back()});
  CHECK(broken.is_odd());
}

}  // namespace breakage_warnings_test
