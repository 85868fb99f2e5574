// silt - BSD-3-Clause, see LICENSE
// Particles bonded to walls without their contact: it is gone while the bond holds, and begins
// without a push when the bond breaks.
//   a contact that goes on acting; one that stays away after the break, so that walls let grains
//   through; a push by what they overlap by; a restart that forgets which contacts are excluded
#include <cmath>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/boundary/finite_walls.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_wall_contact_test {

using silt::Vec3d, silt::WallContact;
constexpr double R = 1e-3, E = 1e7, pi = 3.14159265358979323846;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.9, .friction = 0.5};

enum class Floor { Plane, Moving, Mesh };

/// A sphere sunk into the floor by `depth` [m], flying down at `speed` [m/s].
template <class Precision = silt::Double>
auto scene(Floor floor, double depth, double speed, double strength = INFINITY) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0.1e-3, 0.2e-3, R - depth},
           .radius = R,
           .density = 2000,
           .velocity = {0, 0, -speed}});
  silt::Simulation sim{std::move(one), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{silt::ParallelBond{
                           .youngs_modulus = E, .tensile_strength = strength, .damping = 0}},
                       silt::EnergyLedger{}, Precision{}};
  sim.threads = 1;
  if (floor == Floor::Plane)
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, {.name = "floor"});
  if (floor == Floor::Moving)  // along itself, so slowly that friction does nothing
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass,
                 {.name = "floor", .motion = silt::translation({1e-12, 0, 0})});
  if (floor == Floor::Mesh)
    sim.add_wall(silt::rectangle({-9 * R, -9 * R, 0}, {20 * R, 0, 0}, {0, 20 * R, 0}), glass,
                 {.name = "floor"});
  return sim;
}
const Vec3d below{0.1e-3, 0.2e-3, -R};
constexpr Floor floors[] = {Floor::Plane, Floor::Moving, Floor::Mesh};

TEST_CASE("bonds to walls: an excluded contact does nothing, the bond alone swings") {
  for (const Floor floor : floors) {
    CAPTURE(static_cast<int>(floor));
    auto sim = scene(floor, 0, 0.05);
    sim.bond_to_wall(0, "floor", below, WallContact::Excluded);
    CHECK(sim.bonds() == 1);
    const double k = E * pi * R * R / (2 * R), w = std::sqrt(k / sim.mass(0));
    sim.run(0.5 * pi / w);
    // A quarter of a swing: the deepest point, v/w under the start; the contact would stop it.
    CHECK(sim.position(0).z - R == near(-0.05 / w).epsilon(2e-3));
    CHECK(sim.energy().normal == 0);
    CHECK(sim.touching_pairs() == 0);
    sim.run(pi / w);
    CHECK(sim.position(0).z - R == near(0.05 / w).epsilon(2e-3));
    // One whose contact acts beside the bond is stopped earlier.
    auto beside = scene(floor, 0, 0.05);
    beside.bond_to_wall(0, "floor", below);
    beside.run(0.5 * pi / w);
    CHECK(R - beside.position(0).z < 0.995 * 0.05 / w);
    CHECK(beside.energy().normal > 0);
  }
}

TEST_CASE("bonds to walls: a bond that breaks gives no push, and its wall holds from then on") {
  for (const Floor floor : floors) {
    CAPTURE(static_cast<int>(floor));
    // It is pulled up through the strength, deep within the floor, and thrown back down later.
    const double depth = 0.1 * R, speed = 0.02;
    auto sim = scene(floor, depth, -speed, 1e3);
    sim.bond_to_wall(0, "floor", below, WallContact::Excluded);
    sim.run(1e-4);
    REQUIRE(sim.broken_bonds() == 1);
    REQUIRE(R - sim.position(0).z > 0.5 * depth);  // it is in the floor still
    sim.run(1e-3);
    // The break has cost what the bond held, and the contact has given nothing.
    CHECK(sim.velocity(0).z < speed);
    const auto e = sim.energy();
    CHECK(0.5 * sim.mass(0) * std::pow(sim.velocity(0).z, 2) + e.bond_breaking ==
          near(e.initial).epsilon(1e-3));  // of second order in the step
    CHECK(e.normal == 0);
    // What falls on the floor now meets it with nothing left out.
    sim.run(10 * depth / speed);
    REQUIRE(sim.position(0).z > R);
    sim.set_velocity(0, {0, 0, -0.1});
    sim.run(3 * (sim.position(0).z - R) / 0.1 + 2e-3);
    CHECK(sim.velocity(0).z == near(0.09).epsilon(0.02));
    // One that is pressed down after the break is held at once, by what it goes deeper.
    auto pressed = scene(floor, depth, -speed, 1e3);
    pressed.bond_to_wall(0, "floor", below, WallContact::Excluded);
    pressed.run(1e-4);
    REQUIRE(pressed.broken_bonds() == 1);
    const double deep = R - pressed.position(0).z;
    pressed.set_velocity(0, {0, 0, -0.05});
    pressed.run(1e-3);
    CHECK(pressed.velocity(0).z > 0);
    CHECK(R - pressed.position(0).z < deep);
  }
}

TEST_CASE("bonds to walls: the last of two bonds lets the contact begin; Mixed as well") {
  auto sim = scene<silt::Mixed>(Floor::Plane, 0.05 * R, -0.05, 1e3);
  sim.bond_to_wall(0, "floor", below, WallContact::Excluded);
  sim.bond_to_wall(0, "floor", {0.1e-3, 0.2e-3, -30 * R}, WallContact::Excluded);
  std::size_t most = 0;
  sim.run(5e-4, silt::at(silt::every(1e-6), [&](const auto& s) {
            if (s.bonds() == 1) most = std::max(most, s.touching_pairs());
          }));
  CHECK(most == 0);
  REQUIRE(sim.broken_bonds() == 2);
  CHECK(sim.velocity(0).z > 0);
  CHECK(sim.velocity(0).z < 0.05);
}

TEST_CASE("bonds to walls: a restart goes on with the same bits, whatever is excluded") {
  const auto file = (std::filesystem::temp_directory_path() / "silt_wall_contact.silt").string();
  for (const Floor floor : floors)
    for (const double until : {4e-6, 1e-4}) {  // before the break and after it
      CAPTURE(static_cast<int>(floor));
      CAPTURE(until);
      auto whole = scene(floor, 0.1 * R, -0.02, 1e3);
      whole.bond_to_wall(0, "floor", below, WallContact::Excluded);
      whole.run(until);
      REQUIRE(whole.broken_bonds() == (until > 1e-5));
      save_checkpoint(whole, file);
      const auto go_on = [](auto& sim) {  // on through the break, and down onto the floor
        sim.run(1e-4);
        REQUIRE(sim.broken_bonds() == 1);
        sim.set_velocity(0, {0, 0, -0.05});
        sim.run(1e-3);
      };
      go_on(whole);
      auto second = scene(floor, 0.1 * R, -0.02, 1e3);
      load_checkpoint(second, file);
      go_on(second);
      CHECK(second.velocity(0).z > 0);
      CHECK(second.position(0) == whole.position(0));
      CHECK(second.velocity(0) == whole.velocity(0));
      CHECK(second.broken_bonds() == whole.broken_bonds());
    }
  std::filesystem::remove(file);
}

}  // namespace bond_wall_contact_test
