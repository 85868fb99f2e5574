// silt - BSD-3-Clause, see LICENSE
// The temperature of the flow solver against closed forms: conduction, advection, heated channels,
// walls, buoyancy; its books; and refusals.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/random.hpp>
#include <silt/fluid/flow_mean.hpp>
#include <silt/fluid/flow_solver.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace fluid_heat_test {

using silt_test::has, silt_test::refusal;

using silt::FlowSolver;
using silt::FluidProperties;
using silt::Grid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;
const FluidProperties air{1.2, 1.8e-5};
const silt::FluidHeat heat_of_air{.heat_capacity = 1005, .conductivity = 0.026};

template <class Of>
void set_temperature(FlowSolver& flow, const Of& of) {
  const Grid& g = flow.grid();
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) flow.temperature()(i, j, k) = of(g.centre(i, j, k));
}
struct Range {
  double least = 1e300, most = -1e300;
};
Range range_of(const FlowSolver& flow) {
  Range all;
  const Grid& g = flow.grid();
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) {
        if (flow.open_cells() && (*flow.open_cells())(i, j, k) == 0) continue;
        const double T = flow.temperature()(i, j, k);
        all.least = std::min(all.least, T), all.most = std::max(all.most, T);
      }
  return all;
}
/// Stored heat less what the book says, over what has passed.
double open_book(const FlowSolver& flow, double stored_at_first) {
  const auto book = flow.heat_book();
  return (book.stored - stored_at_first - book.received()) / stored_at_first;
}

/// The error of a slab at 0 that is suddenly held at 1 above it, after t = 1/16 L^2/alpha.
double error_of_slab(int n, double* open) {
  const double L = 0.1, alpha = 0.026 / (1.2 * 1005);
  FlowSolver flow(Grid({{0, 0, 0}, {L, 0.1, 0.1}}, {n, 1, 1}, {false, true, true}), air);
  flow.set_heat(heat_of_air);
  flow.set_side_heat(0, 0, {.temperature = 294.15});
  const double first = flow.heat_book().stored, end = 0.01 * L * L / alpha;
  const int steps = n * n / 4;
  for (int s = 0; s < steps; ++s) flow.step(end / steps);
  double worst = 0;
  for (int i = 0; i < n; ++i) {
    const double x = flow.grid().centre(i, 0, 0).x;
    worst = std::max(worst, std::abs(flow.temperature()(i, 0, 0) - 293.15 -
                                     std::erfc(x / (2 * std::sqrt(alpha * end)))));
  }
  *open = open_book(flow, first);
  return worst;
}

/// Mean error of a hump after it has crossed the periodic box once.
double error_of_hump(int n, bool front, Range* range) {
  FlowSolver flow(Grid({{0, 0, 0}, {1, 0.1, 0.1}}, {n, 1, 1}, {true, true, true}), {1.2, 0});
  flow.set_heat({.heat_capacity = 1005, .conductivity = 0});
  flow.velocity(0).fill(2);
  flow.voidage().fill(0.5);
  const auto hump = [&](const Vec3d& x) {
    if (front) return x.x > 0.3 && x.x < 0.6 ? 400.0 : 300.0;
    return 300 + 100 * std::pow(std::sin(pi * x.x), 4);
  };
  set_temperature(flow, hump);
  for (int s = 0; s < 2 * n; ++s) flow.step(0.25 / n);
  double sum = 0;
  for (int i = 0; i < n; ++i)
    sum += std::abs(flow.temperature()(i, 0, 0) - hump(flow.grid().centre(i, 0, 0))) / n;
  *range = range_of(flow);
  return sum / 100;
}

/// A channel of plug flow along x.
FlowSolver channel(int n, double U, const silt::FluidHeat& heat) {
  FlowSolver flow(Grid({{0, 0, 0}, {0.1, 0.02, 0.02}}, {n, 2, 2}), air);
  for (const int d : {1, 2})
    for (const int end : {0, 1}) flow.set_side(d, end, silt::FreeSlip{});
  flow.set_side(0, 0, silt::Inflow{{U, 0, 0}}), flow.set_side(0, 1, silt::Outflow{});
  flow.velocity(0).fill(U);
  flow.set_heat(heat);
  return flow;
}

}  // namespace

