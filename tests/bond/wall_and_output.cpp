// silt - BSD-3-Clause, see LICENSE
// Bonds to walls, breaks as events, bonds as lines in files, and what is refused.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/bond_observers.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace bond_wall_test {

using silt::Vec3d;
constexpr double R = 1e-3, E = 1e7, pi = 3.14159265358979323846;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};

auto scene(const silt::ParallelBond& model = {.youngs_modulus = E, .damping = 0.3}) {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{model}, silt::EnergyLedger{}};
  sim.threads = 1;
  return sim;
}

TEST_CASE("bonds to walls: a fibre hangs by its weight, and its wall bears it") {
  auto sim = scene();
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, -1}}, glass, {.name = "ceiling"});
  const auto first =
      add_bonded(sim, silt::fibre({0, 0, -R}, {0, 0, -19 * R}, 10, {.radius = R, .density = 2000}));
  sim.bond_to_wall(first, "ceiling", {0, 0, 0});
  CHECK(sim.bonds() == 10);
  const double weight = sim.total_mass() * 9.81;
  sim.run(0.2);
  CHECK(sim.wall("ceiling").force.z == near(-weight).epsilon(1e-6));
  // Ten weights hang on the first bond of half the length, nine on the next, ...
  const double k = E * pi * R * R / (2 * R), m = weight / 10;
  CHECK(sim.position(sim.find(first)).z + R == near(-weight / (2 * k)).epsilon(1e-4));
  CHECK(sim.position(sim.find(first + 9)).z + 19 * R ==
        near(-weight / (2 * k) - m * (9 * 10 / 2) / k).epsilon(1e-4));
  CHECK(std::abs(sim.energy().residual()) < 1e-6 * sim.energy().dissipated());
}

TEST_CASE("bonds to walls: a wall that turns takes its fibre with it, and feels its torque") {
  auto sim = scene();
  const double rate = 20;  // [rad/s]
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass,
               {.name = "disc",
                .motion = silt::Rotation{.centre = {0, 0, 0}, .axis = {0, 0, 1}, .rate = rate}});
  const auto first = add_bonded(
      sim, silt::fibre({10 * R, 0, R}, {10 * R, 0, 5 * R}, 3, {.radius = R, .density = 2000}));
  sim.bond_to_wall(first, "disc", {10 * R, 0, 0});
  sim.run(0.3);
  // It has come to turn with the wall, held by a force inwards.
  for (silt::ParticleId id = first; id < first + 3; ++id) {
    const auto k = sim.find(id);
    CHECK(norm(sim.velocity(k)) ==
          near(rate * std::hypot(sim.position(k).x, sim.position(k).y)).epsilon(1e-3));
    CHECK(sim.angular_velocity(k).z == near(rate).epsilon(1e-3));
  }
  const auto& wall = sim.wall("disc");
  const double inwards = sim.total_mass() * rate * rate * 10 * R;
  CHECK(std::hypot(wall.force.x, wall.force.y) == near(inwards).epsilon(0.01));
  // What the wall has worked is the fibre's motion and what dashpots took.
  const auto e = sim.energy();
  CHECK(e.walls == near(e.kinetic() + e.bonds + e.dissipated()).epsilon(1e-4));
  CHECK(e.kinetic() > 0.5 * 0.99 * sim.total_mass() * std::pow(rate * 10 * R, 2));
}

TEST_CASE("bonds to walls: a wall clamps a cantilever as a fixed sphere in its place does") {
  // The last of five bonds ends at the wall, or at a sphere that is fixed there. Catches a bond
  // that bends at the wall instead of in its middle: the tip moves by 11 % more. 1e-7: a bond
  // between spheres has its numbers in single precision.
  const auto tip = [](bool by_wall) {
    auto sim = scene({.youngs_modulus = E, .damping = 0.2});
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass, {.name = "clamp"});
    const auto first = add_bonded(
        sim, silt::fibre({2 * R, 0, 0}, {10 * R, 0, 0}, 5, {.radius = R, .density = 2000}));
    if (by_wall) {
      sim.bond_to_wall(first, "clamp", {0, 0, 0}, silt::WallContact::Excluded);
    } else {
      sim.remove_wall("clamp");
      silt::Particles<silt::Sphere> end;
      end.add({.position = {0, 0, 0}, .radius = R, .density = 2000, .fixed = true});
      sim.add(end);
      sim.bond(first, first + 5);
    }
    sim.time_step = 1e-6;
    sim.run(0.02);
    return sim.position(sim.find(first + 4)).z;
  };
  const double sphere = tip(false);
  CHECK(sphere < -1e-9);
  CHECK(tip(true) == near(sphere).epsilon(1e-6));
}

