// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace simulation_test {

using silt::Contacts;
using silt::CoupledFlow;
using silt::FlowSolver;
using silt::Grid;
using silt::HertzMindlin;
using silt::Particles;
using silt::Simulation;
using silt::Sphere;
using silt::Vec3d;

namespace {

const HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};

// Two couplings and few simulations: each is a program of its own to the compiler.
auto slow(const FlowSolver& flow) {
  return CoupledFlow{silt::Stokes{}, silt::Kernel{}, flow, silt::SpinLift{}};
}
auto rich(const FlowSolver& flow) {
  return CoupledFlow{silt::DiFelice{},   silt::Kernel{},   flow,
                     silt::ShearLift{},  silt::SpinLift{}, silt::SpinTorque{},
                     silt::VirtualMass{}};
}

/// Grains in a box of gas that blows upwards between periodic sides.
template <class... More>
auto blown(std::size_t count, int threads, double up, double time_step, const More&... more) {
  const double width = 8e-3, height = 24e-3;
  FlowSolver flow(Grid({{0, 0, 0}, {width, width, height}}, {4, 4, 12}, {true, true, false}),
                  {1.2, 1.8e-5});
  flow.set_side(2, 0, silt::Inflow{{0, 0, up}});
  flow.set_side(2, 1, silt::Outflow{});
  Particles<Sphere> grains;
  grains.fill({.min = {0, 0, 1e-3}, .max = {width, width, 0.6 * height}},
              {.radius = silt::uniform(0.4e-3, 0.6e-3), .density = 1500, .count = count});
  Simulation sim{std::move(grains), Contacts<HertzMindlin>{glass},
                 silt::PeriodicBox{{{0, 0, 0}, {width, width, height}}, {true, true, false}},
                 rich(flow), more...};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step;
  sim.threads = threads;
  return sim;
}

/// Mean pressure at the inflow [Pa].
template <class Sim>
double low(const Sim& sim) {
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) sum += sim.fluid().flow().pressure()(i, j, 0) / 16;
  return sum;
}
/// The largest change of low() from now on, in so many steps [Pa].
template <class Sim>
double largest_change(Sim& sim, int steps) {
  const double before = low(sim);
  double most = 0;
  for (int k = 0; k < steps; ++k) {
    sim.run(sim.step_length());
    most = std::max(most, std::abs(low(sim) - before));
  }
  return most;
}
/// 36 grains of 1 mm beside one another at the height z [m], each a little higher if `staggered`.
Particles<Sphere> layer(double z, double speed, bool staggered = false) {
  Particles<Sphere> grains;
  for (int k = 0; k < 36; ++k)
    grains.add({.position = {1e-3 + 1.2e-3 * (k % 6), 1e-3 + 1.2e-3 * (k / 6),
                             z + (staggered ? 1e-4 * (7 * k % 36) : 0)},
                .radius = 0.5e-3,
                .density = 1500,
                .velocity = {0, 0, speed}});
  return grains;
}

}  // namespace

// Catches grains whose volume drives the gas out in one step: 14 Pa here.
TEST_CASE("grains that are put into a gas do not make its pressure jump") {
  auto sim = blown(100, 1, 1, 2e-5);
  sim.run(0.02);
  sim.add(layer(18e-3, 1));
  // What is left: drag and weight of the grains on the gas, and its changed fluxes around them.
  CHECK(largest_change(sim, 50) < 3);
}

// Catches grains whose place the gas fills in one step: 90 Pa here.
TEST_CASE("grains that leave a gas do not make its pressure jump") {
  for (const bool by_outlet : {false, true}) {
    CAPTURE(by_outlet);
    auto sim = blown(300, 1, 1, 2e-5);
    sim.run(0.02);
    const double before = low(sim);
    const std::size_t all = sim.size();
    if (by_outlet) {
      sim.add_outlet({{-1, -1, 6e-3}, {1, 1, 1}});
    } else {
      std::vector<silt::ParticleId> gone;
      for (std::size_t k = 0; k < sim.rows(); ++k)
        if (sim.is_present(k) && sim.position(k).z > 6e-3) gone.push_back(sim.id(k));
      for (const silt::ParticleId id : gone) sim.remove(id);
    }
    double least = before, most = before;  // [Pa]
    for (int k = 0; k < 200; ++k) {
      sim.run(sim.step_length());
      least = std::min(least, low(sim)), most = std::max(most, low(sim));
    }
    CHECK(sim.size() < all - 30);
    CHECK(low(sim) < before);
    // What is left: the drag of those that have left, and the changed fluxes around their places.
    CHECK(most < before + 1);
    CHECK(least > low(sim) - 3);
  }
}