// Catches a half cell too much or too little at the wall, k without c, a conduction of first order.
TEST_CASE("heat of the fluid: a slab that is suddenly heated follows erfc, second order") {
  double open_32, open_64;
  const double e_32 = error_of_slab(32, &open_32), e_64 = error_of_slab(64, &open_64);
  MESSAGE("errors with 32 and 64 cells: ", e_32, ", ", e_64);
  CHECK(e_64 < 2e-3);
  CHECK(e_32 / e_64 > 3.2);  // 4, less what the jump at the start leaves
  CHECK(std::abs(open_32) < 1e-13);
  CHECK(std::abs(open_64) < 1e-13);
}

// Catches fluxes that are upwind alone (order 1), and slopes that overshoot.
TEST_CASE("heat of the fluid: a hump that is carried through the box, and a front") {
  Range of_hump, of_front;
  const double e_64 = error_of_hump(64, false, &of_hump),
               e_128 = error_of_hump(128, false, &of_hump);
  MESSAGE("errors with 64 and 128 cells: ", e_64, ", ", e_128);
  CHECK(e_64 / e_128 > 3);  // minmod: second order but for the top
  CHECK(e_128 < 4e-3);
  const double f = error_of_hump(64, true, &of_front);
  CHECK(f < 0.1);
  for (const Range& r : {of_hump, of_front}) {
    CHECK(r.least >= 300 * (1 - 1e-13));
    CHECK(r.most <= 400 * (1 + 1e-13));
  }
}

// Catches eps that is forgotten in storage or fluxes, and temperatures that follow the voidage.
TEST_CASE("heat of the fluid: a uniform temperature stays one while the voidage moves") {
  const int n = 24;
  FlowSolver flow(Grid({{0, 0, 0}, {0.24, 0.04, 0.04}}, {n, 4, 4}), air);
  flow.set_side(0, 0, silt::Inflow{{0.5, 0, 0}}), flow.set_side(0, 1, silt::Outflow{});
  flow.set_heat(heat_of_air);
  double first = -1;
  for (int s = 0; s < 60; ++s) {
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < n; ++i)
          flow.voidage()(i, j, k) =
              0.7 + 0.2 * std::sin(0.6 * i + 0.3 * j - 0.05 * s) * std::min(1.0, s / 10.0);
    flow.step(2e-3);
    if (first < 0) first = flow.heat_book().stored - flow.heat_book().received();
  }
  const Range r = range_of(flow);
  CHECK(r.least == near(293.15).epsilon(1e-13));
  CHECK(r.most == near(293.15).epsilon(1e-13));
  CHECK(std::abs(open_book(flow, first)) < 1e-13);
  CHECK(flow.heat_book().through_sides != 0);
}

// Where eps jumps, a step carries what the one before it has carried. Catches fluxes of that step
// in one of another length, which took 9 % of a cell's fluid: temperatures were off by 3 K.
TEST_CASE("heat of the fluid: a uniform temperature stays one while the voidage jumps") {
  const int n = 16;
  FlowSolver flow(Grid({{0, 0, 0}, {0.16, 0.04, 0.04}}, {n, 4, 4}), air);
  flow.set_side(0, 0, silt::Inflow{{0.5, 0, 0}}), flow.set_side(0, 1, silt::Outflow{});
  flow.set_heat(heat_of_air);
  silt::Random random(3);
  for (int s = 0; s < 40; ++s) {
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < n; ++i)
          if (s == 0 || random.uniform(0, 1) < 0.1)
            flow.voidage()(i, j, k) = random.uniform(0, 1) < 0.5 ? 0.35 : 0.9;
    flow.step((1 + s % 3) * std::min(5e-4, 0.3 * flow.stable_step()));
  }
  const Range r = range_of(flow);
  CHECK(r.least == near(293.15).epsilon(1e-5));  // the pressure's tolerance, 1e-6 of a cell's fluid
  CHECK(r.most == near(293.15).epsilon(1e-5));
}

// Catches heat that sides or moving fluid make, also with walls that stand askew in the box.
TEST_CASE("heat of the fluid: a closed box keeps its heat, and no cell leaves the range") {
  for (const bool walls : {false, true}) {
    FlowSolver flow(Grid({{0, 0, 0}, {0.1, 0.1, 0.02}}, {16, 16, 2}, {false, false, true}),
                    {1.2, 1e-4});
    flow.set_side(1, 1, silt::NoSlip{{1, 0, 0}});
    if (walls)
      flow.set_boundary(
          {[](const Vec3d& x) { return (x.y - 0.3 * x.x - 0.013) / std::hypot(1, 0.3); }});
    flow.set_heat({.heat_capacity = 1005, .conductivity = 20});
    set_temperature(flow, [](const Vec3d& x) { return x.x < 0.05 ? 300.0 : 350.0; });
    const double first = flow.heat_book().stored;
    for (int s = 0; s < 100; ++s) flow.step(1e-3);
    const auto book = flow.heat_book();
    CAPTURE(walls);
    CHECK(book.stored == near(first).epsilon(1e-13));
    CHECK(book.counted_anew == 0);
    const Range r = range_of(flow);
    CHECK(r.least >= 300 * (1 - 1e-13));
    CHECK(r.most <= 350 * (1 + 1e-13));
    CHECK(r.most - r.least < 49);
  }
}

