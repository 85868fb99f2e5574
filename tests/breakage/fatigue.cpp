// silt - BSD-3-Clause, see LICENSE
// Strength after loads below it.
//   a factor (1 - D) too many in the damage, energies taken for forces, an iteration that stops
//   early
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <silt/breakage/fatigue.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_fatigue_test {

using silt::LoadUnit;

TEST_CASE("TavaresFatigue: damage of the table to its digits, 0 and 1 at the ends") {
  const silt::TavaresFatigue law{.gamma = 5, .unit = LoadUnit::Energy};
  law.check();
  const double table[][2] = {{.1, .0045}, {.3, .0411}, {.5, .1206}, {.7, .2613}, {.9, .5319}};
  for (const auto& [ratio, D] : table) CHECK(std::abs(law.damage(ratio) - D) < 6e-5);
  CHECK(law.damage(0) == 0);
  CHECK(std::abs(law.damage(1) - 1) < 1e-7);
}

TEST_CASE("TavaresFatigue: the root of its equation for gammas of 0.5 to 50, to 1e-13") {
  for (const double g : {0.5, 1.0, 2.5, 5.0, 12.0, 50.0}) {
    const silt::TavaresFatigue law{.gamma = g, .unit = LoadUnit::Energy};
    double before = 0;
    for (const double ratio : {0.01, 0.2, 0.6, 0.95, 0.999}) {
      const double D = law.damage(ratio);
      const double back = std::pow(D, 2.5 / g) * (2 * g - 5 * D + 5) / (2 * g);
      CHECK(back == near(ratio).epsilon(1e-13));
      CHECK(D > before);
      CHECK(D < 1);
      before = D;
    }
  }
}

TEST_CASE("TavaresFatigue: of forces, the energies' law by E ~ F^(5/3), to 1e-12") {
  const silt::TavaresFatigue force{.gamma = 5, .unit = LoadUnit::Force},
      energy{.gamma = 5, .unit = LoadUnit::Energy};
  for (const double ratio : {0.05, 0.4, 0.8, 0.99}) {
    const double by_energy = energy.weakened(1, std::pow(ratio, 5.0 / 3.0));
    CHECK(force.weakened(30, 30 * ratio) == near(30 * std::pow(by_energy, 0.6)).epsilon(1e-12));
  }
}

TEST_CASE("PowerFatigue, NoFatigue: by hand; how many equal loads it takes to break") {
  const silt::PowerFatigue law{.kappa = 0.2, .psi = 2};
  law.check();
  CHECK(law.weakened(10, 5) == near(9.5).epsilon(1e-14));
  CHECK(law.weakened(10, 0) == 10);
  CHECK(silt::NoFatigue{}.weakened(10, 9.9) == 10);
  silt::NoFatigue{}.check();
  // 10, 9.5, 8.974, 8.416, 7.822, 7.183, 6.487, 5.716, 4.841 < 5: the 8th load leaves less than 5.
  double strength = 10;
  int loads = 0;
  while (strength > 5) strength = law.weakened(strength, 5), ++loads;
  CHECK(loads == 8);
}

TEST_CASE("fatigue: refusals name field, value and unit") {
  using silt_test::has, silt_test::refusal;
  has(refusal([] {
        silt::PowerFatigue{1, 2}.check();
      }),
      "PowerFatigue.kappa = 1 [-] must be in [0, 1)");
  has(refusal([] { silt::PowerFatigue{-0.1, 2}.check(); }), "PowerFatigue.kappa = -0.1 [-]");
  has(refusal([] { silt::PowerFatigue{0.1, 0}.check(); }), "PowerFatigue.psi = 0 [-]");
  has(refusal([] {
        silt::TavaresFatigue{0, LoadUnit::Force}.check();
      }),
      "TavaresFatigue.gamma = 0 [-]");
}

}  // namespace breakage_fatigue_test
