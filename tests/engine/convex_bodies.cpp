// silt - BSD-3-Clause, see LICENSE
//
// Super-ellipsoids in the engine: against spheres, conservation in collisions, rest on planes, and
// all that a simulation does with particles.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <silt/boundary/domain.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/silt.hpp>

#include "engine/body_totals.hpp"
#include "engine/support.hpp"
#include "near.hpp"

namespace convex_bodies_test {

namespace {

using namespace engine_test;
using silt::SuperEllipsoid;
using Bodies = silt::Particles<SuperEllipsoid>;

constexpr HertzMindlin::Material stone{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.7, .friction = 0.5};

HertzMindlin::Material elastic() {
  auto m = stone;
  m.restitution = 1, m.friction = 0;
  return m;
}

const SuperEllipsoid tablet{.a = 1e-3, .b = 1e-3, .c = 0.5e-3, .s1 = 6, .s2 = 2};
const SuperEllipsoid egg{.a = 0.7e-3, .b = 1e-3, .c = 1.4e-3};
const SuperEllipsoid die{.a = 1e-3, .b = 1e-3, .c = 1e-3, .s1 = 8, .s2 = 8};

/// Tablets, ellipsoids and dice of several sizes that fall into a box.
template <class... Policies>
auto heap(std::size_t count, Policies... policies) {
  Bodies bodies;
  double z = 0;
  for (const auto& shape : {tablet, egg, die}) {
    const auto form = bodies.add_form(shape);
    bodies.fill({.min = {0, 0, z}, .max = {0.015, 0.015, z + 0.04}},
                {.radius = silt::uniform(1.1e-3, 1.5e-3),
                 .density = 2500,
                 .count = count / 3,
                 .velocity = {0.1, 0.05, -0.5},
                 .form = form});
    z += 0.04;
  }
  silt::Simulation sim{std::move(bodies), silt::Contacts<HertzMindlin>{stone}, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.015, 0.015, 0.2}), stone);
  return sim;
}

}  // namespace

TEST_CASE("Super-ellipsoids with s = 2 and equal axes move as spheres") {
  struct Start {
    Vec3d position, velocity, angular_velocity;
  };
  /// Velocities after a collision of one with another, or with a plane.
  const auto run = [](auto particles, bool with_plane, double time_step) {
    silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{stone}};
    sim.time_step = time_step;
    if (with_plane) sim.add_wall(silt::Plane{{0, 0, -1e-3}, {0, 0, 1}}, stone);
    sim.run(0.004);
    return std::array{sim.velocity(0), sim.angular_velocity(0) * 1e-3};
  };
  const auto apart = [&](bool with_plane, double time_step) {
    std::vector<Start> starts{{{0, 0, 1.03e-4}, {0.1, 0.3, -1}, {30, 40, 50}}};
    if (!with_plane) starts.push_back({{0.5e-3, 0, -1.9e-3}, {0, 0, 0}, {5, 6, 7}});
    silt::Particles<Sphere> spheres;
    Bodies bodies;
    bodies.add_form({.a = 1e-3, .b = 1e-3, .c = 1e-3});
    for (const auto& [x, v, w] : starts) {
      spheres.add({x, 1e-3, 2500, v, w});
      bodies.add({.position = x,
                  .orientation = silt::rotation_about({0.6, 0, 0.8}, 1),
                  .density = 2500,
                  .velocity = v,
                  .angular_velocity = w});
    }
    const auto a = run(spheres, with_plane, time_step), b = run(bodies, with_plane, time_step);
    CHECK(norm(a[0] - starts[0].velocity) > 0.3);  // they have met
    return std::max(norm(a[0] - b[0]), norm(a[1] - b[1]));
  };
  CHECK(apart(true, 5e-6) < 1e-11);
  // First order in the step: the arms of a pair's contact are those of now, velocities half a step
  // older.
  const double coarse = apart(false, 8e-6), fine = apart(false, 1e-6);
  CHECK(coarse < 2e-5);
  CHECK(fine < coarse / 4);
}