// Catches volume that is in the flow at one step and out of it at the next: 2.4 and 3 Pa here.
TEST_CASE("grains that pass a side of the grid do not make the pressure jump") {
  for (const double speed : {2.0, -2.0}) {  // [m/s] out, and in from above
    CAPTURE(speed);
    auto sim = blown(100, 1, 1, 2e-5);
    sim.add(layer(speed > 0 ? 21e-3 : 27e-3, speed, true));
    sim.fluid().steps = 5;
    sim.run(0.6e-3);
    double most = 0;  // [Pa] in a step
    while (sim.time() < 4e-3) most = std::max(most, largest_change(sim, 1));
    CHECK((sim.position(sim.find(100)).z > 24.5e-3) == (speed > 0));
    // What is left: the drag of those that pass, which begins or ends with them.
    CHECK(most < 0.6);
  }
}

// Catches a volume that is given to the flow, or taken from it, in one step: 210 and 327 Pa here.
TEST_CASE("grains that change their radius in a gas do not make its pressure jump") {
  for (const double to : {0.4e-3, 0.6e-3}) {
    CAPTURE(to);
    auto sim = blown(1, 1, 1, 2e-5);
    sim.add(layer(12e-3, 0));
    sim.fluid().steps = 5;
    sim.run(1e-3);
    for (silt::ParticleId id = 1; id <= 36; ++id) sim.set_radius(id, to);
    // What is left: the drag of other radii, and the changed fluxes around them.
    CHECK(largest_change(sim, 20) < 4);
    CHECK(sim.radius(sim.find(5)) == to);
  }
}

// Catches a change of solids that is found with the clipped sum of old and new.
TEST_CASE("grains of a dense bed that are replaced within a fluid step change nothing") {
  auto sim = blown(1, 1, 0.3, 2e-5);
  sim.gravity = {0, 0, 0};
  Particles<Sphere> lattice;
  for (int k = 0; k < 512; ++k)
    lattice.add({.position = {0.5e-3 + 1e-3 * (k % 8), 0.5e-3 + 1e-3 * (k / 8 % 8),
                              0.015 + 1e-3 * (k / 64)},
                 .radius = 0.499e-3,
                 .density = 1500});
  sim.add(lattice);
  sim.fluid().steps = 5;
  sim.run(2e-3);
  for (silt::ParticleId id = 1; id <= 512; ++id) sim.remove(id);
  sim.add(lattice);
  // What is left: where the old ones had come in 2 ms, and their velocities; 0.75 Pa (computed).
  CHECK(largest_change(sim, 20) < 2);
}

TEST_CASE("a gas that all grains have left has its void fraction after a restart too") {
  const std::string file = (std::filesystem::temp_directory_path() / "silt_gone.silt").string();
  auto sim = blown(100, 1, 1, 2e-5);
  sim.fluid().steps = 5;
  sim.run(0.002);
  for (silt::ParticleId id = 0; id < 100; ++id) sim.remove(id);
  silt::save_checkpoint(sim, file);
  sim.run(0.002);
  auto again = blown(100, 1, 1, 2e-5);
  again.fluid().steps = 5;
  silt::load_checkpoint(again, file);
  again.run(0.002);
  std::filesystem::remove(file);
  for (int k = 0; k < 12; ++k) {
    CHECK(again.fluid().flow().voidage()(1, 2, k) == 1);
    CHECK(again.fluid().flow().pressure()(1, 2, k) == sim.fluid().flow().pressure()(1, 2, k));
  }
}

