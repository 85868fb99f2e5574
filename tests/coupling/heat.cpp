// silt - BSD-3-Clause, see LICENSE
// Heat between particles and the fluid of a CoupledFlow, against closed forms: a grain in a stream,
// a closed box, stiff exchange, a bed in hot gas (Schumann).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/random.hpp>
#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/lone_sphere.hpp>
#include <silt/module/heat/fluid_convection.hpp>

#include "near.hpp"

namespace coupling_heat_test {

using silt::CoupledFlow;
using silt::CoupledParticles;
using silt::FlowSolver;
using silt::Grid;
using silt::HeatedFluid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;
const silt::FluidProperties air{1.2, 1.8e-5};
const silt::FluidHeat heat_of_air{.heat_capacity = 1005, .conductivity = 0.026};

/// Fixed grains, with temperatures.
struct Grains {
  std::vector<Vec3d> position, velocity, force;
  std::vector<double> radius, volume, mass, temperature, capacity;
  silt::ParticleHeat heat;

  void add(const Vec3d& x, double d, double T, double density, double c) {
    const double V = pi / 6 * d * d * d;
    position.push_back(x), velocity.push_back({0, 0, 0}), force.push_back({0, 0, 0});
    radius.push_back(0.5 * d), volume.push_back(V), mass.push_back(1e30);
    temperature.push_back(T), capacity.push_back(density * c * V);
  }
  /// Conductance by a Nusselt number.
  template <class Nusselt>
  void by(const silt::FluidConvection<Nusselt>& law) {
    heat.conductance = [law](std::size_t, const HeatedFluid& f) { return law.conductance({}, f); };
  }
  CoupledParticles view() {
    heat.temperature = temperature, heat.capacity = capacity;
    CoupledParticles all{{position, radius}, velocity, volume, mass};
    all.heat = &heat;
    return all;
  }
  double stored() const {
    double sum = 0;
    for (std::size_t p = 0; p < capacity.size(); ++p) sum += capacity[p] * temperature[p];
    return sum;
  }
};

/// Goldstein's J: gas temperature (over that of the inflow) of Schumann's bed at y transfer units
/// and dimensionless time s; the solid's is 1 - J(s, y). J = 1 - e^-s int_0^y e^-x I0(2 sqrt(s x)).
double J(double y, double s) {
  const int n = 2000;
  double sum = 0;
  for (int k = 0; k <= n; ++k) {  // Simpson
    const double x = y * k / n;
    const double f = std::exp(-s - x) * std::cyl_bessel_i(0, 2 * std::sqrt(s * x));
    sum += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * f;
  }
  return 1 - sum * y / (3 * n);
}

}  // namespace

// Catches a Nusselt number on another diameter, Re without the fluid's velocity, a decay that the
// step changes, and heat that is given twice.
TEST_CASE("heat exchange: a grain in a hot stream follows the exponential at any step") {
  const double U = 2, d = 2e-4, density = 2500, c = 840;
  const double Re = 1.2 * U * d / 1.8e-5, Pr = 1.8e-5 * 1005 / 0.026;
  const double Nu = 2 + 0.6 * std::sqrt(Re) * std::cbrt(Pr);
  const double rate = 6 * Nu * 0.026 / (d * d * density * c);  // [1/s] h A/C
  for (const double dt : {1e-3, 5e-3}) {
    CoupledFlow fluid(silt::SchillerNaumann{}, silt::Unresolved{},
                      FlowSolver(Grid({{0, 0, 0}, {0.1, 0.1, 0.1}}, {4, 4, 4}), air));
    FlowSolver& flow = fluid.flow();
    for (const int e : {1, 2})
      for (const int end : {0, 1}) flow.set_side(e, end, silt::FreeSlip{});
    flow.set_side(0, 0, silt::Inflow{{U, 0, 0}}), flow.set_side(0, 1, silt::Outflow{});
    flow.velocity(0).fill(U);
    flow.set_heat({.heat_capacity = 1005, .conductivity = 0.026, .start_temperature = 400});
    Grains grain;
    grain.add({0.0375, 0.0375, 0.0375}, d, 300, density, c);
    grain.by(silt::FluidConvection<silt::RanzMarshall>{});
    const int steps = static_cast<int>(std::lround(0.05 / dt));
    for (int s = 0; s < steps; ++s) fluid.advance(grain.view(), dt, grain.force);
    // The grain cools its cell of (25 mm)^3 by 1e-4 of the difference.
    CHECK(grain.temperature[0] == near(400 - 100 * std::exp(-rate * 0.05)).epsilon(1e-4));
    CHECK(400 - 100 * std::exp(-rate * 0.05) > 305);
    CHECK(fluid.closure().heat < 1e-12);
  }
}

