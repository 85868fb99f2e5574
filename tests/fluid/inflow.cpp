// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include "near.hpp"

#include <silt/fluid/boundary_of.hpp>
#include <silt/fluid/flow_solver.hpp>

namespace inflow_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Inflow;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;
constexpr silt::FluidProperties liquid{1000, 0.01};

/// A round pipe along z whose axis is askew to the cells.
constexpr double R = 0.01, x_axis = 0.0007, y_axis = -0.0003;
double to_pipe(const Vec3d& x) { return R - std::hypot(x.x - x_axis, x.y - y_axis); }

Grid cells(int n) { return Grid({{-0.012, -0.012, 0}, {0.012, 0.012, 0.012}}, {n, n, n / 2}); }

/// How far a value is from what it should be, over that.
double off(double value, double expected) { return std::abs(value / expected - 1); }

/// [m3/s] into the lower side in z, as it is set.
double rate_of(FlowSolver& flow) {
  flow.start();
  return flow.flow_rate(2, 0);
}
double rate_of(const Inflow& inflow, int n) {
  FlowSolver flow(cells(n), liquid);
  flow.set_side(2, 0, inflow), flow.set_side(2, 1, silt::Outflow{});
  return rate_of(flow);
}

}  // namespace

TEST_CASE("an inflow of a given rate lets in just that much, whichever faces are open") {
  const double Q = 3e-5;  // [m3/s]
  const auto parabola = [](const Vec3d& x) {
    return Vec3d{0, 0, 1 - std::pow((R - to_pipe(x)) / R, 2)};
  };
  const auto pipe = silt::boundary_of(
      silt::Cylinder{{x_axis, y_axis, -1}, {x_axis, y_axis, 1}, R, silt::Side::Inside});
  for (const int n : {6, 11, 16})
    for (const bool walls_first : {true, false}) {
      FlowSolver flow(cells(n), liquid, {.tolerance = 1e-10});
      if (walls_first) flow.set_boundary(pipe);
      flow.set_side(2, 0, Inflow{.profile = parabola, .rate = Q});
      flow.set_side(2, 1, silt::Outflow{});
      if (!walls_first) flow.set_boundary(pipe);
      CHECK(off(rate_of(flow), Q) <= 1e-14);
      // The shape is the profile's.
      const double across = 0.024 / n, x = -0.012 + (n / 2 + 0.5) * across,
                   y = -0.012 + (n / 2 - 0.5) * across;
      CHECK(flow.velocity(2)(n / 2, n / 2 - 1, 0) / flow.velocity(2)(n / 2 - 1, n / 2 - 1, 0) ==
            near(parabola({x, y, 0}).z / parabola({x - across, y, 0}).z));
      // Particles in front of it let as much in, and all of it goes out.
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) flow.voidage()(i, j, 0) = flow.voidage()(i, j, 1) = 0.5;
      flow.start();
      for (int s = 0; s < 3; ++s) flow.step(0.5 * flow.stable_step());
      CHECK(off(flow.flow_rate(2, 0), Q) <= 1e-14);
      CHECK(off(flow.flow_rate(2, n / 2), Q) <= 1e-8);
      // Faster, and as set then.
      flow.set_side(2, 0, Inflow{.profile = parabola, .rate = 2 * Q});
      flow.step(0.2 * flow.stable_step());
      CHECK(off(flow.flow_rate(2, 0), 2 * Q) <= 1e-14);
    }
}

TEST_CASE("a rate alone flows straight in, or out") {
  for (int d = 0; d < 3; ++d)
    for (const int end : {0, 1})
      for (const double Q : {2e-5, -2e-5}) {
        FlowSolver flow(Grid({{0, 0, 0}, {0.02, 0.03, 0.04}}, {4, 5, 6}), liquid);
        flow.set_side(d, end, Inflow{.rate = Q}), flow.set_side(d, 1 - end, silt::Outflow{});
        flow.start();
        const int last = flow.grid().cells()[static_cast<std::size_t>(d)];
        CHECK(off(flow.flow_rate(d, end * last), end == 0 ? Q : -Q) <= 1e-14);
      }
}