// Catches a heat capacity per volume of the wrong fluid, and inflow that does not bring its heat.
TEST_CASE("heat of the fluid: a channel's outlet is warmer by Q/(m c)") {
  const double U = 1, Q = 5, A = 0.02 * 0.02;
  FlowSolver flow = channel(20, U, heat_of_air);
  flow.set_side_heat(0, 0, {.temperature = 300});
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 8; i < 12; ++i) flow.heat_source()(i, j, k) = Q / (A * 0.02);
  for (int s = 0; s < 800; ++s) flow.step(2e-3);
  const double warmer = Q / (1.2 * U * A * 1005);
  CHECK(flow.temperature()(19, 1, 0) == near(300 + warmer).epsilon(1e-9));
  CHECK(flow.temperature()(2, 1, 0) == near(300).epsilon(1e-9));
  CHECK(silt::flow_at(flow, {0.099, 0.005, 0.005}).temperature.value() ==
        near(300 + warmer).epsilon(1e-9));
  const auto book = flow.heat_book();
  CHECK(book.from_sources == near(Q * 1.6).epsilon(1e-11));
  silt::FlowMean mean;
  mean.add(flow, 0.1), mean.add(flow, 0.1);
  CHECK(mean.temperature(19, 1, 0) == near(300 + warmer).epsilon(1e-9));
  CHECK(mean.temperature_rms(19, 1, 0) < 1e-6);
}

// Catches a flux through the area of all cells instead of those at the wall, or of the wrong sign.
TEST_CASE("heat of the fluid: walls that are held, that give a flux, and inflow in time") {
  FlowSolver slab(Grid({{0, 0, 0}, {0.1, 0.1, 0.1}}, {10, 1, 1}, {false, true, true}), {1.2, 1e-9});
  slab.set_heat(heat_of_air);
  slab.voidage().fill(0.6);
  slab.set_side_heat(0, 0, {.flux = 20});
  slab.set_side_heat(0, 1, {.temperature_at = [](const Vec3d&, double) { return 310.0; }});
  for (int s = 0; s < 400; ++s) slab.step(25);
  for (const int i : {0, 5, 9})  // q/(eps k) on
    CHECK(slab.temperature()(i, 0, 0) ==
          near(310 + 20 / (0.6 * 0.026) * (0.1 - 0.01 * (i + 0.5))).epsilon(1e-9));

  // A ramp in time is carried without a change of its form: T(x, t) = ramp(t - x/U).
  FlowSolver flow = channel(20, 1, {.heat_capacity = 1005, .conductivity = 0});
  flow.set_side_heat(0, 0, {.temperature_at = [](const Vec3d&, double t) { return 300 + 50 * t; }});
  for (int s = 0; s < 200; ++s) flow.step(2e-3);
  // The inflow has what it will have at the step's end: half a step early.
  for (const int i : {5, 15})
    CHECK(flow.temperature()(i, 0, 1) ==
          near(300 + 50 * (0.4 + 1e-3 - 0.005 * (i + 0.5))).epsilon(1e-4));
}

// Catches a sign or a factor in the buoyancy: the profile between a hot and a cold wall.
TEST_CASE("heat of the fluid: buoyancy drives the cubic profile between hot and cold plates") {
  const double L = 0.02, g = 9.81, beta = 3e-3, dT = 2, nu = 2e-5;
  const auto error = [&](int n) {
    FlowSolver flow(Grid({{-0.5 * L, 0, 0}, {0.5 * L, L, L}}, {n, 1, 1}, {false, true, true}),
                    {1, nu});
    flow.set_heat({.heat_capacity = 1000,
                   .conductivity = 0.03,
                   .start_temperature = 300,
                   .expansion = beta,
                   .reference_temperature = 300,
                   .gravity = {0, 0, -g}});
    flow.set_side_heat(0, 0, {.temperature = 300 + 0.5 * dT});
    flow.set_side_heat(0, 1, {.temperature = 300 - 0.5 * dT});
    const double h = L / n;
    for (int s = 0; s < 6 * n * n; ++s) flow.step(0.3 * h * h / nu);
    double worst = 0, most = 0;
    for (int i = 0; i < n; ++i) {
      const double x = flow.grid().centre(i, 0, 0).x;
      const double u = g * beta * dT / (6 * nu * L) * (x * x * x - 0.25 * L * L * x);
      worst = std::max(worst, std::abs(flow.velocity(2)(i, 0, 0) - u)), most = std::max(most, u);
    }
    return worst / most;
  };
  const double e_8 = error(8), e_16 = error(16);
  MESSAGE("errors with 8 and 16 cells: ", e_8, ", ", e_16);
  CHECK(e_16 < 0.03);
  CHECK(e_8 / e_16 > 3.4);
}