TEST_CASE("a fluid step that failed can be made again, shorter, as if it had not been tried") {
  // Catches volume that has come or gone and is taken into account twice.
  double pressure[2];
  for (const bool fails : {false, true}) {
    auto sim = blown(100, 1, 1, 2e-5);
    sim.fluid().steps = 5;
    sim.run(0.002);
    Particles<Sphere> more;
    more.add({.position = {4e-3, 4e-3, 20e-3}, .radius = 1e-3, .density = 1500});
    sim.add(more);
    for (const silt::ParticleId id : {3, 5, 7}) sim.remove(id);
    if (fails) {
      sim.fluid().steps = 500;
      CHECK_THROWS_AS(sim.run(0.002), silt::SimulationError);
    }
    sim.fluid().steps = 5;
    sim.run(0.00401 - sim.time());
    pressure[fails] = sim.fluid().flow().pressure()(1, 2, 4);
  }
  CHECK(pressure[0] == pressure[1]);
}

TEST_CASE("a checkpoint knows the grains that have left since the last fluid step") {
  const std::string file = (std::filesystem::temp_directory_path() / "silt_left.silt").string();
  auto sim = blown(100, 1, 1, 2e-5);
  sim.fluid().steps = 20;
  sim.run(0.0041);  // half a fluid step
  const double fluid = sim.fluid().time();
  for (const silt::ParticleId id : {3, 5, 7}) sim.remove(id);
  silt::save_checkpoint(sim, file);
  sim.run(0.002);
  CHECK(sim.fluid().time() > fluid);
  auto again = blown(100, 3, 1, 2e-5);
  again.fluid().steps = 20;
  silt::load_checkpoint(again, file);
  again.run(0.002);
  std::filesystem::remove(file);
  for (int k = 0; k < 12; ++k)
    CHECK(again.fluid().flow().pressure()(1, 2, k) == sim.fluid().flow().pressure()(1, 2, k));
  for (const silt::ParticleId id : {0, 50, 99})
    CHECK(again.position(again.find(id)) == sim.position(sim.find(id)));
}

TEST_CASE("a grain dropped into a gas that rises follows its exact solution") {
  // Stokes drag: v(t) = u - v_t - (u - v_t - v0) exp(-t/tau), v_t = g tau (1 - rho/rho_p).
  const double d = 60e-6, rho = 2500, mu = 1.8e-5, up = 0.5, g = 9.81;
  const double tau = rho * d * d / (18 * mu), fall = g * tau * (1 - 1.2 / rho);
  // In a box so wide that the grain does not move the gas.
  FlowSolver flow(Grid({{0, 0, 0}, {0.01, 0.01, 0.04}}, {5, 5, 20}, {true, true, false}),
                  {1.2, mu});
  flow.set_side(2, 0, silt::Inflow{{0, 0, up}});
  flow.set_side(2, 1, silt::Outflow{});
  flow.velocity(2).fill(up);
  for (const double steps_per_tau : {20.0, 1.0, 0.05}) {  // the last one is stiff
    Particles<Sphere> grain;
    grain.add({.position = {5e-3, 5e-3, 0.01}, .radius = 0.5 * d, .density = rho});
    auto air = slow(flow);
    const double span = tau / steps_per_tau;  // a fluid step
    air.steps = 10;
    Simulation sim{std::move(grain), Contacts<HertzMindlin>{glass}, air};
    sim.gravity = {0, 0, -g};
    sim.time_step = span / 10;
    sim.guard.max_time_step = 1e9;  // it meets nobody
    CAPTURE(steps_per_tau);
    if (span > 0.3 * 2e-3 / up) {
      // The gas itself would cross cells in a step: refused, and the step before stays.
      CHECK_THROWS_AS(sim.run(2 * tau), silt::SimulationError);
      continue;
    }
    // At the end of a fluid step velocities are those of half a step ago.
    sim.run(4 * tau);
    const double t = sim.time();
    const double exact = up - fall - (up - fall) * std::exp(-t / tau);
    // Leapfrog begins with half a step of the first force: half a step of the fall, decaying.
    const double first = 0.5 * sim.step_length() / tau * up * std::exp(-t / tau);
    CHECK(sim.velocity(0).z == near(exact).epsilon(1e-4 + first / exact));
  }
}