TEST_CASE("bonds: breaks are told with their ends, load and energy, those of walls too") {
  auto sim = scene({.youngs_modulus = E, .tensile_strength = 1e4, .damping = 0});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, {.name = "floor"});
  add_bonded(sim, silt::fibre({0, 0, R}, {0, 0, 3 * R}, 2, {.radius = R, .density = 2000}));
  sim.bond_to_wall(0, "floor", {0, 0, 0});
  sim.set_velocity(1, {0, 0, 0.5}), sim.set_velocity(0, {0, 0, 0.2});
  std::vector<silt::BondBreak> all;
  sim.run(2e-3, silt::on_bond_break([&](const silt::BondBreak& b) { all.push_back(b); }));
  REQUIRE(all.size() == 2);
  CHECK(sim.broken_bonds() == 2);
  CHECK(sim.bonds() == 0);
  double lost = 0;
  for (const auto& b : all) {
    CHECK(b.load > 1);
    CHECK(b.load < 1.2);  // within a step
    CHECK(b.time > 0);
    lost += b.energy;
    if (b.b == silt::no_particle) {
      CHECK(b.wall == 0);
      CHECK(b.a == 0);
      CHECK(b.normal.z == near(1));
      CHECK(b.force.z < 0);
    } else {
      CHECK((b.a == 0 && b.b == 1));
      CHECK(b.wall == static_cast<std::size_t>(-1));
      // Bonds keep their numbers in single precision.
      CHECK(dot(b.force, b.normal) == near(-1e4 * pi * R * R * b.load).epsilon(1e-6));
      CHECK(b.to.z < b.from.z);
    }
  }
  CHECK(lost == near(sim.energy().bond_breaking).epsilon(1e-12));
}

TEST_CASE("bonds: particles that leave take their bonds with them") {
  auto sim = scene();
  const auto first =
      add_bonded(sim, silt::fibre({0, 0, 0}, {8 * R, 0, 0}, 5, {.radius = R, .density = 2000}));
  sim.set_velocity(first, {0.01, 0, 0});
  sim.run(1e-4);
  sim.remove(first + 2);
  CHECK(sim.bonds() == 2);
  CHECK(!sim.bonded(first + 1, first + 2));
  sim.run(1e-3);
  CHECK(sim.bonds() == 2);
  CHECK(sim.broken_bonds() == 0);
  const auto parts = silt::fragments(sim);
  CHECK(parts.spheres == std::vector<std::size_t>{2, 2});
  // Who comes now may be bonded to who is left.
  silt::Particles<silt::Sphere> more;
  more.add({.position = {-2 * R, 0, 0}, .radius = R, .density = 2000});
  sim.add(more);
  sim.bond(first + 5, first);
  sim.run(1e-3);
  CHECK(silt::fragments(sim).spheres == std::vector<std::size_t>{3, 2});
  // A loose one is a fragment of its own, but none of bonded ones.
  more[0].position.x = -8 * R;
  sim.add(more);
  CHECK(silt::fragments(sim).spheres == std::vector<std::size_t>{3, 2, 1});
  CHECK(silt::fragments(sim).bonded() == 2);
}

TEST_CASE("bonds: write_bonds and bond_series write a line for each, with its loads") {
  auto sim = scene();
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, -1}}, glass, {.name = "ceiling"});
  add_bonded(sim, silt::fibre({0, 0, -R}, {0, 0, -7 * R}, 4, {.radius = R, .density = 2000}));
  sim.bond_to_wall(0, "ceiling", {0, 0, 0});
  const auto folder = (std::filesystem::temp_directory_path() / "silt_bond_series").string();
  sim.run(1e-3, silt::bond_series(folder, silt::every(5e-4)));
  std::size_t files = 0;
  for (const auto& f : std::filesystem::directory_iterator(folder)) {
    if (f.path().extension() == ".pvd") continue;
    std::ifstream in(f.path(), std::ios::binary);
    std::stringstream whole;
    whole << in.rdbuf();
    CHECK(whole.str().find("NumberOfLines=\"4\"") != std::string::npos);
    for (const char* name : {"normal_force", "shear_force", "twisting", "bending", "load", "energy",
                             "\"a\"", "\"b\"", "wall", "number"})
      CHECK(whole.str().find(name) != std::string::npos);
    ++files;
  }
  CHECK(files == 3);
  std::filesystem::remove_all(folder);
}

