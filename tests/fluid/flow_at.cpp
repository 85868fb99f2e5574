// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include <silt/core/random.hpp>
#include <silt/fluid/flow_at.hpp>
#include <silt/fluid/flow_solver.hpp>

#include "near.hpp"

namespace flow_at_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Vec3d;

namespace {

constexpr silt::FluidProperties liquid{1000, 0.01};
double component(const Vec3d& v, int d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }

struct Linear {
  double at_origin;
  Vec3d slope;
  double operator()(const Vec3d& x) const { return at_origin + dot(slope, x); }
};
constexpr Linear p{3, {700, -200, 90}}, eps{0.5, {3, -4, 2}},
    u[3] = {{0.1, {2, -3, 4}}, {-0.2, {1, 5, -2}}, {0.3, {-6, 1, 2}}};

/// All fields linear, ghosts too.
void set_linear(FlowSolver& flow) {
  const Grid& g = flow.grid();
  constexpr int o = Grid::ghost;
  for (int k = -o; k < g.nz() + o; ++k)
    for (int j = -o; j < g.ny() + o; ++j)
      for (int i = -o; i < g.nx() + o; ++i) {
        const Vec3d x = g.centre(i, j, k), h = g.h();
        flow.pressure()(i, j, k) = p(x), flow.voidage()(i, j, k) = eps(x);
        for (int d = 0; d < 3; ++d) {
          const Vec3d back{d == 0 ? h.x / 2 : 0, d == 1 ? h.y / 2 : 0, d == 2 ? h.z / 2 : 0};
          flow.velocity(d)(i, j, k) = u[d](x - back);
        }
      }
}
/// The largest errors of velocity [m/s], pressure [Pa] and voidage at places in `box`.
std::array<double, 3> errors(const FlowSolver& flow, const silt::Box& box) {
  silt::Random random(7);
  std::array<double, 3> worst{};
  for (int n = 0; n < 2000; ++n) {
    const Vec3d e = box.extent(),
                x = box.min +
                    Vec3d{e.x * random.uniform(), e.y * random.uniform(), e.z * random.uniform()};
    const silt::FlowValues at = silt::flow_at(flow, x);
    for (int d = 0; d < 3; ++d)
      worst[0] = std::max(worst[0], std::abs(component(at.velocity, d) - u[d](x)));
    worst[1] = std::max(worst[1], std::abs(at.pressure - p(x)));
    worst[2] = std::max(worst[2], std::abs(at.voidage - eps(x)));
  }
  return worst;
}
std::string said_by(const auto& action) {
  try {
    action();
  } catch (const silt::InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace

TEST_CASE("flow_at is exact for linear fields, up to the sides") {
  // Catches values taken half a cell off (an error of h/2 times the slope: 2 Pa, 0.01 m/s).
  FlowSolver flow(Grid({{-0.02, 0, 0.01}, {0.02, 0.03, 0.06}}, {5, 6, 4}), liquid);
  set_linear(flow);
  const auto worst = errors(flow, flow.grid().box());
  CHECK(worst[0] < 1e-14);
  CHECK(worst[1] < 1e-12);
  CHECK(worst[2] < 1e-14);
}

TEST_CASE("flow_at beside walls in the box takes cells with fluid alone") {
  FlowSolver flow(Grid({{-0.02, -0.02, 0}, {0.02, 0.02, 0.04}}, {16, 16, 4}), liquid);
  const auto pipe = [](const Vec3d& x) { return 0.013 - std::hypot(x.x, x.y); };
  flow.set_boundary({.distance = pipe});
  set_linear(flow);
  for (int k = 0; k < 4; ++k)  // what stands in closed cells must not be read
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i)
        if ((*flow.open_cells())(i, j, k) == 0) flow.pressure()(i, j, k) = 1e9;
  double worst = 0;
  for (int n = 0; n < 360; ++n) {
    const double a = n * 0.0174532925;
    for (const double r : {0.013, 0.0128, 0.011, 0.004}) {  // taps in the wall, and inside
      const Vec3d x{r * std::cos(a), r * std::sin(a), 0.017};
      worst = std::max(worst, std::abs(silt::flow_at(flow, x).pressure - p(x)));
    }
  }
  CHECK(worst < 1e-11);
  CHECK(!silt::has_fluid_at(flow, {0.0199, 0.0199, 0.02}));
  CHECK(said_by([&] {
          silt::flow_at(flow, {0.0199, 0.0199, 0.02});
        }).find("within a wall") != std::string::npos);
  // The ring of taps: the mean of a linear pressure is that at the axis.
  CHECK(silt::mean_pressure_across(flow, 2, 0.017) == near(p({0, 0, 0.017})).epsilon(1e-9));
}

TEST_CASE("flow_at in periodic directions wraps") {
  FlowSolver flow(Grid({{0, 0, 0}, {0.04, 0.03, 0.02}}, {8, 6, 1}, {true, false, true}), liquid);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i)
      flow.pressure()(i, j, 0) = std::sin(2 * 3.14159265358979 * (i + 0.5) / 8);
  const double inside = silt::flow_at(flow, {0.0399, 0.01, 0.005}).pressure;
  CHECK(silt::flow_at(flow, {-0.0001, 0.01, 0.005}).pressure == near(inside).epsilon(1e-9));
  CHECK(silt::flow_at(flow, {0.0799, 0.01, 0.025}).pressure == near(inside).epsilon(1e-9));
  // Between the last cell and the first the sine goes through 0.
  CHECK(std::abs(silt::flow_at(flow, {0.04, 0.01, 0.005}).pressure) < 1e-12);
  CHECK(said_by([&] {
          silt::flow_at(flow, {0.01, 0.031, 0});
        }).find("outside the flow's box") != std::string::npos);
  CHECK(said_by([&] { silt::mean_pressure_across(flow, 1, 0.04); }).find("outside") !=
        std::string::npos);
  CHECK(said_by([&] { silt::mean_pressure_across(flow, 3, 0); }).find("direction 3") !=
        std::string::npos);
}

TEST_CASE("flow_at meets a side's velocity, and the weight of the fluid is its column") {
  FlowSolver flow(Grid({{0, 0, 0}, {0.04, 0.03, 0.02}}, {8, 6, 4}, {true, false, true}), liquid);
  flow.set_side(1, 1, silt::NoSlip{{0.2, 0, 0}});
  flow.velocity(0).fill(0.1);
  flow.start();
  CHECK(silt::flow_at(flow, {0.02, 0.03, 0.01}).velocity.x == near(0.2));
  CHECK(std::abs(silt::flow_at(flow, {0.02, 0, 0.01}).velocity.x) < 1e-15);
  const silt::FluidWeight weight{{0, 0, -9.81}, {0, 0, 0.02}};
  CHECK(weight.pressure(1000, {0.3, 0.1, 0.015}) == near(1000 * 9.81 * 0.005));
}

}  // namespace flow_at_test
