// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/boundary/finite_walls.hpp>
#include <silt/shape/mesh_body.hpp>
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "sph/floating.hpp"

namespace sph_driven_walls_test {

using namespace silt;

namespace {

const HertzMindlin::Material steel{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
constexpr double g = 9.81;

/// The liquid in a Simulation without particles.
template <class Water>
auto scene(Water water, double step) {
  Simulation sim{Particles<Sphere>{}, Contacts<HertzMindlin>{steel}, std::move(water)};
  sim.time_step = step;
  return sim;
}

/// A closed cell 0.1 m wide and 0.2 m high, full of liquid without pressure; wall 3 is its lid.
constexpr double width = 0.1, height = 0.2, sound = 20;
auto cell(const WallDrive& drive, double step, const std::string& checkpoint = {}) {
  Sph water{Liquid{.density = 1000, .sound_speed = sound},
            {.spacing = 0.01,
             .region = {{0, 0, 0}, {width, 0, height}},
             .smoothing = 1.0,
             .dimensions = 2,
             .courant = 0.2},  // on which the errors of exchange and ledger depend
            ArtificialViscosity{.alpha = 0.1},
            EnergyLedger{}};
  water.fill([](const Vec3d&) { return true; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [](const Vec3d&) { return 0.0; });
  auto sim = scene(std::move(water), step);
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, steel);
  sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, steel);
  sim.add_wall(Plane{{width, 0, 0}, {-1, 0, 0}}, steel);
  sim.add_wall(Plane{{0, 0, height}, {0, 0, -1}}, steel, {.name = "lid", .drive = drive});
  if (!checkpoint.empty()) load_checkpoint(sim, checkpoint);
  return sim;
}
template <class Sim>
std::vector<double> state_of(const Sim& sim) {
  std::vector<double> all = sph_test::state_of(sim, 0);
  const Pose& pose = sim.wall(3).pose;
  all.insert(all.end(), {pose.translation.x, pose.translation.z, sim.wall(3).state.rate});
  const LiquidBalance e = sim.fluid().energy();
  all.insert(all.end(), {e.walls, e.artificial, e.at_walls, e.initial});
  return all;
}

}  // namespace

TEST_CASE("SPH: a servo presses a closed column to the pressure F/A") {
  const double F = 10, want = F / width;  // [N/m], [Pa]
  auto sim = cell(ServoForce{.direction = {0, 0, -1}, .force = F, .max_speed = 0.05}, 1e-4);
  sim.run(0.7);
  const auto load = sim.fluid().load_on_driven(3);
  double mean = 0;
  sim.fluid().for_each(
      [&](std::uint32_t, const Vec3d&, const Vec3d&, double, double p) { mean += p; });
  mean /= static_cast<double>(sim.fluid().size());
  CHECK(load.force.z == near(F).epsilon(0.003));  // 0.07 %
  // 6 and 10 % here, whatever the force: the particles in the corners belong to the side walls, a
  // quarter of a spacing of ten at each, so that F acts on 0.95 of the lid.
  CHECK(mean == near(want).epsilon(0.07));
  // Its way is that of the compression, P/(rho c^2) of the height.
  const double way = sim.wall("lid").state.way;
  CHECK(way == near(want / (1000 * sound * sound) * height).epsilon(0.11));
}

TEST_CASE("SPH: a sliding lid with a mass: force times way is what lid and liquid have") {
  const double F = 20, m = 5;  // [N/m], [kg/m]; the liquid has 20 kg/m
  auto sim = cell(Slide{.direction = {0, 0, -1}, .mass = m, .force = F}, 5e-5);
  double most = 0, mean = 0;
  for (int k = 0; k < 100; ++k) {
    sim.run(0.004);
    const WallState& s = sim.wall("lid").state;
    const double given = F * s.way - 0.5 * m * s.rate_now * s.rate_now;
    const LiquidBalance e = sim.fluid().energy();
    most = std::max(most, std::abs(given - e.walls));
    mean += sim.fluid().load_on_driven(3).force.z / 100;
    CHECK(std::abs(e.residual()) < 2e-7);  // 1e-4 of the largest work, 2e-3 J/m
  }
  // The liquid's steps hold the lid's velocity, half a step old: 2.1 % of the work of its first way
  // down, F times twice the way at rest; first order in the step.
  CHECK(most < 0.03 * 2 * F * F / width / (1000 * sound * sound) * height);
  CHECK(mean == near(F).epsilon(0.05));
  CHECK(sim.fluid().energy().walls > 0);
}

TEST_CASE("SPH: a lid that is too light for the step is refused, and stands a shorter one") {
  const Slide light{.direction = {0, 0, -1}, .mass = 0.1, .force = 20};
  auto sim = cell(light, 1e-4);
  CHECK_THROWS_WITH_AS(
      sim.run(0.01),
      doctest::Contains("wall 3 'lid' is too light compared with the liquid for steps of"),
      SimulationError);
  // 0.1 kg/m are those of a layer of liquid 1 mm thick: a tenth of a spacing.
  auto slow = cell(light, 1e-5);
  slow.run(0.05);
  double mean = 0;
  for (int k = 0; k < 50; ++k) slow.run(0.001), mean += slow.fluid().load_on_driven(3).force.z / 50;
  CHECK(mean == near(20).epsilon(0.05));
  CHECK(std::abs(slow.wall("lid").state.way) < 5e-4);
}

namespace {

/// A box 0.1 m wide and high, of `density`, wholly under water in a tank, let go at rest: how far
/// [m] it has moved upwards after 0.1 s. As a particle of the Simulation, or as a wall that is
/// free.
double way_of_box(bool as_wall, double density) {
  const double spacing = 0.0125, depth = 0.5;
  Sph water{Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(g * depth)},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {0.5, 0, 0.7}},
             .smoothing = 1.0,
             .dimensions = 2}};
  water.gravity = {0, 0, -g};
  const Vec3d centre{0.25, 0, 0.25}, half{0.05, 0.5, 0.05};
  const auto in_box = [&](const Vec3d& x) {
    return std::abs(x.x - centre.x) < half.x && std::abs(x.z - centre.z) < half.z;
  };
  water.fill([&](const Vec3d& x) { return x.z < depth && !in_box(x); });
  Particles<Polyhedron> boxes;
  std::vector<Vec3d> corners;
  for (const double x : {-half.x, half.x})
    for (const double y : {-half.y, half.y})
      for (const double z : {-half.z, half.z}) corners.push_back({x, y, z});
  const auto form = boxes.add_form(Polyhedron::from_points(corners));
  boxes.add({.form = form,
             .position = as_wall ? Vec3d{50, 0, 50} : centre,
             .density = density,
             .fixed = as_wall});
  Simulation sim{std::move(boxes), Contacts<HertzMindlin>{steel}, std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-4;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, steel);
  sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, steel);
  sim.add_wall(Plane{{0.5, 0, 0}, {-1, 0, 0}}, steel);
  if (as_wall) {
    const TriangleMesh mesh = box_mesh(centre - half, centre + half);
    sim.add_wall(mesh, steel, {.name = "box", .drive = free_body(mesh, density)});
  }
  sim.run(0.1);
  CHECK(sim.fluid().left() == 0);
  // Symmetric, so it does not turn. Catches points equally near to two faces that get the image
  // behind the one that rounding chooses: 4e-3 and 1e-4 here.
  if (as_wall) CHECK(norm(sim.wall("box").state.momentum) < 1e-10);  // [kg m2/s]
  return (as_wall ? sim.wall("box").state.centre.z : sim.position(0).z) - centre.z;
}

}  // namespace

