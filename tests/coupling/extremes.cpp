// silt - BSD-3-Clause, see LICENSE
//
// Couplings at their edges: each either right in a quantity that is known, or stopped by a
// sentence.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace extremes_test {

using silt::FlowSolver;
using silt::Grid;
using silt::Particles;
using silt::Sphere;
using silt::Vec3d;

namespace {

const silt::HertzMindlin::Material glass{2e5, 0.3, 0.5, 0.3};

/// One simulation for all of them: it is compiled once.
auto coupled(Particles<Sphere> grains, FlowSolver flow, double time_step, int steps) {
  const auto& g = flow.grid();
  const silt::PeriodicBox domain{g.box(), {g.periodic(0), g.periodic(1), g.periodic(2)}};
  silt::CoupledFlow fluid{silt::Gidaspow{}, silt::Kernel{}, std::move(flow)};
  fluid.steps = steps;
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass}, domain,
                       std::move(fluid)};
  sim.time_step = time_step, sim.threads = 1;
  return sim;
}

/// n x n x layers grains of diameter d, `pitch` apart, from z on.
Particles<Sphere> lattice(int n, int layers, double pitch, double z, double d, double density,
                          const Vec3d& velocity, bool fixed = false) {
  Particles<Sphere> grains;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        grains.add({.position = {(i + 0.5) * pitch, (j + 0.5) * pitch, z + (k + 0.5) * pitch},
                    .radius = 0.5 * d,
                    .density = density,
                    .velocity = velocity,
                    .fixed = fixed});
  return grains;
}

}  // namespace

TEST_CASE("dense suspension in a viscous liquid, fluid steps of four relaxation times") {
  // By (5) of CoupledFlow; with the pressure of the last step alone the grains' speeds grow from
  // step to step, at r = phi/(1 - phi) > 1/3.
  const double d = 0.5e-3, mu = 0.1, density = 2500, liquid = 1100, phi = 0.45, dt = 2e-5;
  const int n = 6, layers = 14;
  const double pitch = d * std::cbrt(std::acos(-1.0) / 6 / phi), W = n * pitch,
               H = (layers + 2) * pitch;
  const double hindered =
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, 1 - phi, d, density, liquid, mu);
  const double relaxation = hindered / 9.81 * density / (density - liquid);
  auto grains = lattice(n, layers, pitch, pitch, d, density, {0, 0, 0});
  silt::Random random(1);
  for (std::size_t k = 0; k < grains.size(); ++k) {
    const auto shift = [&] { return 0.1 * (pitch - d) * random.uniform(-1, 1); };
    grains[k].position += Vec3d{shift(), shift(), shift()};
  }
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 10}, {true, true, false}), {liquid, mu});
  const int steps = static_cast<int>(std::lround(4 * relaxation / dt));
  auto sim = coupled(std::move(grains), std::move(flow), dt, steps);
  sim.gravity = {0, 0, -9.81};
  sim.run(200 * steps * dt);
  double fall = 0, fastest = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (std::abs(sim.position(k).z / H - 0.5) > 0.25) continue;
    fall -= sim.velocity(k).z, ++count;
    fastest = std::max(fastest, norm(sim.velocity(k)));
  }
  // The lattice loosens as it falls.
  CHECK(fall / static_cast<double>(count) == near(hindered).epsilon(0.1));
  CHECK(fastest < 2 * hindered);
}

TEST_CASE("gas a ten-thousandth as heavy as the grains takes their velocity, and momentum stays") {
  const double d = 1e-3, density = 2500, gas = 0.25, W = 8e-3, speed = 0.5;
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {4, 4, 4}, {true, true, true}), {gas, 1.8e-5},
                  {.tolerance = 1e-10});
  auto sim = coupled(lattice(5, 5, W / 5, 0, d, density, {0, 0, speed}), std::move(flow), 2e-5, 10);
  sim.run(0.1);
  const double M = 125 * density * Sphere::volume(d / 2);
  double p = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) p += sim.mass(k) * sim.velocity(k).z;
  const double due = sim.fluid().time() - sim.time();
  double with_due = p + sim.fluid().flow().momentum().z;
  for (std::size_t k = 0; k < sim.rows(); ++k) with_due += due * sim.fluid_force(k).z;
  const double start = M * speed;
  CHECK(with_due == near(start).epsilon(1e-8));
  const double solids = 125 * Sphere::volume(d / 2) / (W * W * W);
  const double share = gas * (1 - solids) * W * W * W / M;
  CHECK(p / M == near(start / M / (1 + share)).epsilon(1e-8));
  CHECK(sim.fluid().flow().velocity(2)(1, 1, 1) == near(p / M).epsilon(0.01));
}