TEST_CASE("a fixed bed in a Simulation has its drag law's pressure drop") {
  const double d = 1e-3, a = 1.02 * d, U = 0.4;
  const int across = 8, layers = 16;
  const double width = across * a, height = 3 * layers * a;
  FlowSolver flow(Grid({{0, 0, 0}, {width, width, height}}, {4, 4, 24}, {true, true, false}),
                  {1.2, 1.8e-5});
  flow.set_side(2, 0, silt::Inflow{{0, 0, U}});
  flow.set_side(2, 1, silt::Outflow{});
  Particles<Sphere> bed;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        bed.add({.position = {(i + 0.5) * a, (j + 0.5) * a, (layers + k + 0.5) * a},
                 .radius = 0.5 * d,
                 .density = 2500,
                 .fixed = true});
  Simulation sim{std::move(bed), Contacts<HertzMindlin>{glass}, slow(flow)};
  sim.time_step = 2e-5;
  sim.run(0.03);
  const auto& p = sim.fluid().flow().pressure();
  double low = 0, high = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) low += p(i, j, 10) / 16, high += p(i, j, 13) / 16;
  const double eps = 1 - std::numbers::pi / 6 * d * d * d / (a * a * a);
  // eps grad p = beta U/eps, and Stokes' law does not depend on Re.
  const double beta = silt::interphase_coefficient(silt::Stokes{}, eps, 1.0, d, 1.8e-5);
  const double expected = beta * U / (eps * eps);
  CHECK((low - high) / (3 * height / 24) == near(expected).epsilon(0.02));
  CHECK(sim.velocity(0).z == 0);
  CHECK(sim.fluid_force(0).z > 0);
}

TEST_CASE("particles and fluid together keep their momentum") {
  const double width = 8e-3;
  const Grid g({{0, 0, 0}, {width, width, width}}, {4, 4, 4}, {true, true, true});
  FlowSolver flow(g, {1.2, 1.8e-5}, {.tolerance = 1e-9});
  Particles<Sphere> grains;
  grains.fill({.min = {0, 0, 0}, .max = {width, width, width}},
              {.radius = 0.4e-3, .density = 500, .count = 120});
  for (std::size_t k = 0; k < grains.size(); ++k)
    grains[k].velocity = {0.3 * std::sin(double(k)), 0.3 * std::cos(double(k)), 0.4};
  Simulation sim{std::move(grains), Contacts<HertzMindlin>{glass},
                 silt::PeriodicBox{{{0, 0, 0}, {width, width, width}}, {true, true, true}},
                 rich(flow)};
  sim.time_step = 2e-5;
  sim.fluid().steps = 5;
  double exchanged = 0;
  const auto momentum = [&] {
    // The fluid has given what the particles will have at the end of its step.
    Vec3d sum = sim.fluid().flow().momentum();
    const double due = sim.fluid().time() - sim.time();
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sum += sim.mass(k) * sim.velocity(k) + due * sim.fluid_force(k);
    return sum;
  };
  sim.run(20 * 2e-5);
  const Vec3d start = momentum();
  for (int s = 0; s < 20; ++s) {
    sim.run(5 * 2e-5);
    for (std::size_t k = 0; k < sim.rows(); ++k) exchanged += 5 * 2e-5 * norm(sim.fluid_force(k));
    CHECK(norm(momentum() - start) < 1e-8 * exchanged);
  }
}

TEST_CASE("a run with a fluid goes on from a checkpoint bit by bit, and on any number of threads") {
  const std::string path = (std::filesystem::temp_directory_path() / "silt_coupled.silt").string();
  auto whole = blown(300, 1, 0.6, 2e-5);
  whole.run(0.013);
  silt::save_checkpoint(whole, path);
  whole.run(0.02);
  auto second = blown(300, 3, 0.6, 2e-5);
  silt::load_checkpoint(second, path);
  second.run(0.02);
  REQUIRE(second.size() == whole.size());
  for (std::size_t k = 0; k < whole.rows(); ++k) {
    const std::size_t other = second.find(whole.id(k));
    CHECK(norm(whole.position(k) - second.position(other)) == 0);
    CHECK(norm(whole.velocity(k) - second.velocity(other)) == 0);
  }
  CHECK(whole.fluid().fluid_steps() == second.fluid().fluid_steps());
  // Another drag law is another scene.
  FlowSolver flow(Grid({{0, 0, 0}, {8e-3, 8e-3, 24e-3}}, {4, 4, 12}, {true, true, false}),
                  {1.2, 1.8e-5});
  Particles<Sphere> grain;
  grain.add({.position = {4e-3, 4e-3, 4e-3}, .radius = 5e-4, .density = 1500});
  Simulation other{std::move(grain), Contacts<HertzMindlin>{glass}, slow(flow)};
  CHECK_THROWS_AS(silt::load_checkpoint(other, path), silt::Error);
  std::filesystem::remove(path);
}