TEST_CASE("a patch lets in its velocity times its true area, and is a wall elsewhere") {
  const double U = 0.1, area = pi * R * R;
  double worst = 0;
  for (const int n : {6, 8, 11, 16, 24}) {
    // Chords of h/16 and less instead of the arc: second order.
    const double h = 0.024 / n, bound = h * h / (700 * R * R);
    const double rate = rate_of({.velocity = {0, 0, U}, .outline = to_pipe}, n);
    CHECK(off(rate, U * area) <= bound);
    // By the parabola of Poiseuille's flow, of mean U: the same, and steps of h/16 in it.
    const auto parabola = [&](const Vec3d& x) {
      return Vec3d{0, 0, 2 * U * (1 - std::pow((R - to_pipe(x)) / R, 2))};
    };
    CHECK(off(rate_of({.profile = parabola, .outline = to_pipe}, n), U * area) <= 2 * bound);
    // What faces alone would give.
    const auto bare = [&](const Vec3d& x) { return Vec3d{0, 0, to_pipe(x) > 0 ? U : 0}; };
    worst = std::max(worst, std::abs(rate_of({.profile = bare}, n) / (U * area) - 1));
  }
  CHECK(worst > 0.03);
  // A straight edge, askew in the cells, is exact; corners are not.
  const auto half = [](const Vec3d& x) { return 0.6 * x.x + 0.8 * x.y; };
  CHECK(off(rate_of({.velocity = {0, 0, U}, .outline = half}, 7), U * 0.5 * 0.024 * 0.024) <=
        1e-12);

  FlowSolver flow(cells(11), liquid);
  flow.set_side(2, 1, silt::Outflow{});
  flow.set_side(2, 0, Inflow{.velocity = {0, 0, U}, .outline = to_pipe});
  flow.start();
  for (int s = 0; s < 3; ++s) flow.step(0.3 * flow.stable_step());
  const double within = flow.velocity(2)(5, 5, 0);
  CHECK(off(within, U) <= 0.05);
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i) {
      const bool open = to_pipe(flow.grid().centre(i, j, 0)) > 0;
      CHECK(flow.velocity(2)(i, j, 0) == (open ? within : 0));
    }
}

TEST_CASE("an inflow into a pipe passes its true area") {
  for (const int n : {6, 8, 11, 16, 24}) {
    FlowSolver flow(cells(n), liquid);
    flow.set_boundary({.distance = to_pipe});
    flow.set_side(2, 0, Inflow{.velocity = {0, 0, 0.1}}), flow.set_side(2, 1, silt::Outflow{});
    // Chords of h/4 and less instead of the arc.
    const double h = 0.024 / n;
    CHECK(off(rate_of(flow), 0.1 * pi * R * R) <= h * h / (44 * R * R));
  }
}

TEST_CASE("walls cut a patch: half of a pipe's end, and all of it by the walls' own distance") {
  const double U = 0.1;
  const silt::FlowBoundary pipe{.distance = to_pipe};
  for (const bool half : {true, false}) {
    FlowSolver flow(cells(16), liquid);
    flow.set_side(2, 1, silt::Outflow{});
    const auto left = [](const Vec3d& x) { return x_axis - x.x; };
    flow.set_side(2, 0,
                  half ? Inflow{.velocity = {0, 0, U}, .outline = left}
                       : Inflow{.velocity = {0, 0, U}, .outline = pipe.distance});
    flow.set_boundary(pipe);
    // Corners of the half disc besides, where two edges meet in one piece of h/16.
    CHECK(off(rate_of(flow), (half ? 0.5 : 1) * U * pi * R * R) <= 1e-4);
  }
}

TEST_CASE("inflows that cannot be are refused") {
  const auto refuses = [](const Inflow& inflow, const char* words) {
    FlowSolver flow(cells(6), liquid);
    std::string said;
    try {
      flow.set_side(2, 0, inflow);
    } catch (const silt::InputError& e) {
      said = e.what();
    }
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
  };
  refuses({.rate = std::nan("")}, "Inflow.rate");
  refuses({.velocity = {0, 0, std::nan("")}},
          "the lower side in z is given the velocity nan m/s in z");
  refuses({.velocity = {0.5, 0, 0}}, "lies along that side and brings no fluid");  // was accepted
  refuses({.outline = [](const Vec3d&) { return std::nan(""); }}, "Inflow.outline is not a number");
  refuses({.velocity = {0, 0, 1}, .outline = [](const Vec3d&) { return -1.0; }}, "has no face");
  refuses({.velocity = {0, 0, -1}, .rate = 1e-5}, "reverse them");
  refuses({.velocity = {1, 0, 0}, .rate = 1e-5}, "reverse them");
  refuses({.profile =
               [](const Vec3d& x) {
                 return Vec3d{0, 0, x.x};
               },
           .rate = 1e-5},
          "let in");  // in and out alike
  // Walls that leave no face: the boundary is refused, and the flow is as before.
  FlowSolver flow(cells(6), liquid);
  flow.set_side(2, 1, silt::Outflow{});
  flow.set_side(2, 0, Inflow{.rate = 1e-5});
  CHECK_THROWS_AS(flow.set_boundary({.distance = [](const Vec3d& x) { return x.z - 0.001; }}),
                  silt::InputError);
  CHECK(off(rate_of(flow), 1e-5) <= 1e-14);
  // A velocity alone was accepted there, and nothing flowed.
  FlowSolver closed(cells(6), liquid);
  closed.set_side(2, 0, Inflow{.velocity = {0, 0, 1}});
  std::string said;
  try {
    closed.set_boundary({.distance = [](const Vec3d& x) { return x.z - 0.001; }});
  } catch (const silt::InputError& e) {
    said = e.what();
  }
  CHECK(said.find("the lower side in z is all in walls of the FlowBoundary") != said.npos);
}

}  // namespace inflow_test
