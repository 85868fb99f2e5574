// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "near.hpp"

#include <silt/fluid/flow_solver.hpp>

namespace inflow_in_time_test {

using silt::FlowSolver;
using silt::FreeSlip;
using silt::Grid;
using silt::Inflow;
using silt::Outflow;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;
constexpr silt::FluidProperties liquid{1000, 0.01};  // nu = 1e-5 m2/s

/// A channel along x whose sides have no friction: the flow is a plug.
FlowSolver plug(const Inflow& in) {
  FlowSolver flow(Grid({{0, 0, 0}, {0.1, 0.02, 0.02}}, {20, 4, 4}), liquid, {.tolerance = 1e-10});
  for (const int d : {1, 2})
    for (const int end : {0, 1}) flow.set_side(d, end, FreeSlip{});
  flow.set_side(0, 0, in), flow.set_side(0, 1, Outflow{});
  return flow;
}
/// [Pa/m] in the middle of the channel.
double slope(const FlowSolver& flow) {
  return (flow.pressure()(12, 1, 1) - flow.pressure()(8, 1, 1)) / (4 * flow.grid().h().x);
}
std::string said_by(const auto& action) {
  try {
    action();
  } catch (const silt::InputError& e) {
    return e.what();
  }
  return {};
}

/// Flow between plates at y = +-H that a pressure gradient -G cos(w t) [Pa/m] drives.
struct Womersley {
  double H, omega, G;
  double velocity(double y, double t) const {
    using C = std::complex<double>;
    const C i(0, 1), k = std::sqrt(i * omega * liquid.density / liquid.viscosity);
    return std::real(G / (i * omega * liquid.density) *
                     (1.0 - std::cosh(k * y) / std::cosh(k * H)) * std::exp(i * omega * t));
  }
  double slope(double t) const { return -G * std::cos(omega * t); }
};
struct Errors {
  double velocity, slope;  // [-] of the largest
};
/// After a period, with the exact profile at the inlet, n cells across and as many steps as fit.
Errors after_a_period(int n, int steps) {
  const Womersley exact{0.005, 2 * pi, 20};  // Womersley number H sqrt(w/nu) = 4
  FlowSolver flow(Grid({{0, -exact.H, 0}, {0.02, exact.H, 0.001}}, {n, n, 1}, {false, false, true}),
                  liquid, {.tolerance = 1e-10});
  flow.set_side(0, 0, Inflow{.velocity_in_time = [&](const Vec3d& x, double t) {
                  return Vec3d{exact.velocity(x.y, t), 0, 0};
                }});
  flow.set_side(0, 1, Outflow{});
  const double h = flow.grid().h().y;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= n; ++i)
      flow.velocity(0)(i, j, 0) = exact.velocity(-exact.H + (j + 0.5) * h, 0);
  const double dt = 1.0 / steps;
  Errors worst{0, 0};
  double fastest = 0;
  for (int s = 1; s <= steps; ++s) {
    flow.step(dt);
    for (int j = 0; j < n; ++j) {
      const double u = exact.velocity(-exact.H + (j + 0.5) * h, s * dt);
      fastest = std::max(fastest, std::abs(u));
      worst.velocity = std::max(worst.velocity, std::abs(flow.velocity(0)(n / 2, j, 0) - u));
    }
    if (s < steps / 10) continue;  // the pressure at the start is not known
    const auto& p = flow.pressure();
    const double found =
        (p(3 * n / 4, n / 2, 0) - p(n / 4, n / 2, 0)) / (n / 2 * flow.grid().h().x);
    worst.slope = std::max(worst.slope, std::abs(found - exact.slope((s - 0.5) * dt)) / exact.G);
  }
  return {worst.velocity / fastest, worst.slope};
}

}  // namespace