TEST_CASE(
    "SPH: a free wall under water sinks and rises by buoyancy and added mass, as a body does") {
  for (const double density : {4000.0, 500.0}) {
    CAPTURE(density);
    const double wall = way_of_box(true, density), body = way_of_box(false, density);
    // Two ways to the same particles in the box.
    CHECK(wall == near(body).epsilon(0.05));
    // (m_f - m) g/(m + m_a), m_a = 1.19 m_f of a square far from walls (recalled); in a tank five
    // times as wide it is more, which the light one feels most (5 and 15 % here). Without added
    // mass the ways would be 1.3 and 3.4 times as far.
    const double share = density / 1000;
    const double expected = 0.5 * 0.01 * g * (1 - share) / (share + 1.19);
    CHECK(wall == near(expected).epsilon(0.18));
  }
}

TEST_CASE("SPH: a drum that a torque turns gives its liquid what it does not keep") {
  // Forces of pairs are central: the sum of both is the torque times time but for the loads, which
  // are of the step before, and shifting, which is left out here.
  const double R = 0.1, I = 2, T = 4;  // [m], [kg m2/m]; the liquid has 0.16 as it turns with it
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 0.01,
             .region = {{-R, 0, -R}, {R, 0, R}},
             .smoothing = 1.0,
             .dimensions = 2,
             .slip = Slip::None},
            ArtificialViscosity{.alpha = 0.5},
            NoShifting{},
            EnergyLedger{}};
  water.fill([&](const Vec3d& x) { return dot(x, x) < R * R; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [](const Vec3d&) { return 1000.0; });
  auto sim = scene(std::move(water), 1e-4);
  sim.add_wall(Cylinder{{0, -1, 0}, {0, 1, 0}, R, Side::Inside}, steel,
               {.name = "drum",
                .drive = Hinge{.centre = {0, 0, 0}, .axis = {0, 1, 0}, .inertia = I, .torque = T}});
  double spun = 0;
  for (int k = 1; k <= 3; ++k) {
    sim.run(0.1);
    spun = 0;
    const double m = sim.fluid().particle_mass();
    sim.fluid().for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
      spun += m * cross(x, v).y;
    });
    const double kept = I * sim.wall("drum").state.rate_now;
    CHECK(kept + spun == near(T * sim.time()).epsilon(1e-3));
  }
  CHECK(spun > 0.01 * T * 0.3);  // the liquid is dragged along
  // Power of the wall: torque times rate.
  const double rate = sim.wall("drum").state.rate_now;
  const double work = T * sim.wall("drum").state.way - 0.5 * I * rate * rate;
  CHECK(sim.fluid().energy().walls == near(work).epsilon(0.02));
}

