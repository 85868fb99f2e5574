// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/fluid/boundary_of.hpp>
#include <silt/fluid/flow_solver.hpp>

#include "fluid/turbulent.hpp"
#include "near.hpp"

namespace k_epsilon_test {

using silt::FlowSolver;
using silt::Grid;
using silt::KEpsilon;
using silt::Vec3d;
using silt::WallLaw;
using turbulent::mu, turbulent::nu, turbulent::prandtl, turbulent::rho;

namespace {

/// A periodic box of 4^3 cells of 0.1 m.
FlowSolver box(const KEpsilon& model) {
  FlowSolver flow(Grid({{0, 0, 0}, {0.4, 0.4, 0.4}}, {4, 4, 4}, {true, true, true}), {rho, mu});
  flow.set_turbulence(model);
  return flow;
}

/// Friction of a pipe over Prandtl's law, and how far its velocities are from the logarithmic one.
struct Friction {
  double over_prandtl, off_law;
};
Friction pipe(double Re, int cells, double off, double time) {
  const double D = 0.05, U = Re * nu / D, h = D / cells,
               slope = prandtl(Re) * 0.5 * rho * U * U / D;
  const Vec3d middle{0, (0.5 * (cells + 2) + off) * h, (0.5 * (cells + 2) + 0.7 * off) * h};
  FlowSolver flow(Grid({{0, 0, 0}, {2 * h, (cells + 2) * h, (cells + 2) * h}},
                       {2, cells + 2, cells + 2}, {true, false, false}),
                  {rho, mu});
  flow.set_boundary(silt::boundary_of(
      silt::Cylinder{middle - Vec3d{1, 0, 0}, middle + Vec3d{1, 0, 0}, D / 2, silt::Side::Inside}));
  flow.set_turbulence(KEpsilon{.width = D});
  flow.force(0).fill(slope), flow.velocity(0).fill(U);
  for (double t = 0; t < time * D / U / prandtl(Re);) {
    const double dt = flow.stable_step();
    flow.step(dt), t += dt;
  }
  const double mean = flow.flow_rate(0, 0) / (std::numbers::pi / 4 * D * D);
  const double ustar = std::sqrt(slope * D / 4 / rho);
  double off_law = 0;
  for (int k = 0; k < cells + 2; ++k)
    for (int j = 0; j < cells + 2; ++j) {
      const double y = D / 2 - std::hypot((j + 0.5) * h - middle.y, (k + 0.5) * h - middle.z);
      if (y < 1.5 * h || y > 0.8 * D / 2) continue;
      const double law = 2.5 * std::log(y * ustar / nu) + 5.5;
      off_law = std::max(off_law, std::abs(flow.velocity(0)(0, j, k) / ustar / law - 1));
    }
  return {slope * D / (0.5 * rho * mean * mean) / prandtl(rho * mean * D / mu), off_law};
}

/// Air between plates, see turbulent::channel, after `end` [s].
FlowSolver channel(int cells, double wide, double slope, double start, double plates, double end) {
  FlowSolver flow = turbulent::channel(cells, wide, slope, start, plates);
  const KEpsilon model{.width = wide};
  flow.set_turbulence(model);
  flow.turbulent_energy().fill(model.energy(start));  // whatever the plates do
  for (double t = 0; t < end; t += 4e-4) flow.step(4e-4);
  return flow;
}

}  // namespace

TEST_CASE("wall law: u+ at y+ is the inverse of y+ at u+") {
  for (const double u : {0.1, 1.0, 5.0, 15.0, 25.0})
    CHECK(WallLaw::u_plus_at(WallLaw::y_plus(u)) == near(u));
  CHECK(WallLaw::u_plus_at(0) == 0);
}

TEST_CASE("k-epsilon: homogeneous turbulence decays as its closed form, first order in the step") {
  // dk/dt = -epsilon, depsilon/dt = -C2 epsilon^2/k, T0 = k0/epsilon0:
  //   k = k0 (1 + (C2-1) t/T0)^(-1/(C2-1)),  k/epsilon = T0 + (C2-1) t
  const KEpsilon model{.width = 100};
  const double k0 = 0.6, e0 = 1.5, T0 = k0 / e0, end = 2 * T0, n = model.C2 - 1;
  const double k = k0 * std::pow(1 + n * end / T0, -1 / n);
  double error[2];
  for (const int fine : {0, 1}) {
    FlowSolver flow = box(model);
    flow.turbulent_energy().fill(k0), flow.dissipation().fill(e0);
    const int steps = 100 << fine;
    for (int m = 0; m < steps; ++m) flow.step(end / steps);
    const double found = flow.turbulent_energy()(1, 2, 3);
    error[fine] = std::abs(found / k - 1);
    CHECK(found / flow.dissipation()(1, 2, 3) ==
          near(T0 + n * end).epsilon(0.02));  // two steps of a hundred
    CHECK(flow.turbulent_energy()(0, 0, 0) == near(found).epsilon(1e-12));
  }
  CHECK(error[0] < 0.02);
  CHECK(error[1] / error[0] == near(0.5).epsilon(0.05));
}

TEST_CASE("k-epsilon: in homogeneous shear, production over dissipation is (C2-1)/(C1-1)") {
  // d(k/epsilon)/dt = (C2 - 1) - (C1 - 1) P/epsilon, whose rest P/epsilon = 2.09 all shears tend
  // to. Couette flow between plates has its shear only near the middle: here it is held by forces
  // so large that nothing else counts, as velocities are set before each step.
  const KEpsilon model{.width = 100};
  FlowSolver flow(Grid({{0, 0, 0}, {0.2, 0.8, 0.2}}, {2, 8, 2}, {true, false, true}), {rho, mu});
  for (const int side : {0, 1}) flow.set_side(1, side, silt::FreeSlip{});
  flow.set_turbulence(model);
  const double S = 20;  // [1/s]
  const double k0 = 1e-4;
  flow.turbulent_energy().fill(k0), flow.dissipation().fill(0.2 * S * k0);
  double P = 0, epsilon = 1;
  for (int m = 0; m < 1500; ++m) {  // 15/S in units of the shear
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 2; ++i) flow.velocity(0)(i, j, k) = S * 0.1 * (j - 3.5);
    flow.start();
    flow.step(5e-4);
    epsilon = flow.dissipation()(0, 3, 0);
    P = model.C_mu * std::pow(flow.turbulent_energy()(0, 3, 0), 2) / epsilon * S * S;
  }
  // 1 %: exp(-15 ...) is left of the start; sides are two eddies away; a step of 0.01/S.
  CHECK(P / epsilon == near((model.C2 - 1) / (model.C1 - 1)).epsilon(0.01));
}

