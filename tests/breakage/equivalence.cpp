// silt - BSD-3-Clause, see LICENSE
// Loads of impacts.
//   a damped force in place of the elastic one, r where r^(3/2) belongs, the wrong end of contact
#include <cmath>
#include <limits>
#include <numbers>

#include <doctest/doctest.h>

#include <silt/breakage/equivalence.hpp>
#include <silt/contact/impact.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace breakage_equivalence_test {

using silt::DampingEnd;
using silt::Impact;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A sphere of density 2500 on a wall.
silt::HertzImpact on_wall(double diameter, double speed) {
  return {.E_eff = 1e10,
          .R_eff = diameter / 2,
          .m_eff = 2500 * std::numbers::pi / 6 * diameter * diameter * diameter,
          .speed = speed};
}
Impact impact(double diameter, double speed, double restitution = 0.6) {
  auto hertz = on_wall(diameter, speed);
  hertz.zeta = silt::damping_ratio(restitution, DampingEnd::ZeroOverlap);
  return {diameter,    hertz.m_eff, speed,
          hertz.m_eff, hertz.R_eff, silt::hertz_max_elastic_force(hertz),
          nan,         true};
}

TEST_CASE(
    "HertzEquivalence: the elastic force of a damped impact, by the table of overlap ratios") {
  const double table[][2] = {{1, 1},       {.95, .97990}, {.9, .95959}, {.8, .91830},
                             {.7, .87599}, {.6, .83247},  {.5, .78747}, {.4, .74060},
                             {.3, .69116}, {.2, .63779},  {.1, .57685}, {.05, .53941}};
  const silt::HertzEquivalence hertz;
  const double undamped = hertz.load(impact(1e-3, 20, 1));
  for (const auto& [e, r] : table)
    CHECK(std::abs(std::pow(hertz.load(impact(1e-3, 20, e)) / undamped, 2.0 / 3) - r) < 6e-6);
}

TEST_CASE("PowerEquivalence: with its own exponents it is Hertz' force of one pair, to 1e-12") {
  const silt::HertzEquivalence hertz;
  const double C = hertz.load(impact(1e-3, 1, 0.6)) / 1e-6;
  const silt::PowerEquivalence power{.coefficient = C};
  power.check();
  for (const double d : {2e-5, 1e-3, 5e-3})
    for (const double v : {0.1, 7.0, 150.0})
      CHECK(power.load(impact(d, v, 0.6)) == near(hertz.load(impact(d, v, 0.6))).epsilon(1e-12));
  const silt::PowerEquivalence own{.coefficient = 3, .speed_exponent = 2, .size_exponent = -1};
  CHECK(own.load(impact(0.5, 4, 0.6)) == near(96).epsilon(1e-14));
  auto still = impact(0.5, 4, 0.6);
  still.speed = 0;
  CHECK(own.load(still) == 0);
}

TEST_CASE("EnergyEquivalence, ForceEquivalence: m* v^2/2; the contact's force as it is") {
  auto pair = impact(1e-3, 20, 0.6);
  pair.m_eff = pair.mass / 2;
  CHECK(silt::EnergyEquivalence{}.load(pair) == near(pair.mass * 100).epsilon(1e-14));
  pair.contact_force = 12.5;
  CHECK(silt::ForceEquivalence{}.load(pair) == 12.5);
  silt::EnergyEquivalence{}.check(), silt::ForceEquivalence{}.check();
  silt::HertzEquivalence{}.check();
}

TEST_CASE("equivalences: refusals name field, value and unit") {
  using silt_test::has, silt_test::refusal;
  auto unknown = impact(1e-3, 20, 0.6);
  unknown.elastic_force = nan;
  const auto load = [](const auto& law, const Impact& i) { return refusal([&] { law.load(i); }); };
  has(load(silt::HertzEquivalence{}, unknown), "Impact.elastic_force = nan [N]");
  has(load(silt::ForceEquivalence{}, impact(1e-3, 20, 0.6)), "Impact.contact_force = nan [N]");
  const auto power = [](double C, double p, double q) {
    return refusal([&] { silt::PowerEquivalence{C, p, q}.check(); });
  };
  has(power(0, 1.2, 2), "PowerEquivalence.coefficient = 0 [N (s/m)^p m^-q]");
  has(power(1, -1, 2), "PowerEquivalence.speed_exponent = -1 [-]");
  has(power(1, 1.2, nan), "PowerEquivalence.size_exponent = nan [-] must be finite");
}

}  // namespace breakage_equivalence_test
