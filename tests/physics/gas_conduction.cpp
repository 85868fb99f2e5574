// silt - BSD-3-Clause, see LICENSE
// Heat through the gas in gaps against its integral and closed forms: two spheres that come
// together in temperature, a lattice between held ends, a plane; with radiation; refusals.
#include <cmath>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/heat/gas_conduction.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace gas_conduction_test {

using silt::GapGas;
using silt_test::has, silt_test::refusal;

constexpr double R = 1e-3, density = 2500, c = 840, pi = std::numbers::pi;
const double mass = 4.0 / 3 * pi * R * R * R * density;  // [kg]
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.3};
const silt::HeatConduction poor{.conductivity = 1e-9, .heat_capacity = c, .flux_every = 1};
const GapGas air{.conductivity = 0.026, .roughness = 1e-6, .gap = 0.2e-3};

/// Nothing moves.
template <class Module>
auto row(std::size_t count, double apart, const Module& module, double density_of_ends = density) {
  silt::Particles<silt::Sphere> p;
  for (std::size_t k = 0; k < count; ++k)
    p.add({.position = {static_cast<double>(k) * apart, 0, 0},
           .radius = R,
           .density = k == 0 || k + 1 == count ? density_of_ends : density});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass}, module};
  sim.time_step = 1e-3;
  return sim;
}
template <class Sim>
double& T(Sim& sim, std::size_t k) {
  return sim.template field<silt::Temperature>(sim.find(k));
}
/// 2 pi r k/max(l, h) over the circle in which l < L, l the gap between equal spheres [W/K].
double integral(const GapGas& gas, double s) {
  const double z = R + 0.5 * (s - gas.gap), edge = std::sqrt(R * R - z * z);
  const int n = 400000;
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double r = edge * (k + 0.5) / n, l = 2 * R + s - 2 * std::sqrt(R * R - r * r);
    sum += 2 * pi * r * gas.conductivity / std::max(l, gas.roughness) * edge / n;
  }
  return sum;
}

// Catches a diameter for a radius, a logarithm to base 10, and a jump at the roughness.
TEST_CASE(
    "gas in gaps: the conductance is that of the integral over the gap, to the parabola's error") {
  for (const double L : {0.1e-3, 0.2e-3, 0.4e-3})
    for (const double s : {0.0, 0.3e-6, 1e-6, 1e-5, 0.5e-4}) {
      CAPTURE(L);
      CAPTURE(s);
      const GapGas gas{.conductivity = 0.026, .roughness = 1e-6, .gap = L};
      const double over = gas.conductance(R / 2, s) / integral(gas, s);
      CHECK(over > 1);  // the parabola is wider than the sphere
      CHECK(over < 1.07);
      if (s == 0) CHECK(over < 1.03);
    }
  CHECK(air.conductance(R, -1e-5) == air.conductance(R, 0));
  CHECK(air.conductance(R, 0.2e-3) == 0);
  CHECK(air.conductance(R, 1.0000001e-6) == near(air.conductance(R, 0.9999999e-6)).epsilon(1e-6));
}

// Catches heat that one of the two gets alone, and a gap between centres.
TEST_CASE("gas in gaps: two spheres that do not touch come together exponentially") {
  const double s = 2e-5;
  auto sim = row(2, 2 * R + s, silt::GasConduction{poor, air});
  T(sim, 0) = 310, T(sim, 1) = 300;
  sim.run(40);
  const double rate = 2 * 2 * pi * 0.026 * 0.5 * R * std::log(10) / (mass * c);
  CHECK(T(sim, 0) - T(sim, 1) ==
        near(10 * std::exp(-rate * 40)).epsilon(1e-6 + rate * rate * 1e-3 * 40 / 2 * 1.01));
  CHECK(rate * 40 > 0.5);
  CHECK(T(sim, 0) + T(sim, 1) == near(610).epsilon(1e-13));
  auto apart = row(2, 2.201 * R, silt::GasConduction{poor, air});
  T(apart, 0) = 310;
  apart.run(1);
  CHECK(T(apart, 0) == 310);
}

TEST_CASE("gas in gaps: beside contacts and radiation, each within its own reach") {
  // Ends so heavy that they stay; the middle one comes to the mean, at the sum of all rates.
  const double s = 1e-5, emissivity = 1;
  const silt::MutualRadiation radiates{poor, {.emissivity = emissivity, .gap = R}};
  const auto cooled = [&](const auto& module, double apart) {
    auto sim = row(3, apart, module, 2.5e12);
    T(sim, 0) = T(sim, 2) = 600, T(sim, 1) = 601;
    sim.run(5);
    return -std::log(T(sim, 1) - 600) / 5;  // [1/s]
  };
  const double near_by = 2 * R + s, far = 2 * R + 0.5e-3;
  const double by_gas = cooled(silt::GasConduction{poor, air}, near_by);
  CHECK(by_gas == near(2 * air.conductance(R / 2, s) / (mass * c)).epsilon(1e-3));
  const double by_both = cooled(silt::GasConduction{radiates, air}, near_by);
  CHECK(by_both == near(by_gas + cooled(radiates, near_by)).epsilon(1e-4));
  CHECK(cooled(silt::GasConduction{radiates, air}, far) == cooled(radiates, far));
  // The gas reaches farther than the radiation.
  const silt::MutualRadiation close{poor, {.emissivity = emissivity, .gap = 1e-6}};
  CHECK(cooled(silt::GasConduction{close, air}, near_by) == near(by_gas).epsilon(1e-12));
}

TEST_CASE("gas in gaps: a sphere at a plane") {
  silt::PlaneGasConduction plate{.point = {0, 0, -R - 1e-5}, .temperature = 400, .gas = air};
  auto sim = row(1, R, silt::Heat{poor, plate});
  T(sim, 0) = 300;
  sim.run(10);
  const double rate = 2 * pi * 0.026 * R * std::log(20) / (mass * c);
  CHECK(T(sim, 0) == near(400 - 100 * std::exp(-rate * 10)).epsilon(1e-4));
  CHECK(T(sim, 0) > 310);
}

TEST_CASE("gas in gaps: refusals") {
  const auto of = [](const GapGas& gas) {
    return refusal([&] { row(2, 3 * R, silt::GasConduction{poor, gas}).run(0); });
  };
  CHECK(
      has(of({.conductivity = 0, .roughness = 1e-6, .gap = R}), "GasConduction.conductivity = 0"));
  CHECK(has(of({.roughness = 0, .gap = R}), "GasConduction.roughness = 0 [m]"));
  CHECK(has(of({.roughness = 1e-6, .gap = 1e-6}), "GasConduction.gap = 1e-06 [m]"));
  const auto plane = [](const silt::PlaneGasConduction& p) {
    return refusal([&] { row(1, R, silt::Heat{poor, p}).run(0); });
  };
  CHECK(has(plane({.gas = {.roughness = -1, .gap = R}}), "PlaneGasConduction.gas.roughness = -1"));
  CHECK(has(plane({.normal = {0, 0, 0}, .gas = air}), "PlaneGasConduction: its point"));
  CHECK(has(plane({.temperature = -1, .gas = air}), "PlaneGasConduction.temperature = -1 [K]"));
}

}  // namespace gas_conduction_test