// Catches weights of the way back that are not those of the way there, and a fluid that gets heat
// of another capacity.
TEST_CASE("heat exchange: a closed box keeps its heat and comes to the mean of capacities") {
  const double L = 0.02;
  CoupledFlow fluid(silt::SchillerNaumann{}, silt::Kernel{},
                    FlowSolver(Grid({{0, 0, 0}, {L, L, L}}, {8, 8, 8}), air));
  FlowSolver& flow = fluid.flow();
  flow.set_heat({.heat_capacity = 1005, .conductivity = 5});  // at one temperature soon
  flow.temperature().fill(500);
  Grains grains;
  silt::Random random(3);
  for (int n = 0; n < 60; ++n)
    grains.add({L * random.uniform(0, 1), L * random.uniform(0, 1), L * random.uniform(0, 1)},
               random.uniform(1e-3, 2e-3), 300 + n, 1.5, 900);
  grains.by(silt::FluidConvection<silt::Gunn>{});
  fluid.advance(grains.view(), 1e-9, grains.force);  // so that the voidage is known
  const double first = flow.heat_book().stored + grains.stored();
  double capacity = flow.heat_book().stored / 500;  // all but as it was
  for (const double C : grains.capacity) capacity += C;
  const double dt = flow.stable_step();
  for (int s = 0; s < 400; ++s) {
    fluid.advance(grains.view(), std::min(dt, 1e-3), grains.force);
    if (s % 40 == 0) CHECK(flow.heat_book().stored + grains.stored() == near(first).epsilon(1e-13));
  }
  CHECK(fluid.closure().heat < 1e-12);
  const auto [least, most] =
      std::minmax_element(grains.temperature.begin(), grains.temperature.end());
  CHECK(*least == near(*most).epsilon(1e-6));
  CHECK(*least == near(first / capacity).epsilon(1e-6));
  CHECK(flow.temperature()(3, 4, 5) == near(first / capacity).epsilon(1e-6));
}

// Catches an explicit exchange, which has no bound here: 1e5 relaxation times of the grains and of
// the gas in a step.
TEST_CASE(
    "heat exchange: grains of no capacity are in equilibrium after a step, without overshoot") {
  CoupledFlow fluid(silt::SchillerNaumann{}, silt::Kernel{},
                    FlowSolver(Grid({{0, 0, 0}, {0.02, 0.02, 0.02}}, {4, 4, 4}), air));
  fluid.flow().set_heat(heat_of_air);
  Grains grains;
  for (int n = 0; n < 64; ++n)
    grains.add({0.005 * (n % 4 + 0.5), 0.005 * (n / 4 % 4 + 0.5), 0.005 * (n / 16 + 0.5)}, 1e-3,
               n % 2 ? 300 : 350, 1e-3, 1000);
  grains.heat.conductance = [](std::size_t, const HeatedFluid&) { return 10.0; };
  fluid.advance(grains.view(), 1e-2, grains.force);
  for (int s = 0; s < 20; ++s) {
    fluid.advance(grains.view(), 1e-2, grains.force);
    for (const double T : grains.temperature) {
      CHECK(T > 293.1);
      CHECK(T < 350);
    }
  }
  CHECK(fluid.closure().heat < 1e-12);
}