TEST_CASE("k-epsilon: pipe friction within 10 % of Prandtl's law, velocities on the logarithm") {
  // What is left is that the wall cuts cells. Seen with 10 to 16 cells, three places of the axis in
  // them: -2 to 4 % at Re = 4e4, -3 to 0 % at 1e5; 2 to 14 % at 1.5e4.
  for (const double Re : {4e4, 1e5}) {
    const Friction f = pipe(Re, 10, 0.25, 1);
    CAPTURE(Re);
    CHECK(f.over_prandtl == near(1).epsilon(0.10));
    CHECK(f.off_law < 0.05);  // half of what the friction may be wrong
  }
}

TEST_CASE("k-epsilon: pipe friction within 10 % of Prandtl's law, askew to the cells") {
  CHECK(turbulent::askew_friction(8, 4.6e4, 0.05, KEpsilon{.width = 0.05}) ==
        near(1).epsilon(0.10));  // seen: -1 %
}

TEST_CASE("k-epsilon between plates: Dean's friction, equilibrium in the logarithmic layer") {
  // R. B. Dean, J. Fluids Eng. 100 (1978) 215: Cf = 0.073 Re^(-1/4), Re = U 2H/nu, within some 5 %.
  const double wide = 0.04, U = 10, Re = U * wide / nu;
  const double shear = 0.073 * std::pow(Re, -0.25) * 0.5 * rho * U * U, slope = 2 * shear / wide;
  const double ustar = std::sqrt(shear / rho);
  FlowSolver still = channel(20, wide, slope, U, 0, 0.6);
  const FlowSolver moving = channel(20, wide, slope, U, 3, 0.6);
  double mean = 0;
  for (int j = 0; j < 20; ++j) {
    mean += still.velocity(0)(0, j, 0) / 20;
    CHECK(moving.velocity(0)(0, j, 0) == near(3 + still.velocity(0)(0, j, 0)));
  }
  CHECK(mean == near(U).epsilon(0.05));  // 10 % of friction
  for (const int j : {1, 2, 3}) {        // y+ from some 100 to 250, y up to 0.35 H
    const double h = wide / 20, y = (j + 0.5) * h, k = still.turbulent_energy()(0, j, 0),
                 epsilon = still.dissipation()(0, j, 0), nu_t = 0.09 * k * k / epsilon;
    const auto u = [&](int at) { return still.velocity(0)(0, at, 0); };
    // Slope of a logarithm through both neighbours.
    const double slope_here = (u(j + 1) - u(j - 1)) / (y * std::log((y + h) / (y - h)));
    const double P = nu_t * slope_here * slope_here;
    CAPTURE(j);
    // Of the shear, 1 - y/H is left; transport by diffusion is some 10 % of either.
    CHECK(P / epsilon == near(1).epsilon(0.15));
    CHECK(u(j) / ustar == near(2.5 * std::log(y * ustar / nu) + 5.5).epsilon(0.05));
  }
}

