// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace followed_drag_test {

using silt::FlowSolver;
using silt::FollowedDrag;
using silt::Grid;
using silt::Particles;
using silt::Sphere;
using silt::Vec3d;

namespace {

const silt::HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};

/// One simulation for all of them: it is compiled once.
auto followed(Particles<Sphere> grains, FlowSolver flow, FollowedDrag how, double time_step,
              int steps, int threads = 1) {
  const auto& g = flow.grid();
  const silt::PeriodicBox domain{g.box(), {g.periodic(0), g.periodic(1), g.periodic(2)}};
  silt::CoupledFlow fluid{silt::Gidaspow{}, silt::Kernel{}, std::move(flow), how};
  fluid.steps = steps;
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass}, domain,
                       std::move(fluid), silt::EnergyLedger{}};
  sim.time_step = time_step, sim.threads = threads;
  return sim;
}

Particles<Sphere> crowd(double width, double height, std::size_t count) {
  Particles<Sphere> grains;
  grains.fill({.min = {0, 0, 1e-3}, .max = {width, width, height}},
              {.radius = silt::uniform(0.4e-3, 0.6e-3), .density = 1500, .count = count});
  for (std::size_t k = 0; k < grains.size(); ++k)
    grains[k].velocity = {0.3 * std::sin(double(k)), 0.3 * std::cos(double(k)), 0.4};
  return grains;
}

/// A crowd blown at from below, which leaves at the top.
auto blown(FollowedDrag how, int threads, double time_step = 2e-5) {
  const double W = 8e-3, H = 24e-3;
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 12}, {true, true, false}), {1.2, 1.8e-5});
  flow.set_side(2, 0, silt::Inflow{{0, 0, 2}});
  flow.set_side(2, 1, silt::Outflow{});
  auto sim = followed(crowd(W, 0.6 * H, 300), flow, how, time_step, 10, threads);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.gravity = {0, 0, -9.81};
  return sim;
}

const FollowedDrag ways[] = {{}, {.cell = 1e-3}, {.cell = 4e-3, .tolerance = 0.05}};

}  // namespace

TEST_CASE(
    "followed drag: a grain in a steady gas keeps to its exact solution, K anew in each step") {
  // dv/dt = -k1 w (1 + k2 w^0.687), w = u - v, is no exponential; its solution by RK4 in fine
  // steps.
  const double d = 1e-3, density = 100, up = 0.8, W = 0.06, H = 0.04;
  const silt::FluidProperties air{1.2, 1.8e-5};
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {10, 10, 10}, {true, true, true}), air);
  flow.velocity(2).fill(up);
  Particles<Sphere> grain;
  grain.add({.position = {W / 2, W / 2, 0.01}, .radius = 0.5 * d, .density = density});
  const double dt = 1e-4, end = 0.02;  // ten fluid steps
  const auto error = [&](double tolerance) {
    auto sim = followed(grain, flow, {.tolerance = tolerance}, dt, 20);
    sim.guard.max_time_step = 1e9;  // it meets nobody
    sim.run(end);
    const double m = density * Sphere::volume(d / 2);
    const auto slope = [&](double v) {
      const double w = up - v;
      return silt::drag_coefficient(silt::Gidaspow{}, 1.0, air.density * w * d / air.viscosity, d,
                                    air.viscosity) *
             w / m;
    };
    double v = 0;
    for (int n = 0; n < 2000; ++n) {
      const double h = end / 2000, a = slope(v), b = slope(v + 0.5 * h * a),
                   c = slope(v + 0.5 * h * b), e = slope(v + h * c);
      v += h / 6 * (a + 2 * b + 2 * c + e);
    }
    CHECK(v > 0.1 * up);  // it has sped up by far
    return std::abs(sim.velocity(0).z / v - 1);
  };
  // The gas around it, which the fluid step has slowed by its drag: 36 x 36 x 40 diameters.
  CHECK(error(0) < 3e-3);
  CHECK(error(0.05) < 0.02);  // 0.4 of the tolerance at most, as K ~ w^0.4 here
  CHECK(error(0.05) != error(0));
}

TEST_CASE("followed drag: momentum of particles and fluid, with what is owed, stays") {
  const double W = 8e-3;
  for (const FollowedDrag& how : ways) {
    CAPTURE(how.cell);
    FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {4, 4, 4}, {true, true, true}), {1.2, 1.8e-5},
                    {.tolerance = 1e-9});
    auto sim = followed(crowd(W, W, 120), flow, how, 2e-5, 5);
    const auto momentum = [&] {
      Vec3d sum = sim.fluid().flow().momentum();
      for (std::size_t k = 0; k < sim.rows(); ++k)
        sum += sim.mass(k) * sim.velocity(k) + sim.due_from_fluid(k);
      return sum;
    };
    sim.run(20 * 2e-5);
    const Vec3d start = momentum();
    double exchanged = 0, owed = 0, drift = 0;
    for (int s = 0; s < 40; ++s) {
      sim.run(7 * 2e-5);  // within fluid steps as well
      for (std::size_t k = 0; k < sim.rows(); ++k) exchanged += 7 * 2e-5 * norm(sim.fluid_force(k));
      owed = std::max(owed, norm(sim.fluid().last_step().owed));
      drift = std::max(drift, norm(momentum() - start));
    }
    CHECK(owed > 0);
    CHECK(drift < 1e-8 * exchanged);
  }
}