TEST_CASE("a plug that is accelerated has the slope of pressure -rho dU/dt") {
  // Steadily from rest, and swinging. Catches an inflow that is a step late or early (the slope's
  // phase is then off by w dt = 3 %), and one whose pressure is lost where the flow turns.
  const double a = 0.3;
  FlowSolver started = plug({.velocity_in_time = [&](const Vec3d&, double t) {
    return Vec3d{a * t, 0, 0};
  }});
  for (int s = 0; s < 40; ++s) {
    started.step(2e-3);
    CHECK(slope(started) == doctest::Approx(-liquid.density * a).epsilon(1e-7));
    CHECK(started.velocity(0)(10, 2, 2) == doctest::Approx(a * started.time()).epsilon(1e-8));
  }
  CHECK(started.time() == doctest::Approx(0.08).epsilon(1e-12));

  const double U = 0.05, omega = 2 * pi * 5, dt = 1e-3;
  FlowSolver swings = plug({.velocity_in_time = [&](const Vec3d&, double t) {
    return Vec3d{U * std::sin(omega * t), 0, 0};
  }});
  double worst = 0;
  for (int s = 0; s < 400; ++s) {
    swings.step(dt);
    const double exact = -liquid.density * U * omega * std::cos(omega * (swings.time() - 0.5 * dt));
    worst = std::max(worst, std::abs(slope(swings) - exact));
  }
  // Differences over a step instead of the derivative in its middle: (w dt)^2/24 = 4e-5.
  CHECK(worst / (liquid.density * U * omega) < 6e-5);
}

TEST_CASE("Womersley's flow between plates, by its profile at the inlet") {
  const Errors coarse = after_a_period(16, 250), fine = after_a_period(32, 1000);
  MESSAGE("velocity off by ", coarse.velocity, " and ", fine.velocity, ", slope of pressure by ",
          coarse.slope, " and ", fine.slope);
  // Second order, cells of a third and a sixth of the boundary layer sqrt(2 nu/w): half the size, a
  // quarter of the error; 3 and 2.5 of it are asked for, as corners at the inlet are not smooth.
  // Seen: 2.1 and 0.6 %; 0.65 and 0.24 %. An inflow that is a step late is off by w dt = 2.5 %.
  CHECK(coarse.velocity < 0.025);
  CHECK(fine.velocity < coarse.velocity / 3);
  CHECK(coarse.slope < 0.01);
  CHECK(fine.slope < coarse.slope / 2.5);
}

TEST_CASE("a rate that is a function of time is met to rounding, also where it turns") {
  const double R = 0.008;
  const auto Q = [](double t) { return 2e-5 * std::cos(2 * pi * t / 0.2); };
  const auto disc = [&](const Vec3d& x) { return R - std::hypot(x.y - 0.01, x.z - 0.01); };
  for (const bool patch : {false, true}) {
    FlowSolver flow = plug({.rate_in_time = Q});
    if (patch) flow.set_side(0, 0, Inflow{.outline = disc, .rate_in_time = Q});
    for (int s = 0; s < 100; ++s) {
      flow.step(4e-3);
      CHECK(std::abs(flow.flow_rate(0, 0) - Q(flow.time())) <= 1e-14 * 2e-5);
      CHECK(std::abs(flow.flow_rate(0, 20) - Q(flow.time())) <= 1e-7 * 2e-5);
    }
  }
  // A shape is kept.
  FlowSolver flow = plug({.profile =
                              [](const Vec3d& x) {
                                return Vec3d{x.y, 0, 0};
                              },
                          .rate_in_time = Q});
  flow.start();
  CHECK(flow.velocity(0)(0, 3, 1) / flow.velocity(0)(0, 0, 1) == near(7));
  CHECK(near_relative(flow.flow_rate(0, 0), 2e-5, 1e-14));
  // Particles in front of it let as much in.
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) flow.voidage()(0, j, k) = 0.5;
  flow.start();
  CHECK(near_relative(flow.flow_rate(0, 0), 2e-5, 1e-14));
}

TEST_CASE("a patch with a velocity in time has its true area at all times") {
  const double R = 0.008, U = 0.02;
  const auto disc = [&](const Vec3d& x) { return R - std::hypot(x.y - 0.01, x.z - 0.01); };
  FlowSolver flow(Grid({{0, 0, 0}, {0.1, 0.02, 0.02}}, {20, 10, 10}), liquid);
  flow.set_side(0, 1, Outflow{});
  flow.set_side(0, 0, Inflow{.outline = disc, .velocity_in_time = [&](const Vec3d&, double t) {
                               return Vec3d{U * std::sin(2 * pi * t / 0.2), 0, 0};
                             }});
  for (int s = 0; s < 60; ++s) {
    flow.step(4e-3);
    const double exact = pi * R * R * U * std::sin(2 * pi * flow.time() / 0.2);
    // h^2/(700 R^2) of the area, as inflow.cpp has it.
    CHECK(std::abs(flow.flow_rate(0, 0) - exact) <= 1e-4 * pi * R * R * U);
  }
}