TEST_CASE("k-epsilon: a jump at the inlet goes through the box between its bounds") {
  // No shear, but turbulence that flows in is 1e6 times what is there, across faces askew to the
  // flow; only sinks are in the box. Above the inflow's values nothing may come, nor below 0.
  FlowSolver flow(Grid({{0, 0, 0}, {0.4, 0.2, 0.05}}, {32, 16, 4}, {false, true, true}), {rho, mu},
                  {.model = silt::MomentumModel::A});
  flow.set_side(0, 0, silt::Inflow{.velocity = {5, 3, 0}});
  flow.set_side(0, 1, silt::Outflow{});
  const KEpsilon model{.width = 0.05, .intensity = 0.2};
  flow.set_turbulence(model);
  for (int d : {0, 1}) flow.velocity(d).fill(d == 0 ? 5 : 3);
  const double in = model.energy(5), e_in = model.dissipation(in, model.inflow_length());
  flow.turbulent_energy().fill(1e-6 * in), flow.dissipation().fill(1e-6 * e_in);
  double least = 1, most = 0, e_least = 1, e_most = 0;
  for (double t = 0; t < 0.12;) {
    const double dt = flow.stable_step();
    flow.step(dt), t += dt;
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 32; ++i) {
          const double a = flow.turbulent_energy()(i, j, k) / in,
                       b = flow.dissipation()(i, j, k) / e_in;
          least = std::min(least, a), most = std::max(most, a);
          e_least = std::min(e_least, b), e_most = std::max(e_most, b);
        }
  }
  CHECK(least > 0);
  CHECK(e_least > 0);
  CHECK(most <= 1 + 1e-12);
  CHECK(e_most <= 1 + 1e-12);
  // What flows decays as in homogeneous turbulence, t = x/5 later: 3.2 % off at most, of first
  // order (1.6 % in cells of half the size).
  const double T0 = in / e_in, n = model.C2 - 1;
  for (const int i : {8, 24}) {
    const double t = (i + 0.5) * 0.0125 / 5;
    CHECK(flow.turbulent_energy()(i, 5, 1) / in ==
          near(std::pow(1 + n * t / T0, -1 / n)).epsilon(0.035));
  }
}