// Catches state that a step goes on from and that is not saved; and results that depend on threads.
TEST_CASE("heat of the fluid: goes on from its state, bit for bit, on any number of threads") {
  const auto make = [] {
    FlowSolver flow(Grid({{0, 0, 0}, {0.06, 0.06, 0.06}}, {6, 6, 6}), {1.2, 1e-4});
    flow.set_side(2, 1, silt::NoSlip{{1, 0.3, 0}});
    flow.set_heat(
        {.heat_capacity = 1005, .conductivity = 0.5, .expansion = 3e-3, .gravity = {0, 0, -9}});
    flow.set_side_heat(0, 0, {.temperature = 330});
    return flow;
  };
  FlowSolver whole = make(), first = make();
  const silt::Team three(3);
  for (int s = 0; s < 20; ++s) whole.step(2e-3);
  for (int s = 0; s < 10; ++s) first.step(2e-3, three);
  std::vector<double> state;
  first.for_each_state([&](const std::string&, auto values) {
    state.insert(state.end(), values.begin(), values.end());
  });
  FlowSolver second = make();
  std::size_t at = 0;
  second.for_each_state([&](const std::string&, auto values) {
    for (double& v : values) v = state[at++];
  });
  CHECK(at == state.size());
  for (int s = 0; s < 10; ++s) second.step(2e-3, three);
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i)
      CHECK(second.temperature()(i, 3, k) == whole.temperature()(i, 3, k));
  CHECK(second.heat_book().through_sides == whole.heat_book().through_sides);
  CHECK(whole.velocity(2)(1, 3, 3) != 0);
}

TEST_CASE("heat of the fluid: what cannot be is refused") {
  FlowSolver flow(Grid({{0, 0, 0}, {0.01, 0.01, 0.01}}, {4, 4, 4}, {false, false, true}), air);
  has(refusal([&] { flow.temperature(); }), "set_heat() first");
  has(refusal([&] { flow.set_heat({.conductivity = 1}); }), "heat_capacity = 0 J/(kg K)");
  has(refusal([&] { flow.set_heat({.heat_capacity = 1}); }), "conductivity [W/(m K)] must be");
  has(refusal([&] { flow.set_heat({.heat_capacity = 1, .conductivity = 1, .expansion = 1}); }),
      "give the gravity too");
  flow.set_heat({.heat_capacity = 1000, .conductivity = 1e3});
  has(refusal([&] { flow.set_side_heat(2, 0, {}); }), "periodic in z");
  has(refusal([&] { flow.set_side_heat(0, 0, {.temperature = -1}); }), "SideHeat.temperature");
  has(refusal([&] { flow.step(0.05); }), "heat spreads over");
  flow.set_heat(heat_of_air);
  flow.set_side_heat(0, 1, {.temperature = 300, .flux = 1});
  has(refusal([&] { flow.step(1e-3); }), "the side in x has a SideHeat.flux");
  flow.set_side_heat(0, 1, {.flux_at = [](const Vec3d&, double) { return NAN; }});
  has(refusal([&] { flow.step(1e-3); }), "SideHeat.flux is nan");
  flow.set_side_heat(0, 1, {.temperature = 300});
  for (const double wrong : {-5.0, std::nan("")}) {
    flow.temperature()(1, 2, 3) = wrong;
    has(refusal([&] { flow.step(1e-3); }), "temperature of cell (1, 2, 3) is ");
  }
  flow.temperature()(1, 2, 3) = 300;
  flow.heat_source()(3, 2, 1) = NAN;
  has(refusal([&] { flow.step(1e-3); }), "heat source of cell (3, 2, 1) is nan W/m3");
  flow.heat_source()(3, 2, 1) = 0;
  flow.set_turbulence(silt::MixingLength{0.005});
  has(refusal([&] { flow.step(1e-3); }), "no thermal wall function");
}

}  // namespace fluid_heat_test
