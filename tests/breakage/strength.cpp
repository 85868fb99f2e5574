// silt - BSD-3-Clause, see LICENSE
// Strengths: quantiles and shares are inverses of each other, values by hand.
//   an exponent upside down, strength per mass or per particle mixed up, a rank read from the top
#include <cmath>
#include <limits>
#include <numbers>

#include <doctest/doctest.h>

#include <silt/breakage/strength.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_strength_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), d = 0.8e-3, mass = 6e-7;

template <class Strength>
void check_inverse(const Strength& law) {
  law.check();
  double before = 0;
  for (const double rank : {1e-9, 1e-3, 0.05, 0.3, 0.5, 0.77, 0.99, 1 - 1e-9}) {
    const double strength = law.strength(d, mass, rank);
    CHECK(strength > before);
    CHECK(std::abs(law.weaker(strength, d, mass) - rank) < 1e-13 + 1e-11 * rank * (1 - rank));
    before = strength;
  }
  CHECK(law.weaker(0, d, mass) == 0);
  CHECK(law.weaker(1e6 * before, d, mass) == near(1).epsilon(1e-12));
  CHECK(law.weaker(std::numeric_limits<double>::infinity(), d, mass) == 1);
}

constexpr silt::LogLogisticStrength log_logistic{
    .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};
constexpr silt::WeibullStrength weibull{
    .scale = 31, .at_diameter = 2e-3, .exponent = 1.6, .modulus = 3};
constexpr silt::LogNormalStrength log_normal{
    .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .deviation = 0.5};
// Copper ore, recalled; the stiffness ratio and the cut are synthetic.
constexpr silt::TavaresStrength tavares{.infinite = 213.5,
                                        .at_diameter = 8.07e-3,
                                        .exponent = 1.22,
                                        .deviation = 0.799,
                                        .contact_stiffness_ratio = 0.25,
                                        .largest_ratio = 4};
// Limestone, recalled.
constexpr silt::VogelPeukertStrength vogel_peukert{.f_mat = 0.944, .least = 0.0933};

TEST_CASE("strengths: quantile and share are inverses, to 1e-11 of both tails") {
  check_inverse(log_logistic);
  check_inverse(weibull);
  check_inverse(log_normal);
  check_inverse(tavares);
  auto uncut = tavares;
  uncut.largest_ratio = std::numeric_limits<double>::infinity();
  check_inverse(uncut);
  check_inverse(vogel_peukert);
}

TEST_CASE("strengths of synthetic material S: medians in N and in MPa; spread and modulus") {
  const double sizes[] = {2e-3, 0.5e-3, 0.1e-3, 0.02e-3}, mpa[] = {9.9, 17.2, 32.7, 62.3};
  for (int k = 0; k < 4; ++k) {
    const double size = sizes[k], F = log_logistic.strength(size, mass, 0.5);
    CHECK(std::abs(4 * F / (std::numbers::pi * size * size) / 1e6 - mpa[k]) < 0.051);
    CHECK(log_normal.strength(size, mass, 0.5) == near(F).epsilon(1e-14));
    CHECK(weibull.weaker(F, size, mass) == near(1 - std::exp(-1)).epsilon(1e-14));
  }
  CHECK(log_logistic.weaker(62, 2e-3, mass) == near(8.0 / 9).epsilon(1e-14));
  CHECK(weibull.weaker(62, 2e-3, mass) == near(1 - std::exp(-8)).epsilon(1e-14));
  CHECK(log_normal.weaker(31 * std::exp(0.5), 2e-3, mass) ==
        near(0.8413447460685429).epsilon(1e-12));
}

TEST_CASE("TavaresStrength: median energy, its cut, energies in proportion to the mass") {
  // At d0 the size's factor is 2.
  CHECK(tavares.specific_median(8.07e-3) == near(213.5 / 1.25 * 2).epsilon(1e-14));
  CHECK(tavares.specific_median(0.807e-3) ==
        near(213.5 / 1.25 * (1 + std::pow(10, 1.22))).epsilon(1e-14));
  const double E50 = mass * tavares.specific_median(d);
  CHECK(tavares.strength(d, mass, 0.5) == near(0.8 * E50).epsilon(1e-14));  // 1/(1 + 1/4)
  CHECK(tavares.strength(d, mass, 1 - 1e-15) < 4 * E50);
  CHECK(tavares.weaker(4 * E50, d, mass) == 1);
  CHECK(tavares.weaker(3.9 * E50, d, mass) < 1);
  CHECK(tavares.strength(d, 2 * mass, 0.3) ==
        near(2 * tavares.strength(d, mass, 0.3)).epsilon(1e-14));
}

