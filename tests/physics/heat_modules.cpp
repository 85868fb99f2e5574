// silt - BSD-3-Clause, see LICENSE
// Modules that add to conduction, against closed forms: who gets the heat of friction, a grain in
// hot gas, one that radiates; that their order does not matter.
#include <cmath>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/heat/fluid_convection.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace heat_modules_test {

using silt_test::has, silt_test::refusal;

const double R = 1e-3, density = 2500;  // [m], [kg/m3]
// So soft that nothing moves while heat flows.
const silt::HertzMindlin::Material still{
    .youngs_modulus = 1e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
// Asked in each step, so that Euler's steps are those of the time step.
const silt::HeatConduction glass{.conductivity = 1.1, .heat_capacity = 840, .flux_every = 1};
const double mass = 4.0 / 3 * 3.14159265358979323846 * R * R * R * density;  // [kg]

inline silt::Particles<silt::Sphere> grain() {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {R, 0, 0}, .radius = R, .density = density});
  return p;
}
template <class Sim>
double temperature(const Sim& sim, std::size_t id) {
  return sim.template field<silt::Temperature>(sim.find(id));
}

// Catches a share that forgets the densities of the solids, or gives it to the wrong end.
TEST_CASE("heat: two unlike grains share what their impact loses by sqrt(k rho c)") {
  const silt::HertzMindlin::Material hard{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0};
  auto other = hard;
  other.youngs_modulus = 2e7;
  const auto ratio = [&](double rho, double rho_other) {  // of the first one's heat
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
    p.add({.position = {2.1e-3, 0, 0}, .radius = 1e-3, .density = 2500, .material = 1});
    silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts({hard, other});
    contacts.set_pair(hard, other, {.restitution = 0.6, .friction = 0});
    silt::Simulation sim{
        std::move(p), contacts,
        silt::FrictionHeat{silt::HeatConduction{
            .conductivity = 1e-6,  // so that no heat flows through the contact
            .heat_capacity = 900,
            .start_temperature = 1,
            .others = {{.conductivity = 4e-6, .heat_capacity = 400, .density = rho_other}},
            .density = rho}},
        silt::EnergyLedger{}};
    sim.run(1e-3);
    const double a = 900 * (sim.field<silt::Temperature>(sim.find(0)) - 1),
                 b = 400 * (sim.field<silt::Temperature>(sim.find(1)) - 1);
    CHECK(a + b > 0);
    return a / (a + b);
  };
  const auto share = [](double a, double b) {
    return std::sqrt(a) / (std::sqrt(a) + std::sqrt(b));
  };
  CHECK(ratio(0, 0) == near(share(900, 1600)).epsilon(1e-6));
  CHECK(ratio(8000, 0) == near(share(900, 1600)).epsilon(1e-6));
  CHECK(ratio(8000, 1000) == near(share(900 * 8000, 1600 * 1000)).epsilon(1e-6));
  CHECK(has(refusal([&] { ratio(-1, 0); }), "HeatConduction.density = -1 [kg/m3]"));
}

TEST_CASE("heat: a grain in hot gas, and one that radiates, as closed forms say") {
  const auto lone = [](const auto& heat) {
    silt::Simulation sim{grain(), silt::Contacts<silt::HertzMindlin>{still}, heat};
    sim.time_step = 1e-2;
    sim.template field<silt::Temperature>(0) = 300;
    sim.run(20);
    return temperature(sim, 0);
  };
  const double C = mass * 840, pi = 3.14159265358979323846;
  // Gas at rest: Nu = 2. Catches h of the radius, an area of pi R^2.
  CHECK(lone(silt::Heat{glass, silt::Convection<>{.temperature = 500}}) ==
        near(500 - 200 * std::exp(-2 * 0.026 * pi * 2 * R * 20 / C)).epsilon(1e-10));
  // 1/T^3 = 1/T_0^3 + 3 sigma e A t/C; Euler's rule errs by half of rate dt.
  const double slope = 3 * 5.670374419e-8 * 0.8 * 4 * pi * R * R / C;
  const double left = std::pow(std::pow(300.0, -3) + slope * 20, -1.0 / 3);
  CHECK(left < 291);
  CHECK(lone(silt::Heat{glass, silt::Radiation{.emissivity = 0.8, .temperature = 0}}) ==
        near(left).epsilon(1e-5));
  CHECK(silt::Gunn::nusselt(0, 0.7, 1) == near(2.0));  // a lone sphere at rest
  CHECK(silt::RanzMarshall::nusselt(100, 1, 1) == near(8.0));
  CHECK(has(refusal([&] {
              lone(silt::Heat{glass, silt::Radiation{.emissivity = 2}});
            }),
            "Radiation.emissivity"));
  CHECK(has(refusal([&] {
              lone(silt::Heat{glass, silt::Convection<>{.voidage = 0}});
            }),
            "Convection.voidage"));
}