// Catches any wrong factor between h, area, volume and both capacities, and heat that goes through
// the bed by a mode that smooths over several grains. First the closed form itself (recalled):
// dJ/dy = solid - gas, and d solid/ds = gas - solid.
TEST_CASE_TEMPLATE("heat exchange: hot gas through a cold bed, Schumann's temperatures", Mode,
                   silt::Unresolved, silt::Kernel, silt::TwoGrid, silt::Diffusion) {
  const auto solid = [](double y, double s) { return 1 - J(s, y); };
  for (const double y : {0.5, 3.0})
    for (const double s : {0.7, 4.0}) {
      const double e = 1e-3, off = solid(y, s) - J(y, s);
      CHECK((J(y + e, s) - J(y - e, s)) / (2 * e) == near(off).epsilon(1e-5));
      CHECK((solid(y, s + e) - solid(y, s - e)) / (2 * e) == near(-off).epsilon(1e-5));
    }
  CHECK(J(0, 2) == near(1));
  CHECK(std::abs(solid(2, 0)) < 1e-9);

  // A grain a cell; the grains' heat capacity is 20 times that of the gas around them.
  const int n = 60;
  const double d = 1e-3, h = 1.1e-3, U = 0.5;
  const double eps = 1 - pi / 6 / std::pow(1.1, 3), u = U / eps, gas = eps * 1.2 * 1005;
  CoupledFlow fluid(
      silt::SchillerNaumann{}, Mode{},
      FlowSolver(Grid({{0, 0, 0}, {h, h, n * h}}, {1, 1, n}, {true, true, false}), air));
  FlowSolver& flow = fluid.flow();
  flow.set_side(2, 0, silt::Inflow{{0, 0, U}}), flow.set_side(2, 1, silt::Outflow{});
  flow.set_heat({.heat_capacity = 1005, .conductivity = 1e-9, .start_temperature = 300});
  flow.set_side_heat(2, 0, {.temperature = 400});
  Grains grains;
  const double V = pi / 6 * d * d * d, C = 20 * gas * h * h * h;
  for (int k = 0; k < n; ++k) grains.add({0.5 * h, 0.5 * h, (k + 0.5) * h}, d, 300, 1, C / V);
  const double units = 24;                               // of transfer in the bed
  const double hA = units / n * 1.2 * 1005 * U * h * h;  // [W/K] of a grain
  grains.heat.conductance = [=](std::size_t, const HeatedFluid&) { return hA; };
  const double dt = 0.4 * h / u, end = 5 * C / hA;
  const int steps = static_cast<int>(end / dt);
  for (int s = 0; s < steps; ++s) fluid.advance(grains.view(), dt, grains.force);
  // TwoGrid's coarser cells hold no whole number of grains.
  const double uneven = std::is_same_v<Mode, silt::TwoGrid> ? 0.01 : 1e-12;
  CHECK(flow.voidage()(0, 0, 5) == near(eps).epsilon(uneven));
  double worst_gas = 0, worst_solid = 0;
  for (int k = 0; k < n; ++k) {
    const double y = units * (k + 0.5) / n;
    const double s = (steps * dt - (k + 0.5) * h / u) * hA / C;
    if (s < 0) continue;
    worst_gas = std::max(worst_gas, std::abs((flow.temperature()(0, 0, k) - 300) / 100 - J(y, s)));
    worst_solid = std::max(
        worst_solid,
        std::abs((grains.temperature[static_cast<std::size_t>(k)] - 300) / 100 - solid(y, s)));
  }
  MESSAGE("errors of gas and grains: ", worst_gas, ", ", worst_solid);
  CHECK(worst_gas < 0.02);  // cells of 0.4 units
  CHECK(worst_solid < 0.02);
  CHECK(fluid.closure().heat < 1e-12);
}

TEST_CASE("heat exchange: what cannot be is refused") {
  CoupledFlow fluid(silt::SchillerNaumann{}, silt::Unresolved{},
                    FlowSolver(Grid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4}), air));
  Grains grains;
  grains.add({0.5, 0.5, 0.5}, 1e-3, 300, 2500, 840);
  grains.by(silt::FluidConvection<>{});
  const auto says = [&](const char* part) {
    std::string all;
    try {
      fluid.advance(grains.view(), 1e-3, grains.force);
    } catch (const silt::InputError& e) {
      all = e.what();
    }
    CHECK_MESSAGE(all.find(part) != std::string::npos, all, " lacks ", part);
  };
  says("the flow has no temperature; give it one by FlowSolver::set_heat()");
  fluid.flow().set_heat({.heat_capacity = 1005, .conductivity = 0});
  says("FluidHeat.conductivity is 0 W/(m K)");
  fluid.flow().set_heat(heat_of_air);
  grains.capacity.clear();
  says("1 temperatures and 0 capacities for 1 velocities");
}

}  // namespace coupling_heat_test
