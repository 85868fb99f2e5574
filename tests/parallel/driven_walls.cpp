// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/shape/mesh_body.hpp>

#include "near.hpp"
#include "rank_scenes.hpp"

namespace parallel_driven_walls_test {

namespace {

using silt::Vec3d;
using silt_test::Seen;
using Law = silt::HertzMindlin;

const Law::Material glass{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};

enum class Drive { Servo, Torque, Slide, Hinge, Free };

void add_driven(auto& sim, Drive drive) {
  if (drive == Drive::Servo)
    sim.add_wall(
        silt::Plane{{0, 0, 0.029}, {0, 0, -1}}, glass,
        {.drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 1, .max_speed = 0.3}});
  if (drive == Drive::Torque)  // a blade in the bed
    sim.add_wall(
        silt::rectangle({0.035, 0.01975, 0.001}, {0.05, 0, 0}, {0, 0, 0.02}), glass,
        {.drive = silt::ServoTorque{
             .centre = {0.06, 0.01975, 0}, .axis = {0, 0, 1}, .torque = 2e-3, .max_rate = 5}});
  if (drive == Drive::Slide)
    sim.add_wall(
        silt::Plane{{0, 0, 0.029}, {0, 0, -1}}, glass,
        {.drive = silt::Slide{
             .direction = {0, 0, 1}, .mass = 0.1, .speed = -0.2, .stiffness = 20, .damping = 0.1}});
  if (drive == Drive::Hinge)
    sim.add_wall(silt::rectangle({0.02, 0.01975, 0.002}, {0.07, 0, 0}, {0, 0, 0.03}), glass,
                 {.drive = silt::Hinge{.centre = {0, 0.01975, 0.032},
                                       .axis = {1, 0, 0},
                                       .inertia = 2e-6,
                                       .mass = 5e-3,
                                       .centre_of_mass = {0.055, 0.01975, 0.017},
                                       .rate = 5,
                                       .stiffness = 2e-3,
                                       .damping = 1e-6}});
  if (drive == Drive::Free) {
    const auto mesh = silt::box_mesh({0.02, 0.008, 0.033}, {0.09, 0.03, 0.04});
    auto body = silt::free_body(mesh, 1500);
    body.velocity = {0.05, 0, -0.6}, body.angular_velocity = {3, 4, -2};
    sim.add_wall(mesh, glass, {.drive = body});
  }
}

/// Spheres in a trough whose floor is a belt, with one wall that moves by what they do to it.
template <class... Policies>
auto scene(Drive drive, Policies... policies) {
  silt::Simulation sim{silt_test::cloud(12, 4, 3, 0.0095), silt::Contacts<Law>{glass},
                       std::move(policies)...};
  sim.gravity = {1, 0, -9.81};
  sim.threads = 1, sim.time_step = 2e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass,
               {.surface_velocity = {.velocity = {0.1, 0, 0}}});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0.043, 0}, {0, -1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass);
  sim.add_wall(silt::Plane{{0.12, 0, 0}, {-1, 0, 0}}, glass);
  add_driven(sim, drive);
  return sim;
}
auto ranks(const silt::ThreadComm& comm) {
  return silt::Ranks{
      comm, silt_test::WanderingSlabs{0, 0.12}, {.above = 1, .each = 0, .per_moved = 0}};
}

/// Where the driven wall is, how it moves, and what it bears.
template <class Sim>
std::vector<double> wall_of(const Sim& sim) {
  const auto& wall = sim.wall(5);
  const auto& s = wall.state;
  std::vector<double> all{s.way, s.rate, s.turn.w, s.turn.x, s.turn.y, s.turn.z};
  for (const Vec3d& v : {s.centre, s.velocity, wall.pose.translation, wall.impulse})
    all.insert(all.end(), {v.x, v.y, v.z});
  return all;
}

template <class Sim>
void check_walls_like(const Sim& sim, const std::vector<double>& expected, double tolerance) {
  const auto got = wall_of(sim);
  for (std::size_t k = 0; k < expected.size(); ++k)
    CHECK(std::abs(got[k] - expected[k]) <= tolerance);
}