TEST_CASE("bonds: what cannot be bonded is refused, and steps that are too long") {
  auto sim = scene({.youngs_modulus = 1e10, .damping = 0.1});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, glass, {.name = "floor"});
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = R, .density = 2000});
  p.add({.position = {2 * R, 0, 0}, .radius = R, .density = 2000});
  p.add({.position = {9 * R, 0, 0}, .radius = R, .density = 2000, .fixed = true});
  p.add({.position = {11 * R, 0, 0}, .radius = R, .density = 2000, .fixed = true});
  sim.add(p);
  const auto refused = [&](const auto& act, const char* words) {
    const auto said = silt_test::refusal(act);
    CAPTURE(said);
    CHECK(silt_test::has(said, words));
  };
  refused([&] { sim.bond(0, 7); }, "there is no particle 7");
  refused([&] { sim.bond(1, 1); }, "particle 1 cannot be bonded to itself");
  refused([&] { sim.bond(2, 3); }, "particles 2 and 3 are both fixed");
  sim.bond(0, 1);
  refused([&] { sim.bond(1, 0); }, "particles 0 and 1 are bonded already");
  refused([&] { sim.bond_to_wall(0, "roof", {0, 0, -1}); }, "roof");
  refused([&] { sim.bond_to_wall(7, "floor", {0, 0, -1}); }, "there is no particle 7");
  refused([&] { sim.bond_to_wall(2, "floor", {0, 0, -1}); }, "particle 2 is fixed");
  refused([&] { sim.bond_to_wall(0, "floor", {0, 0, 0}); }, "is the centre of particle 0");
  refused([&] { sim.bond_to_wall(0, "floor", {0, NAN, 0}); }, "must be finite");
  {
    auto twice = scene();
    twice.add(p);
    twice.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, glass, {.name = "floor"});
    twice.bond_to_wall(0, "floor", {0, 0, -1});
    refused([&] { twice.bond_to_wall(0, "floor", {0, 0, -1}); }, "at (0, 0, -1) m already");
  }
  CHECK(sim.bonds() == 1);
  // The chosen step resolves the bonds; a bond that is too stiff for a step is named.
  sim.set_velocity(0, {0.01, 0, 0});
  sim.time_step = 1e-6;  // contacts would allow 6e-5
  refused([&] { sim.run(1e-3); }, "is too long for the bonds of particle");
  sim.time_step.reset();
  sim.run(1e-3);
  CHECK(std::abs(sim.energy().residual()) < 1e-3 * sim.energy().initial);
  // One that is added between two runs, too: a step of one's own is refused, silt's own is cut.
  for (const bool own : {true, false}) {
    auto soft = scene({.youngs_modulus = 1e10});
    soft.add(p);
    soft.set_velocity(0, {0.01, 0, 0});
    if (own) soft.time_step = 1e-5;
    soft.run(1e-4);
    const double before = soft.step_length();
    soft.bond(0, 1);
    if (own) {
      refused([&] { soft.run(1e-4); }, "is too long for the bonds of particle");
    } else {
      soft.run(1e-4);
      CHECK(soft.step_length() < 0.1 * before);
    }
  }
  // Dashpots count: what is stable without them is not with strong ones, and silt's step is
  // shorter.
  double steps[2];
  for (const int strong : {0, 1}) {
    auto damped = scene({.youngs_modulus = 1e10, .damping = strong ? 5.0 : 0.1});
    damped.add(p);
    damped.bond(0, 1), damped.set_velocity(0, {0.01, 0.01, 0});
    damped.run(1e-5);
    steps[strong] = damped.step_length();
    CHECK(damped.energy().kinetic() + damped.energy().bonds < damped.energy().initial);
    if (!strong) continue;
    damped.time_step = 2 * steps[0];
    refused([&] { damped.run(1e-3); }, "is too long for the bonds of particle");
  }
  CHECK(steps[1] < 0.5 * steps[0]);
  refused([] { silt::fibre({0, 0, 0}, {1, 0, 0}, 1, {}); }, "must be at least 2");
  refused([] { silt::sheet({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, 3, 3, {}); }, "span no area");
}

}  // namespace bond_wall_test