TEST_CASE("Super-ellipsoids that collide keep momentum, angular momentum and energy") {
  int met = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    silt::Random random(static_cast<std::uint64_t>(seed));
    Bodies pair;
    for (const auto& shape : {tablet, egg, die}) pair.add_form(shape);
    pair.add({.form = static_cast<std::size_t>(seed % 3),
              .position = {-2e-3, 0, 0},
              .orientation = silt::random_orientation(random),
              .density = 2500,
              .velocity = {1, 0, 0},
              .angular_velocity = {100, 50, -200}});
    pair.add({.form = static_cast<std::size_t>(seed / 3 % 3),
              .position = {2e-3, 0.3e-3, 0.2e-3},
              .orientation = silt::random_orientation(random),
              .density = 4000,
              .velocity = {-0.5, 0.1, 0}});
    const auto errors = [&](double time_step) {
      silt::Simulation s{pair, silt::Contacts<HertzMindlin>{elastic()}};
      s.time_step = time_step;
      s.run(0);
      const Totals before = totals(s);
      s.run(0.006);
      const Totals after = totals(s);
      // Force and torques are in balance by the way they are made; NoSquish keeps the rest.
      CHECK(norm(after.momentum - before.momentum) < 1e-13 * norm(before.momentum));
      CHECK(norm(after.angular - before.angular) < 1e-9 * norm(before.angular));
      if (norm(s.velocity(0) - Vec3d{1, 0, 0}) > 0.1) ++met;
      return std::abs(after.energy / before.energy - 1);
    };
    // Second order in the step (the overlap is a potential), with corners 60 contacts' steps long.
    const double coarse = errors(2e-6), fine = errors(0.5e-6);
    CHECK(coarse < 1e-3);
    CHECK(fine < 1e-3 / 16);
  }
  CHECK(met > 18);
}

TEST_CASE("A die of flat faces rests on a slope, one of round faces rolls") {
  // The slope is below the angle of friction. Faces of s = 4 are as curved as those of a sphere of
  // radius 3 a some way off their middle.
  const auto slide = [](double s) {
    const double slope = 0.35;
    Bodies one;
    one.add_form({.a = 1e-3, .b = 1e-3, .c = 1e-3, .s1 = s, .s2 = s});
    const silt::Quaternion turn = silt::rotation_about({0, 1, 0}, -slope);
    const Vec3d up = rotate(turn, {0, 0, 1});
    one.add({.position = 0.999e-3 * up, .orientation = turn, .density = 2500});
    silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{stone}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, up}, stone);
    sim.run(0.1);
    const Vec3d from = sim.position(0);
    sim.run(0.5);
    return norm(sim.position(0) - from);
  };
  CHECK(slide(20) < 1e-9);
  CHECK(slide(4) > 0.01);
}

TEST_CASE("A heap of super-ellipsoids comes to rest, the same for any number of threads") {
  auto sim = heap(90), other = heap(90);
  sim.threads = 1;
  other.threads = 3;
  sim.run(0.05), other.run(0.05);
  CHECK(bits(sim) == bits(other));
  sim.run(0.35);
  CHECK(totals(sim).energy < 1e-7);  // of some 3e-4 J
  CHECK(sim.peak_overlap() < 0.3);
  CHECK(sim.touching_pairs() > 90);
}

TEST_CASE("A run of super-ellipsoids continued from a checkpoint has the same bits") {
  const std::string path = "convex_checkpoint_test.silt";
  auto sim = heap(45);
  sim.run(0.06);
  silt::save_checkpoint(sim, path);
  sim.run(0.03);
  auto again = heap(45);
  silt::load_checkpoint(again, path);
  again.run(0.03);
  CHECK(bits(sim) == bits(again));
  std::remove(path.c_str());
}

TEST_CASE("Super-ellipsoids in a periodic box collide across its faces as in the middle") {
  const auto run = [](const Vec3d& shift) {
    Bodies pair;
    pair.add_form(egg);
    const Vec3d middle = Vec3d{0.01, 0.01, 0.01} + shift;
    pair.add({.position = middle + Vec3d{-3e-3, 0, 0}, .density = 2500, .velocity = {1, 0.02, 0}});
    pair.add({.position = middle + Vec3d{3e-3, 0.4e-3, 0},
              .orientation = silt::rotation_about({0, 0, 1}, 0.5),
              .density = 2500,
              .velocity = {-1, 0, 0.01}});
    silt::Simulation sim{std::move(pair), silt::Contacts<HertzMindlin>{stone},
                         silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}, {true, true, true}}};
    sim.time_step = 2e-6;
    sim.run(0.02);  // they go round the box
    return std::array{sim.velocity(0), sim.velocity(1), sim.angular_velocity(0)};
  };
  const auto middle = run({0, 0, 0}), across = run({0.0105, 0, 0});
  CHECK(norm(middle[0] - Vec3d{1, 0.02, 0}) > 0.1);
  for (int k = 0; k < 3; ++k) CHECK(norm(middle[k] - across[k]) < 1e-7 * norm(middle[k]));
}