TEST_CASE("the ledger knows the fluid's work") {
  // As without a fluid, to second order in the step.
  const auto lacking = [](double time_step) {
    auto sim = blown(200, 1, 2.0, time_step, silt::EnergyLedger{});
    sim.run(0.02);
    const auto e = sim.energy();
    CHECK(std::abs(e.fluid) > 1e-7);  // it slows their fall
    return std::abs(e.residual()) / (std::abs(e.fluid) + e.turned_over);
  };
  const double coarse = lacking(2e-5), fine = lacking(0.5e-5);
  CHECK(fine < 1e-4);        // some 50 steps a contact
  CHECK(fine < coarse / 8);  // 16 and more, but for the crowd's other paths
}

TEST_CASE("the ledger knows the fluid's work on grains that leave, and where the step changes") {
  const auto lacking = [](bool leave, double change) {
    const double step = 1e-5;
    auto sim = blown(20, 1, 8.0, step, silt::EnergyLedger{});
    if (leave) sim.add_outlet({{-1, -1, 0.006}, {1, 1, 1}});
    sim.run(0);
    sim.time_step = change * step;
    sim.run(0.015);
    sim.time_step = step;
    sim.run(0.01);
    const auto e = sim.energy();
    if (leave) CHECK(sim.outlet(0).count >= 5);
    CHECK(e.fluid > 1e-7);
    return std::abs(e.residual()) / (e.fluid + e.turned_over);
  };
  // Catches half a step of the fluid's work left out for each grain that leaves.
  CHECK(lacking(true, 1) < 1e-5);
  // Catches a first kick that is booked with the force after the change: the gas starts suddenly.
  CHECK(lacking(false, 0.5) < 1e-5);
  CHECK(lacking(false, 1.5) < 1e-5);
}

TEST_CASE("fluids that do not fit are refused") {
  const auto with = [](const Grid& g, const silt::PeriodicBox& domain, int steps) {
    Particles<Sphere> grain;
    grain.add({.position = {4e-3, 4e-3, 4e-3}, .radius = 5e-4, .density = 1500});
    auto air = rich(FlowSolver(g, {1.2, 1.8e-5}));
    if (steps != 1) air.steps = steps;
    Simulation sim{std::move(grain), Contacts<HertzMindlin>{glass}, domain, air};
    sim.time_step = 1e-5;
    sim.run(1e-4);
  };
  const silt::Box box{{0, 0, 0}, {8e-3, 8e-3, 8e-3}};
  const silt::PeriodicBox repeats{box, {true, false, false}};
  CHECK_THROWS_WITH_AS(with(Grid(box, {4, 4, 4}), repeats, 1),
                       "the PeriodicBox repeats in x from 0 m on, after 0.008 m, but the flow's "
                       "grid from 0 m on has 0.008 m and is not periodic there; give both the same",
                       silt::InputError);
  CHECK_THROWS_AS(
      with(Grid({{0, 0, 0}, {7e-3, 8e-3, 8e-3}}, {4, 4, 4}, {true, false, false}), repeats, 1),
      silt::InputError);
  CHECK_NOTHROW(with(Grid(box, {4, 4, 4}, {true, false, false}), repeats, 1));
  CHECK_THROWS_WITH_AS(with(Grid(box, {4, 4, 4}, {true, false, false}), repeats, 0),
                       "CoupledFlow.steps = 0 particle steps a fluid step must be at least 1, or "
                       "left out",
                       silt::InputError);
}