// Catches: a wall that moves by the loads of one rank alone, or of each rank in another way; a
// servo's stiffness from the contacts of one rank; loads that are summed in steps that are observed
// alone. Without the sums the walls differ by some 1e-3.
TEST_CASE("ranks: walls with a drive move as in one process") {
  for (const auto drive : {Drive::Servo, Drive::Torque, Drive::Slide, Drive::Hinge, Drive::Free}) {
    CAPTURE(static_cast<int>(drive));
    Seen one;
    auto alone = scene(drive);
    const auto at_start = wall_of(alone);
    alone.run(0.025), alone.run(0.025);
    one.add(alone);
    const auto expected = wall_of(alone);
    CHECK(norm(alone.wall(5).impulse) > 1e-4);
    CHECK(expected != at_start);
    for (const int n : {1, 2, 3, 5}) {
      CAPTURE(n);
      Seen many;
      std::mutex mutex;
      std::vector<std::vector<double>> walls;
      silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
        auto sim = scene(drive, ranks(comm));
        sim.run(0.025), sim.run(0.025);
        many.add(sim);
        const std::lock_guard lock(mutex);
        walls.push_back(wall_of(sim));
      });
      const auto [place, velocity] = many.off(one);
      CHECK(place < 1e-12);  // 4e-14 and 2e-11 of the free body, by rounding
      CHECK(velocity < 1e-9);
      if (n == 1) CHECK(place + velocity == 0);
      for (const auto& of_rank : walls) {
        CHECK(of_rank == walls[0]);  // the same bits on all ranks
        for (std::size_t k = 0; k < expected.size(); ++k)
          CHECK(std::abs(of_rank[k] - expected[k]) <= (n == 1 ? 0 : 1e-9));
      }
    }
  }
}

// A drive goes on from what it was: speed, drift, stiffness at the last look.
TEST_CASE("ranks: a drive goes on from a checkpoint on another number of ranks") {
  const silt_test::Folder folder;
  for (const auto drive : {Drive::Servo, Drive::Free}) {
    auto whole = scene(drive);
    whole.run(0.025), whole.run(0.005);
    const auto expected = wall_of(whole);
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      auto sim = scene(drive, ranks(comm));
      sim.run(0.025);
      save_checkpoint(sim, folder / "run.silt");
    });
    silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
      auto sim = scene(drive, ranks(comm));
      load_checkpoint(sim, folder / "run.silt");
      sim.run(0.005);
      check_walls_like(sim, expected, 1e-9);
    });
    auto sim = scene(drive);
    load_checkpoint(sim, folder / "run.silt");
    sim.run(0.005);
    check_walls_like(sim, expected, 1e-9);
  }
}

// Each rank alone has so few of the foil's contacts that its part of their stiffness is no reason.
TEST_CASE("ranks: a free wall that is too light for the contacts on all ranks is refused") {
  std::atomic<int> told{0};
  const auto foil = [&](int spheres, auto... policies) {
    silt::Particles<silt::Sphere> p;
    for (int k = 0; k < spheres; ++k)
      p.add({.position = {0.02 * (k % 20), 0.02 * (k / 20), 0.0095},
             .radius = 0.01,
             .density = 2500});
    silt::Simulation sim{std::move(p), silt::Contacts<Law>{glass}, policies...};
    sim.gravity = {0, 0, -9.81}, sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.add_wall(silt::Plane{{0, 0, 0.019}, {0, 0, -1}}, glass,
                 {.name = "foil", .drive = silt::Slide{.direction = {0, 0, 1}, .mass = 0.5}});
    try {
      sim.run(0.01);
    } catch (const silt::SimulationError& e) {
      const std::string words = e.what();
      const bool it = words.find("wall 1 'foil' is too light for its contacts") != words.npos;
      told += it && e.step == 0;
    }
  };
  foil(80);
  CHECK(told == 0);  // of a fifth of them it is heavy enough
  foil(400);
  CHECK(told == 1);
  silt::run_on_ranks(5, [&](const silt::ThreadComm& comm) {
    foil(400, silt::Ranks{comm, silt_test::WanderingSlabs{0, 0.4, false}});
  });
  CHECK(told == 6);
}

}  // namespace

}  // namespace parallel_driven_walls_test