TEST_CASE(
    "a grain whose slip dies in a millionth of a fluid step falls with its terminal velocity") {
  const double d = 1e-7, density = 1000, mu = 1.8e-5, W = 8e-3, g = 9.81;
  const double tau = density * d * d / (18 * mu), v_t = g * tau * (1 - 1.2 / density);
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {4, 4, 4}, {true, true, false}), {1.2, mu});
  Particles<Sphere> grain;
  grain.add({.position = {W / 2, W / 2, W / 2}, .radius = d / 2, .density = density});
  auto sim = coupled(std::move(grain), std::move(flow), 1e6 * tau, 1);
  sim.gravity = {0, 0, -g};
  sim.guard.max_time_step = 1e12, sim.guard.max_travel = 1e12;  // it meets nobody
  sim.run(20e6 * tau);
  CHECK(sim.velocity(0).z == near(-v_t).epsilon(1e-5));
}

TEST_CASE("cells without any room beside empty ones: the pressure drop is the grains' drag") {
  const double d = 1e-3, W = 8e-3, H = 24e-3, U = 0.2;
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 12}, {true, true, false}), {1.2, 1.8e-5});
  flow.set_side(2, 0, silt::Inflow{{0, 0, U}});
  flow.set_side(2, 1, silt::Outflow{});
  // Grains 0.8 d apart fill more than their space: 102 %.
  auto sim =
      coupled(lattice(10, 10, W / 10, 8e-3, d, 2500, {0, 0, 0}, true), std::move(flow), 2e-5, 10);
  sim.guard.max_overlap = 1;
  sim.run(0.04);
  const auto& done = sim.fluid().last_step();
  CHECK(done.clipped > 0);  // and it says so
  auto& air = sim.fluid().flow();
  CHECK(air.flow_rate(2, 12) == near(U * W * W).epsilon(1e-6));
  // eps dp A = drag, with the voidage that the flow has.
  double pressure = 0, exchanged = 0;
  const double cell = air.grid().cell_volume();
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const double above = k < 11 ? air.pressure()(i, j, k + 1) : 0;
        if (k < 11)
          pressure += 0.5 * (air.voidage()(i, j, k) + air.voidage()(i, j, k + 1)) *
                      (air.pressure()(i, j, k) - above) * W * W / 16;
        exchanged += cell * (air.drag()(i, j, k) * 0.5 *
                                 (air.velocity(2)(i, j, k) + air.velocity(2)(i, j, k + 1)) -
                             air.drag_velocity(2)(i, j, k));
      }
  CHECK(pressure == near(exchanged).epsilon(0.01));  // and the gas's inertia
}

TEST_CASE("an inlet that jumps to 100 times its velocity: the flow follows, or the run stops") {
  const double W = 8e-3, H = 24e-3, U = 0.02;
  const auto jump = [&](int steps) {
    FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 12}, {true, true, false}), {1.2, 1.8e-5});
    flow.set_side(2, 0, silt::Inflow{{0, 0, U}});
    flow.set_side(2, 1, silt::Outflow{});
    auto sim =
        coupled(lattice(6, 6, W / 6, 8e-3, 1e-3, 2500, {0, 0, 0}), std::move(flow), 2e-5, steps);
    sim.run(0.01);
    const double before = sim.fluid().flow().flow_rate(2, 12);
    CHECK(before == near(U * W * W).epsilon(1e-5));
    sim.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, 100 * U}});
    sim.run(0.012);
    CHECK(sim.fluid().flow().flow_rate(2, 0) == near(100 * U * W * W).epsilon(1e-9));
    // Grains move, so that the gas they leave room to goes elsewhere.
    CHECK(sim.fluid().flow().flow_rate(2, 12) == near(100 * U * W * W).epsilon(0.02));
    for (std::size_t k = 0; k < sim.rows(); ++k) CHECK(sim.velocity(k).z < 100 * U);
  };
  jump(10);  // 0.2 cells a step
  // The step after it would cross four cells.
  CHECK_THROWS_WITH_AS(jump(200), doctest::Contains("crosses"), silt::SimulationError);
}