TEST_CASE("k-epsilon: a voidage that jumps neither makes nor takes k of uniform turbulence") {
  // eps rho k is carried with the fluxes that carry eps: what is uniform stays so.
  KEpsilon model{.width = 0.1};
  FlowSolver flow = box(model);
  flow.turbulent_energy().fill(0.3), flow.dissipation().fill(1e-9);
  flow.velocity(0).fill(1);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) flow.voidage()(1, j, k) = 0.5;
  flow.force(0).fill(1);
  const double dt = 1e-4;
  flow.step(dt);
  for (int i = 0; i < 4; ++i)  // sources aside: P is below 1 m2/s3
    CHECK(flow.turbulent_energy()(i, 2, 2) == near(0.3).epsilon(0.01));
}

TEST_CASE("k-epsilon: a wall through the centres of cells makes no turbulence of its own") {
  const double h = 0.005;
  FlowSolver flow(Grid({{0, 0, 0}, {2 * h, 8 * h, h}}, {2, 8, 1}, {true, false, true}), {rho, mu});
  flow.set_boundary({.distance = [=](const Vec3d& x) { return x.y - 0.5 * h * (1 - 1e-12); }});
  flow.set_turbulence(KEpsilon{.width = 0.04});
  flow.velocity(0).fill(10);
  const double U = 10;
  for (int m = 0; m < 20; ++m) flow.step(1e-5);
  for (int j = 0; j < 8; ++j) CHECK(flow.turbulent_energy()(0, j, 0) < U * U / 2);
}

TEST_CASE("k-epsilon: threads, states and refusals") {
  const auto start = [] { return channel(8, 0.04, 30, 10, 0, 0.01); };
  FlowSolver flow = start();
  std::vector<std::vector<double>> saved;
  flow.for_each_state([&](const std::string&, std::span<double> part) {
    saved.emplace_back(part.begin(), part.end());
  });
  FlowSolver again(flow.grid(), flow.fluid());
  again.set_turbulence(KEpsilon{.width = 0.04});
  again.force(0).fill(30);
  std::size_t n = 0;
  again.for_each_state([&](const std::string&, std::span<double> part) {
    std::copy(saved[n].begin(), saved[n].end(), part.begin()), ++n;
  });
  CHECK(again.stable_step() == flow.stable_step());
  for (int m = 0; m < 3; ++m) flow.step(4e-4), again.step(4e-4, silt::Team(3));
  for (int j = 0; j < 8; ++j) {
    CHECK(again.velocity(0)(1, j, 0) == flow.velocity(0)(1, j, 0));
    CHECK(again.turbulent_energy()(1, j, 0) == flow.turbulent_energy()(1, j, 0));
    CHECK(again.dissipation()(1, j, 0) == flow.dissipation()(1, j, 0));
  }

  FlowSolver other(flow.grid(), flow.fluid());
  CHECK_THROWS_WITH_AS(other.turbulent_energy(), doctest::Contains("set_turbulence(KEpsilon)"),
                       silt::InputError);
  other.set_turbulence({.half_width = 0.02});
  CHECK_THROWS_WITH_AS(other.dissipation(), doctest::Contains("set_turbulence(KEpsilon)"),
                       silt::InputError);
  const auto refused = [&](const KEpsilon& model, const char* of) {
    CHECK_THROWS_WITH_AS(other.set_turbulence(model), doctest::Contains(of), silt::InputError);
  };
  refused({}, "KEpsilon.width");
  refused({.width = 1, .intensity = 0}, "KEpsilon.intensity");
  refused({.width = 1, .length = -1}, "KEpsilon.length");
  refused({.width = 1, .C_mu = 0}, "KEpsilon.C_mu");
  refused({.width = 1, .C1 = 2}, "C2");
  refused({.width = 1, .sigma_k = 0.5}, "KEpsilon.sigma_k");
  other.set_turbulence(KEpsilon{.width = 0.04});
  other.turbulent_energy().fill(-1);
  CHECK_THROWS_WITH_AS(other.step(1e-4), doctest::Contains("give them values above 0"),
                       silt::InputError);
  FlowSolver ideal(flow.grid(), {1.2, 0});
  CHECK_THROWS_WITH_AS(ideal.set_turbulence(KEpsilon{.width = 0.04}),
                       doctest::Contains("viscosity > 0"), silt::InputError);
}

}  // namespace k_epsilon_test