TEST_CASE("a function that jumps is a blow in one step and not in the next") {
  // As one that is set does: a pressure that is kept would push back and forth.
  const double dt = 1e-3;
  FlowSolver by_time = plug({.velocity_in_time =
                                 [](const Vec3d&, double t) {
                                   return Vec3d{t > 0.0195 ? 0.04 : 0.01, 0, 0};
                                 }}),
             by_hand = plug({.velocity = {0.01, 0, 0}});
  for (int s = 0; s < 40; ++s) {
    if (s == 19) by_hand.set_side(0, 0, Inflow{.velocity = {0.04, 0, 0}});
    by_time.step(dt), by_hand.step(dt);
    CHECK(slope(by_time) == slope(by_hand));
    const double blow = liquid.density * 0.03 / dt;
    if (s == 19) CHECK(slope(by_time) == doctest::Approx(-blow).epsilon(1e-6));
    if (s > 19) CHECK(std::abs(slope(by_time)) < 1e-6 * blow);
  }
}

TEST_CASE("the stable step knows what is about to flow in") {
  FlowSolver flow = plug({.velocity_in_time = [](const Vec3d&, double t) {
    return Vec3d{100 * t, 0, 0};
  }});
  const double dt = flow.stable_step();
  // Half a cell in a step at most: 100 t t = h/2, within the two times that it looks at.
  CHECK(100 * dt * dt <= 0.5 * 0.005 * (1 + 1e-9));
  CHECK(100 * dt * dt >= 0.1 * 0.005);
}

TEST_CASE("time can be set: after a restart the flow goes on") {
  const auto swing = [](const Vec3d&, double t) {
    return Vec3d{0.02 * std::sin(2 * pi * 5 * t), 0, 0};
  };
  FlowSolver whole = plug({.velocity_in_time = swing}), part = plug({.velocity_in_time = swing});
  for (int s = 0; s < 30; ++s) whole.step(1e-3), part.step(1e-3);
  FlowSolver later = plug({.velocity_in_time = swing});
  std::vector<std::vector<double>> kept;
  part.for_each_state(
      [&](const std::string&, std::span<double> v) { kept.emplace_back(v.begin(), v.end()); });
  std::size_t next = 0;
  later.for_each_state([&](const std::string&, std::span<double> v) {
    std::copy(kept[next].begin(), kept[next].end(), v.begin()), ++next;
  });
  later.set_time(part.time(), 1e-3);
  for (int s = 0; s < 30; ++s) whole.step(1e-3), later.step(1e-3);
  CHECK(whole.velocity(0)(10, 2, 2) == later.velocity(0)(10, 2, 2));
  CHECK(slope(whole) == slope(later));
  CHECK(said_by([&] { later.set_time(std::nan("")); }).find("set_time") != std::string::npos);
}

TEST_CASE("inflows in time that cannot be are refused") {
  const auto steady = [](const Vec3d&, double) { return Vec3d{0.1, 0, 0}; };
  const auto one = [](double) { return 1e-5; };
  const auto refuses = [](const Inflow& in, const char* words) {
    const std::string said = said_by([&] { plug(in); });
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
  };
  refuses({.velocity = {1, 0, 0}, .velocity_in_time = steady}, "give only one");
  refuses({.rate = 1e-5, .velocity_in_time = steady}, "give only one");
  refuses({.velocity_in_time = steady, .rate_in_time = one}, "give only one");
  refuses({.rate = 1e-5, .rate_in_time = one}, "both rate and rate_in_time");
  refuses({.velocity = {-1, 0, 0}, .rate_in_time = one}, "reverse them");
  const auto nowhere = [](const Vec3d&) { return -1.0; };
  refuses({.outline = nowhere, .velocity_in_time = steady}, "has no face");
  // Where a function stops to be a number, the step says when.
  FlowSolver flow = plug({.velocity_in_time = [](const Vec3d&, double t) {
    return Vec3d{t < 0.0105 ? 0.01 : std::nan(""), 0, 0};
  }});
  for (int s = 0; s < 10; ++s) flow.step(1e-3);
  CHECK(said_by([&] { flow.step(1e-3); }).find("at t = 0.011") != std::string::npos);
  FlowSolver rate = plug({.rate_in_time = [](double t) { return t < 1e-3 ? 1e-5 : std::nan(""); }});
  CHECK(said_by([&] { rate.step(2e-3); }).find("rate_in_time is nan") != std::string::npos);
}

}  // namespace inflow_in_time_test