TEST_CASE("a coupled flow warns of what it cannot hold, of grains in its walls, of odd units") {
  // All of these ran without a word: a grain larger than the flow fell as in a vacuum, grains
  // within a cylinder whose outside is the flow had no drag.
  const double W = 12e-3, H = 24e-3;
  double step = 5e-5;  // [s]
  const auto told = [&](const silt::FluidProperties& fluid, double radius, const auto& prepare) {
    FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {6, 6, 12}), fluid);
    flow.set_side(2, 1, silt::Outflow{});
    prepare(flow);
    Particles<Sphere> grains;
    grains.add({.position = {6e-3, 6e-3, 12e-3}, .radius = radius, .density = 1500});
    silt::CoupledFlow gas{silt::Gidaspow{}, silt::Kernel{}, std::move(flow)};
    silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                         std::move(gas)};
    sim.gravity = {0, 0, -9.81}, sim.time_step = step;
    std::string all;
    int count = 0;
    sim.run(20 * step, silt::on_warnings([&](const std::string& w) { all += w + '\n', ++count; }));
    CHECK(count == (all.empty() ? 0 : 1));  // not again at the end
    return all;
  };
  const silt::FluidProperties air{1.2, 1.8e-5};
  const auto nothing = [](FlowSolver&) {};
  CHECK(told(air, 0.5e-3, nothing).empty());
  CHECK(told({998, 1e-3}, 0.5e-3, nothing).empty());
  CHECK(silt_test::has(told(air, 15e-3, nothing), "more than 50 % of the particles' volume"));
  const auto tube = [](silt::Side side) {
    return [side](FlowSolver& flow) {
      flow.set_boundary(
          silt::boundary_of(silt::Cylinder{{6e-3, 6e-3, -1}, {6e-3, 6e-3, 2}, 5e-3, side}));
    };
  };
  CHECK(told(air, 0.5e-3, tube(silt::Side::Inside)).empty());
  CHECK(silt_test::has(told(air, 0.5e-3, tube(silt::Side::Outside)),
                       "1 of 1 particles start with their centres in walls of the flow"));
  CHECK(silt_test::has(told({998, 1e-6}, 0.5e-3, nothing), "is a kinematic viscosity of 1.00"));
  CHECK(silt_test::has(told({1, 1e-3}, 0.5e-3, nothing), "is neither a gas nor a liquid"));
  CHECK(silt_test::has(told({1.2e-3, 1e-6}, 0.5e-3, nothing), "density in g/cm3"));
  const auto blown = [](double speed) {
    return [=](FlowSolver& flow) { flow.set_side(2, 0, silt::Inflow{{0, 0, speed}}); };
  };
  CHECK(told(air, 0.5e-3, blown(0.5)).empty());
  step = 5e-7;
  CHECK(silt_test::has(told({0.6, 1.8e-5}, 0.5e-3, blown(400)), "beyond the speed of sound"));
  CHECK(silt_test::has(told(air, 3e-6, nothing), "333 times the diameter of the largest particle"));
  step = 5e-5;
  const auto heated = [](double capacity, double temperature) {
    return [=](FlowSolver& flow) {
      flow.set_heat(
          {.heat_capacity = capacity, .conductivity = 0.026, .start_temperature = temperature});
    };
  };
  CHECK(told(air, 0.5e-3, heated(1005, 300)).empty());
  CHECK(silt_test::has(told(air, 0.5e-3, heated(1005, 20)), "20 C is 293.15 K"));
  CHECK(silt_test::has(told(air, 0.5e-3, heated(1.005, 300)), "less than any fluid has"));
}

namespace {
/// As in docs/fluid.md.
struct MeanPressure {
  Vec3d gradient;  // [N/m3]
  Vec3d force_on(const silt::InFluid& at) const { return at.volume * gradient; }
};
/// Ergun's gradient [Pa/m] at the velocity of a periodic bed of fixed grains that force(2) drives.
template <class... Forces>
double driven_bed(silt::MomentumModel model, double push, const Forces&... forces) {
  const double W = 0.012, d = 1e-3;
  FlowSolver air(Grid({{0, 0, 0}, {W, W, W}}, {6, 6, 6}, {true, true, true}), {1.2, 1.8e-5},
                 {.model = model});
  air.force(2).fill(push);
  silt::CoupledFlow gas{silt::Ergun{}, silt::Kernel{.width = 4}, std::move(air), forces...};
  silt::Simulation sim{
      lattice(8, 8, W / 8, 0, d, 2500, {0, 0, 0}, true), silt::Contacts<silt::HertzMindlin>{glass},
      silt::PeriodicBox{{{0, 0, 0}, {W, W, W}}, {true, true, true}}, std::move(gas)};
  sim.time_step = 2e-5;
  sim.run(0.3);
  double carried = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) carried += sim.fluid_force(k).z;
  CHECK(carried == near(push * W * W * W).epsilon(1e-3));  // all of it ends at the grains
  const double eps = 1 - 512 * (std::numbers::pi / 6 * d * d * d) / (W * W * W);
  return silt::ergun_pressure_gradient(eps, d, 1.2, 1.8e-5,
                                       sim.fluid().flow().flow_rate(2, 0) / (W * W));
}
}  // namespace

TEST_CASE("force(d) stays as set: a mean pressure gradient in model B, in A with its own force") {
  // Without that force grains of model A feel the gradient by their drag alone, which is then 1/eps
  // too high: 71.0 Pa/m.
  CHECK(driven_bed(silt::MomentumModel::B, 60) == near(60).epsilon(1e-3));
  CHECK(driven_bed(silt::MomentumModel::A, 60, MeanPressure{{0, 0, 60}}) == near(60).epsilon(1e-3));
  CHECK(driven_bed(silt::MomentumModel::A, 60) == near(60 / 0.8449).epsilon(1e-3));
}

}  // namespace extremes_test