TEST_CASE("particles beyond the flow's grid feel no fluid") {
  FlowSolver flow(Grid({{0, 0, 0}, {8e-3, 8e-3, 8e-3}}, {4, 4, 4}), {1000, 1e-3});
  Particles<Sphere> grains;
  grains.add({.position = {4e-3, 4e-3, 12e-3}, .radius = 5e-4, .density = 2500});
  grains.add({.position = {4e-3, 4e-3, 6e-3}, .radius = 5e-4, .density = 2500});
  Simulation sim{std::move(grains), Contacts<HertzMindlin>{glass}, slow(flow)};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;
  sim.run(0.01);
  const std::size_t above = sim.find(0), below = sim.find(1);
  CHECK(norm(sim.fluid_force(above)) == 0);
  CHECK(sim.velocity(above).z == near(-9.81 * 0.01).epsilon(1e-9));
  CHECK(sim.fluid_force(below).z > 0);
  // A centre that has left by less than the radius, as overlaps with walls let it, is still there.
  for (const double out : {0.1e-3, 0.4e-3}) {
    const Vec3d seen = sim.fluid().at_the_side({8e-3 + out, 4e-3, -out}, 5e-4);
    CHECK(seen.x < 8e-3);
    CHECK(seen.x > 8e-3 - 1e-9);
    CHECK(seen.y == 4e-3);
    CHECK(seen.z > 0);
  }
  CHECK(sim.fluid().at_the_side({8e-3 + 6e-4, 4e-3, 4e-3}, 5e-4).x == 8e-3 + 6e-4);
}

TEST_CASE("lift by rotation acts without a torque of the fluid") {
  // Catches angular velocities that reach the forces only beside a torque: no lift at all.
  FlowSolver flow(Grid({{0, 0, 0}, {0.01, 0.01, 0.02}}, {5, 5, 10}, {true, true, false}),
                  {1.2, 1.8e-5});
  const Vec3d spin{0, 1000, 0}, velocity{0, 0, -0.5};
  Particles<Sphere> grain;
  grain.add({.position = {5e-3, 5e-3, 0.01},
             .radius = 0.25e-3,
             .density = 2500,
             .velocity = velocity,
             .angular_velocity = spin});
  Simulation sim{std::move(grain), Contacts<HertzMindlin>{glass}, slow(flow)};
  sim.time_step = 1e-6;
  sim.run(0);
  // The gas is at rest, and has no curl.
  const Vec3d exact = silt::OesterleBuiDinh::force(0.5e-3, 1.2, 1.8e-5, -velocity, -spin);
  CHECK(std::abs(exact.x) > 1e-8);
  // The gas that the grain has moved in the first step: 1e-3 of its velocity.
  CHECK(sim.fluid_force(0).x == near(exact.x).epsilon(3e-3));
  CHECK(sim.angular_velocity(0).y == 1000);
}

#ifdef SILT_LONG_TESTS
TEST_CASE("a pipe that is a wall of both, empty before its inlet opens") {
  const double D = 0.02, h = D / 5, length = 0.06;
  FlowSolver flow(Grid({{0, -0.7 * D, -0.7 * D}, {length, 0.7 * D, 0.7 * D}}, {15, 7, 7}),
                  {1.2, 1.8e-5});
  flow.set_side(0, 0, silt::Inflow{{2, 0, 0}});
  flow.set_side(0, 1, silt::Outflow{});
  Simulation sim{Particles<Sphere>{}, Contacts<HertzMindlin>{glass},
                 CoupledFlow{silt::DiFelice{}, silt::Kernel{}, flow}};
  sim.add_wall(silt::Cylinder{{-3 * h, 0, 0}, {length + 3 * h, 0, 0}, D / 2, silt::Side::Inside},
               glass);
  sim.fluid().flow().set_boundary(silt::boundary_of_walls(sim));
  sim.time_step = 2e-5;
  sim.run(1e-4);
  CHECK(sim.fluid().fluid_steps() > 0);
  sim.add_inlet(silt::CylinderRegion{{0, 0, 0}, {0.01, 0, 0}, D / 2},
                {.radius = silt::uniform(0.5e-3, 0.6e-3),
                 .density = 1000,
                 .rate = 3000,
                 .velocity = {0.5, 0, 0}});
  sim.run(5e-3);
  CHECK(sim.size() >= 10);
  double fastest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) fastest = std::max(fastest, sim.velocity(k).x);
  CHECK(fastest > 0.5);  // the air carries them
  const auto& air = sim.fluid().flow();
  // Air comes in by a disc, whose area in the cells is that of chords of a quarter of a cell: some
  // (h/4)^2 / (4 R) of its radius less. Two grains that come in one fluid step drive out 2 %.
  CHECK(air.flow_rate(0, 0) == near(2 * std::numbers::pi / 4 * D * D).epsilon(0.003));
  CHECK(air.flow_rate(0, 15) == near(air.flow_rate(0, 0)).epsilon(0.03));
  CHECK(sim.fluid().closure().continuity < 1e-6);
}
#endif

}  // namespace simulation_test