TEST_CASE("VogelPeukertStrength: limestone of 5 mm at 10, 20, 50 m/s, to the digits known") {
  const double speeds[] = {10, 20, 50}, share[] = {0.138, 0.575, 0.997};
  for (int k = 0; k < 3; ++k)
    CHECK(std::abs(vogel_peukert.weaker(0.5 * mass * speeds[k] * speeds[k], 5e-3, mass) -
                   share[k]) < 6e-4);
  // None breaks below W_min = 18.7 J/kg.
  CHECK(vogel_peukert.weaker(18.6 * mass, 5e-3, mass) == 0);
  CHECK(vogel_peukert.strength(5e-3, mass, 1e-12) == near(0.0933 / 5e-3 * mass).epsilon(1e-9));
}

TEST_CASE("strengths: refusals name field, value and unit") {
  using silt_test::has, silt_test::refusal;
  const auto says = [](const auto& law, const char* words) {
    has(refusal([&] { law.check(); }), words);
  };
  says(silt::LogLogisticStrength{0, 1, 1, 1}, "LogLogisticStrength.median = 0 [N or J]");
  says(silt::LogLogisticStrength{1, nan, 1, 1}, "LogLogisticStrength.at_diameter = nan [m]");
  says(silt::LogLogisticStrength{1, 1, nan, 1}, "LogLogisticStrength.exponent = nan [-]");
  says(silt::LogLogisticStrength{1, 1, 1, -1}, "LogLogisticStrength.spread = -1 [-]");
  says(silt::WeibullStrength{-1, 1, 1, 1}, "WeibullStrength.scale = -1 [N or J]");
  says(silt::WeibullStrength{1, 0, 1, 1}, "WeibullStrength.at_diameter = 0 [m]");
  says(silt::WeibullStrength{1, 1, nan, 1}, "WeibullStrength.exponent = nan [-]");
  says(silt::WeibullStrength{1, 1, 1, 0}, "WeibullStrength.modulus = 0 [-]");
  says(silt::LogNormalStrength{0, 1, 1, 1}, "LogNormalStrength.median = 0 [N or J]");
  says(silt::LogNormalStrength{1, -1, 1, 1}, "LogNormalStrength.at_diameter = -1 [m]");
  says(silt::LogNormalStrength{1, 1, nan, 1}, "LogNormalStrength.exponent = nan [-]");
  says(silt::LogNormalStrength{1, 1, 1, 0}, "LogNormalStrength.deviation = 0 [-]");
  says(silt::TavaresStrength{0, 1, 1, 1, 0}, "TavaresStrength.infinite = 0 [J/kg]");
  says(silt::TavaresStrength{1, 0, 1, 1, 0}, "TavaresStrength.at_diameter = 0 [m]");
  says(silt::TavaresStrength{1, 1, -1, 1, 0}, "TavaresStrength.exponent = -1 [-]");
  says(silt::TavaresStrength{1, 1, 1, 0, 0}, "TavaresStrength.deviation = 0 [-]");
  says(silt::TavaresStrength{1, 1, 1, 1, -1}, "TavaresStrength.contact_stiffness_ratio = -1 [-]");
  says(silt::TavaresStrength{1, 1, 1, 1, 0, 0}, "TavaresStrength.largest_ratio = 0 [-]");
  says(silt::TavaresStrength{1, 1, 1, 1, 0, nan}, "TavaresStrength.largest_ratio = nan [-]");
  says(silt::VogelPeukertStrength{0, 1}, "VogelPeukertStrength.f_mat = 0 [kg/(J m)]");
  says(silt::VogelPeukertStrength{1, -1}, "VogelPeukertStrength.least = -1 [J m/kg]");
}

}  // namespace breakage_strength_test