TEST_CASE("SPH: a belt drags the liquid as a plate that moves does") {
  const int n = 10;
  const double H = 0.01, U = 0.01, nu = 1e-5, spacing = H / n, end = 0.1 * H * H / nu;
  const auto profile = [&](const WallSetup& lid) {
    Sph oil{Liquid{.density = 1000, .sound_speed = 20 * U},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {13 * spacing, 0, H}},
             .dimensions = 2,
             .periodic = {true, false, false}},
            LaminarViscosity{.kinematic = nu},
            NoDiffusion{},
            EnergyLedger{}};
    oil.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    oil.add_wall(Plane{{0, 0, H}, {0, 0, -1}}, lid);
    oil.fill([](const Vec3d&) { return true; });
    oil.run(end);
    std::vector<double> all(oil.size() + 1);
    oil.for_each(
        [&](std::uint32_t k, const Vec3d&, const Vec3d& v, double, double) { all[k] = v.x / U; });
    all.back() = oil.energy().walls;
    return all;
  };
  const auto belt = profile({.surface_velocity = {.velocity = {U, 0, 0}}}),
             plate = profile({.motion = translation({U, 0, 0})});
  double off = 0, fastest = 0;
  for (std::size_t k = 0; k + 1 < belt.size(); ++k)
    off = std::max(off, std::abs(belt[k] - plate[k])), fastest = std::max(fastest, belt[k]);
  CHECK(off < 1e-6);  // the plate's velocity is a difference of places over a tenth of a step
  CHECK(fastest > 0.8);
  CHECK(fastest < 1);
  CHECK(belt.back() > 0);
  CHECK(belt.back() == near(plate.back()).epsilon(1e-6));
}

TEST_CASE("SPH: driven walls: same bits with threads, and from a checkpoint on") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_driven.silt").string();
  const Slide drive{.direction = {0, 0, -1}, .mass = 5, .force = 20};
  auto sim = cell(drive, 1e-4);
  sim.run(0.0153);
  save_checkpoint(sim, path);
  const auto loads = sph_test::loads_of(sim, 4);
  sim.run(0.0151);
  auto again = cell(drive, 1e-4, path);
  CHECK(sph_test::loads_of(again, 4) == loads);  // with the lid where it was, and as fast
  again.threads = 3;
  again.run(0.0151);
  CHECK(state_of(again) == state_of(sim));
  std::filesystem::remove(path);
}

TEST_CASE("SPH: walls that a liquid cannot have are refused") {
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 0.01, .region = {{0, 0, 0}, {0.1, 0, 0.1}}, .dimensions = 2}};
  CHECK_THROWS_WITH_AS(
      water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}},
                     {.name = "lid", .drive = Slide{.direction = {0, 0, 1}, .mass = 1}}),
      doctest::Contains("wall 'lid' has a drive, which needs a Simulation; add the wall "
                        "to a Simulation"),
      InputError);
  water.fill([](const Vec3d&) { return true; });
  auto sim = scene(std::move(water), 1e-4);
  const TriangleMesh mesh = box_mesh({0.2, -0.1, 0}, {0.3, 0.1, 0.1});
  sim.add_wall(mesh, steel, {.name = "block"});
  sim.run(0);
  sim.set_mesh("block", box_mesh({0.2, -0.1, 0}, {0.3, 0.1, 0.11}));
  CHECK_THROWS_WITH_AS(sim.run(1e-3), doctest::Contains("the mesh of wall 0 'block' deforms"),
                       InputError);
}

}  // namespace sph_driven_walls_test
