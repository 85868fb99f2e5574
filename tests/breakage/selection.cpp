// silt - BSD-3-Clause, see LICENSE
// The share of particles that an impact breaks.
//   a load of the wrong contact (pair, wall), a strength in another unit, ranks that are not
//   uniform
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include <silt/breakage/equivalence.hpp>
#include <silt/breakage/selection.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/contact/impact.hpp>
#include <silt/core/random.hpp>

#include "near.hpp"

namespace breakage_selection_test {

/// Spheres of the synthetic material S against a steel wall, or against their equals.
silt::Impact of_S(double d, double speed, bool at_wall) {
  const double mass = 2165 * std::numbers::pi / 6 * d * d * d;
  const silt::HertzImpact hertz{.E_eff = at_wall ? silt::effective_modulus(20e9, 0.25, 210e9, 0.3)
                                                 : silt::effective_modulus(20e9, 0.25, 20e9, 0.25),
                                .R_eff = at_wall ? d / 2 : d / 4,
                                .m_eff = at_wall ? mass : mass / 2,
                                .speed = speed};
  return {d,   mass,   speed, hertz.m_eff, hertz.R_eff, silt::hertz_max_elastic_force(hertz),
          0.0, at_wall};
}
constexpr silt::LogLogisticStrength S{
    .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};

TEST_CASE("selection: median speeds of synthetic material S, to the digits of the table") {
  const double sizes[] = {2e-3, 0.5e-3, 0.1e-3, 0.02e-3}, wall[] = {5.54, 8.80, 15.0, 25.7},
               pair[] = {10.8, 17.1, 29.2, 50.0}, digit[] = {0.005, 0.005, 0.05, 0.05};
  const auto median = [](double d, bool at_wall) {
    double slow = 1, fast = 100;
    for (int halving = 0; halving < 60; ++halving) {
      const double v = 0.5 * (slow + fast);
      (silt::selection(S, silt::HertzEquivalence{}, of_S(d, v, at_wall)) < 0.5 ? slow : fast) = v;
    }
    return slow;
  };
  for (int k = 0; k < 4; ++k) {
    CHECK(std::abs(median(sizes[k], true) - wall[k]) < digit[k]);
    CHECK(std::abs(median(sizes[k], false) - pair[k]) < 0.05);
  }
}

TEST_CASE("selection: log-logistic in the speed, with the closed form's v50 and slope, to 1e-12") {
  const double C = 4e6;  // [N (s/m)^1.2 m^-2] synthetic
  const silt::PowerEquivalence power{.coefficient = C};
  for (const double d : {2e-5, 2e-3}) {
    const double F50 = 31 * std::pow(d / 2e-3, 1.6), v50 = std::pow(F50 / (C * d * d), 1 / 1.2);
    for (const double v : {0.2 * v50, v50, 3 * v50})
      CHECK(silt::selection(S, power, of_S(d, v, true)) ==
            near(1 - 1 / (1 + std::pow(v / v50, 1.2 * 3))).epsilon(1e-12));
  }
}

TEST_CASE("selection: the share of drawn ranks that break, within 3 sigma of 100 000") {
  const int n = 100000;
  const auto drawn = [](const auto& law, const auto& equivalence, const silt::Impact& impact) {
    silt::Random random(5);
    int broken = 0;
    for (int k = 0; k < n; ++k)
      broken += equivalence.load(impact) >=
                law.strength(impact.diameter, impact.mass, random.open_uniform());
    const double p = silt::selection(law, equivalence, impact);
    CHECK(std::abs(broken - n * p) < 3 * std::sqrt(n * p * (1 - p)));
    CHECK(p > 0.05);
    CHECK(p < 0.95);
  };
  drawn(S, silt::HertzEquivalence{}, of_S(0.5e-3, 8, true));
  drawn(silt::WeibullStrength{31, 2e-3, 1.6, 3}, silt::HertzEquivalence{}, of_S(0.5e-3, 8, true));
  drawn(silt::LogNormalStrength{31, 2e-3, 1.6, 0.4}, silt::HertzEquivalence{},
        of_S(0.5e-3, 15, false));
  drawn(silt::TavaresStrength{213.5, 8.07e-3, 1.22, 0.799, 0.25, 4}, silt::EnergyEquivalence{},
        of_S(2e-3, 40, true));
  drawn(silt::VogelPeukertStrength{0.944, 0.0933}, silt::EnergyEquivalence{}, of_S(5e-3, 20, true));
}

}  // namespace breakage_selection_test