TEST_CASE("followed drag: a stiff grain between two fluid steps comes to its terminal velocity") {
  const double d = 1e-6, density = 1000, mu = 1.8e-5, W = 8e-3, g = 9.81;
  const double tau = density * d * d / (18 * mu), v_t = g * tau * (1 - 1.2 / density);
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, W}}, {4, 4, 4}, {true, true, false}), {1.2, mu});
  Particles<Sphere> grain;
  grain.add({.position = {W / 2, W / 2, W / 2}, .radius = d / 2, .density = density});
  auto sim = followed(std::move(grain), std::move(flow), {}, 1000 * tau, 5);
  sim.gravity = {0, 0, -g};
  sim.guard.max_time_step = 1e12, sim.guard.max_travel = 1e12;  // it meets nobody
  sim.run(20e3 * tau);
  CHECK(sim.velocity(0).z == near(-v_t).epsilon(1e-4));
}

TEST_CASE("followed drag: a dense suspension in long fluid steps falls as its law says") {
  // As of a held force (extremes.cpp); what is owed must not add to the pressure's lag.
  const double d = 0.5e-3, mu = 0.1, density = 2500, liquid = 1100, dt = 2e-5;
  const int n = 6, layers = 14;
  const double pitch = d * std::cbrt(std::acos(-1.0) / 6 / 0.45), W = n * pitch,
               H = (layers + 2) * pitch;
  Particles<Sphere> grains;
  for (int k = 0; k < n * n * layers; ++k)
    grains.add({.position = {(k % n + 0.5) * pitch, (k / n % n + 0.5) * pitch,
                             (k / (n * n) + 1.5) * pitch},
                .radius = 0.5 * d,
                .density = density});
  FlowSolver flow(Grid({{0, 0, 0}, {W, W, H}}, {4, 4, 10}, {true, true, false}), {liquid, mu});
  auto sim = followed(std::move(grains), std::move(flow), {.tolerance = 0.01}, dt, 4);
  sim.gravity = {0, 0, -9.81};
  sim.run(2000 * dt);
  const double law =
      silt::minimum_fluidisation_velocity(silt::Gidaspow{}, 0.55, d, density, liquid, mu);
  double fall = 0, fastest = 0;
  int count = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (std::abs(sim.position(k).z / H - 0.5) > 0.25) continue;
    fall -= sim.velocity(k).z, fastest = std::max(fastest, norm(sim.velocity(k))), ++count;
  }
  CHECK(fall / count == near(law).epsilon(0.1));
  CHECK(fastest < 2 * law);
}

TEST_CASE(
    "followed drag: checkpoints and threads give the same bits, with an inlet and an outlet") {
  const std::string path = (std::filesystem::temp_directory_path() / "silt_followed.silt").string();
  const auto scene = [](const FollowedDrag& how, int threads) {
    auto sim = blown(how, threads);
    sim.add_outlet({{0, 0, 16e-3}, {8e-3, 8e-3, 30e-3}});
    sim.add_inlet(silt::Box{{0, 0, 12e-3}, {8e-3, 8e-3, 15e-3}},
                  {.radius = silt::uniform(0.4e-3, 0.6e-3), .density = 1500, .rate = 2000});
    return sim;
  };
  for (const FollowedDrag& how : ways) {
    CAPTURE(how.cell);
    auto whole = scene(how, 1);
    whole.run(0.0131);  // within a fluid step
    // What these had taken beyond what the fluid gave is booked in the next step.
    for (const silt::ParticleId id : {3, 5, 7}) whole.remove(id);
    silt::save_checkpoint(whole, path);
    whole.run(0.01);
    CHECK(whole.outlet(0).count > 0);
    CHECK(norm(whole.fluid().lost()) > 0);
    auto second = scene(how, 3);
    silt::load_checkpoint(second, path);
    second.run(0.01);
    REQUIRE(second.size() == whole.size());
    double apart = 0;
    for (std::size_t k = 0; k < whole.rows(); ++k) {
      if (!whole.is_present(k)) continue;
      const std::size_t other = second.find(whole.id(k));
      apart += norm(whole.position(k) - second.position(other)) +
               norm(whole.velocity(k) - second.velocity(other));
    }
    CHECK(apart == 0);
    CHECK(norm(whole.fluid().lost() - second.fluid().lost()) == 0);
  }
  std::filesystem::remove(path);
}

TEST_CASE("followed drag: the ledger closes to second order in the step") {
  const auto lacking = [](double time_step) {
    auto sim = blown({}, 1, time_step);
    sim.run(0.02);
    const auto e = sim.energy();
    CHECK(e.fluid > 0);
    return std::abs(e.residual()) / (e.fluid + e.turned_over);
  };
  const double coarse = lacking(2e-5), fine = lacking(0.5e-5);
  CHECK(fine < 1e-4);        // as with a held force
  CHECK(fine < coarse / 8);  // 16, but for the crowd's other paths
}

TEST_CASE("followed drag: negative numbers and cells beyond all memory are refused") {
  const auto with = [](FollowedDrag how) {
    return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{},
                             FlowSolver(Grid({{0, 0, 0}, {1, 1, 1}}, {4, 4, 4}), {1.2, 1.8e-5}),
                             how};
  };
  CHECK_THROWS_AS(with({.cell = -1}), silt::InputError);
  CHECK_THROWS_AS(with({.cell = 1e-9}), silt::InputError);
  CHECK_NOTHROW(with({.cell = 10}));
  CHECK_THROWS_AS(with({.tolerance = -0.1}), silt::InputError);
}

}  // namespace followed_drag_test