static_assert(
    silt::HeatedByFluid<
        silt::Heat<silt::Heat<silt::HeatConduction, silt::FluidConvection<>>, silt::Radiation>>);

// Catches parts that are dropped in one order: FrictionHeat that keeps its conduction alone.
TEST_CASE("heat: friction's heat around and inside the other modules is the same") {
  const silt::Radiation radiates{.emissivity = 0.8, .temperature = 0};
  const auto lone = [](const auto& heat) {
    silt::Simulation sim{grain(), silt::Contacts<silt::HertzMindlin>{still}, silt::EnergyLedger{},
                         heat};
    sim.time_step = 1e-3;
    sim.template field<silt::Temperature>(0) = 1000;
    sim.run(1);
    return temperature(sim, 0);
  };
  // 1/T^3 = 1/T_0^3 + 3 sigma e A t/C; Euler's rule errs by 2 (dT/dt)^2 dt t/T = 8e-6 T.
  const double slope = 3 * 5.670374419e-8 * 0.8 * 3 / (density * R * 840);
  const double left = std::pow(1e-9 + slope, -1.0 / 3);
  CHECK(left < 945);
  CHECK(lone(silt::FrictionHeat{silt::Heat{glass, radiates}}) == near(left).epsilon(1e-5));
  CHECK(lone(silt::Heat{silt::FrictionHeat{glass}, radiates}) == near(left).epsilon(1e-5));
  CHECK(lone(silt::FrictionHeat{silt::MutualRadiation{silt::Heat{glass, radiates}, {1, 4e-3}}}) ==
        near(left).epsilon(1e-5));

  // Two that hit each other, and a third that is hot and near by: conduction, radiation of both
  // kinds and the heat of the impact.
  const silt::HertzMindlin::Material hard{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.2, .friction = 0.3};
  const auto impact = [&](const auto& heat) {
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = R, .density = density, .velocity = {1, 0, 0}});
    p.add({.position = {2.1 * R, 0, 0}, .radius = R, .density = density});
    p.add({.position = {0, 3 * R, 0}, .radius = R, .density = density});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{hard},
                         silt::EnergyLedger{}, heat};
    sim.template field<silt::Temperature>(2) = 1500;
    sim.run(1e-3);
    return std::vector{temperature(sim, 0), temperature(sim, 1), temperature(sim, 2)};
  };
  using silt::FrictionHeat, silt::Heat, silt::MutualRadiation;
  const auto right = impact(MutualRadiation{Heat{FrictionHeat{glass}, radiates}, {1, 4e-3}});
  CHECK(right == impact(FrictionHeat{MutualRadiation{Heat{glass, radiates}, {1, 4e-3}}}));
  CHECK(right == impact(MutualRadiation{FrictionHeat{Heat{glass, radiates}}, {1, 4e-3}}));
  CHECK(right == impact(Heat{FrictionHeat{MutualRadiation{glass, {1, 4e-3}}}, radiates}));
  const auto without = impact(MutualRadiation{Heat{glass, radiates}, {1, 4e-3}});
  // The ledger's loss, half to each: m v^2/4 (1 - e^2) over both.
  CHECK(right[1] - without[1] == near(0.25 * (1 - 0.2 * 0.2) / 2 / 840).epsilon(1e-2));
}

}  // namespace heat_modules_test