TEST_CASE("The books of super-ellipsoids close to the step's order") {
  const auto residual = [](double time_step) {
    auto sim = heap(45, silt::EnergyLedger{});
    sim.time_step = time_step;
    sim.run(0);
    sim.run(0.06);
    const auto e = sim.energy();
    CHECK(e.normal_damping > 0);
    CHECK(e.friction > 0);
    return std::abs(e.residual()) / e.turned_over;
  };
  // First order: the arm of a contact changes in half a step.
  CHECK(residual(8e-6) < 8e-3);
  CHECK(residual(2e-6) < 2e-3);
}

TEST_CASE("A plane that moves carries and pushes super-ellipsoids") {
  Bodies one;
  one.add_form(egg);
  one.add({.position = {0, 0, 1.39e-3}, .density = 2500});  // upright on its tip
  silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{stone}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, stone, silt::translation({0, 0, 0.05}));
  sim.run(0.2);
  // It lies on its side by now and rocks: its height over the plane varies by less than 0.8 mm, and
  // in 0.6 s it goes up with the plane by 30. The plane's mean load is the weight; a contact that
  // took the plane for one at rest would push the grain off, or let it sink.
  const double weight = 9.81 * sim.mass(0), from = sim.position(0).z;
  CHECK(from > 0.01 + 0.6e-3);
  CHECK(from < 0.01 + 1.4e-3);
  double load = 0, samples = 0;
  sim.run(0.6, silt::at(silt::every(1e-4),
                        [&](const auto& s) { load -= s.wall(0).force.z, samples += 1; }));
  CHECK(std::abs(sim.position(0).z - from - 0.03) < 0.8e-3);
  CHECK(near_relative(load / samples, weight, 0.05));
}

TEST_CASE("The VTK series of super-ellipsoids shows their surfaces") {
  const std::string folder = "convex_vtk_test";
  auto sim = heap(6);
  sim.run(0, silt::vtk_series(folder, silt::every(1.0)));
  std::ifstream list(folder + "/surfaces.pvd"), file(folder + "/surfaces_000000000.vtp");
  REQUIRE(list.good());
  std::string head(2000, ' ');
  file.read(head.data(), 2000);
  // Six bodies of 6 faces with 8 x 8 cells of 2 triangles.
  CHECK(head.find("NumberOfPolys=\"4608\"") != std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST_CASE("The guard of super-ellipsoids names what is wrong") {
  Bodies two;
  two.add_form(die);
  two.add({.position = {0, 0, 0}, .density = 2500});
  two.add({.position = {1e-3, 0, 0}, .density = 2500});  // half a die deep
  silt::Simulation deep{two, silt::Contacts<HertzMindlin>{stone}};
  deep.time_step = 1e-7;
  CHECK(has_words(refusal<silt::SimulationError>([&] { deep.run(1e-5); }),
                  {"particles 0 and 1", "overlap", "guard.max_overlap"}));
  // Contacts stiffer than the step allows: dice pressed together by a load, not by speed.
  Bodies few;
  few.add_form(die);
  few.add({.position = {0, 0, 0.9e-3}, .density = 2500});
  silt::Simulation stiff{few, silt::Contacts<HertzMindlin>{stone}};
  stiff.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, stone);
  stiff.add_wall(silt::Plane{{0, 0, 1.8e-3}, {0, 0, -1}}, stone);
  stiff.guard.max_time_step = 100, stiff.guard.max_travel = 100;
  stiff.time_step = 1e-4;
  CHECK(has_words(refusal<silt::SimulationError>([&] { stiff.run(0.1); }),
                  {"particle 0", "rate", "Simulation::time_step"}));
}

}  // namespace convex_bodies_test
