// silt - BSD-3-Clause, see LICENSE
// Bodies of every shape that come, leave, or are made others in the middle of a run.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <engine/support.hpp>

#include <silt/io/observers.hpp>
#include <silt/module/field.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace edits_shapes_test {

namespace {

using namespace engine_test;
using silt::InputError;

constexpr double g = 9.81;  // [m/s2]

}  // namespace

// The same scene with a search after every edit: the same forces, summed up in another order.
TEST_CASE("edits: bodies of balls and convex ones that join the lists move as after a search") {
  const auto run = [](const auto& shapes, bool searches) {
    using Particles = std::remove_cvref_t<decltype(shapes)>;
    Particles all = shapes, more = shapes;
    for (int k = 0; k < 256; ++k)
      all.add({.position = {3.2e-3 * (k % 8), 3.2e-3 * (k / 8 % 8), 3.2e-3 * (k / 64) + 2e-3},
               .density = 2500,
               .velocity = {0, 0, -0.2}});
    silt::Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{rubber}};
    sim.gravity = {0, 0, -g};
    sim.threads = 1;
    sim.time_step = 5e-6;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    int births = 0;
    Searches count;
    sim.run(0.01, count, [&](auto& s) {
      if (s.step() % 50 != 20) return;
      Particles one = shapes;
      one.add({.position = {3.2e-3 * (births % 8), 3.2e-3 * (births / 8 % 8), 15e-3},
               .density = 2500,
               .velocity = {0, 0, -0.5}});
      s.add(one);
      if (++births == 4) s.set_velocity(256, {0, 0, -1}), s.set_angular_velocity(256, {100, 0, 0});
      if (births == 5) s.remove(20);
      if (searches) s.engine().lists.forget();
    });
    CHECK(births == 40);
    CHECK(sim.peak_overlap() > 1e-4);
    return std::pair{bits(sim), count.count};
  };
  const auto same = [&](const auto& shapes) {
    const auto [a, few] = run(shapes, false);
    const auto [b, many] = run(shapes, true);
    CHECK(few + 5 < many);
    REQUIRE(a.size() == 295);
    REQUIRE(b.size() == 295);
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[k].values[c] - b[k].values[c]));
    CHECK(most < 1e-9);  // [m] round-off, grown through some impacts
  };
  silt::Particles<silt::MultiSphere> balls;
  balls.add_form(silt::MultiSphere{.balls = {{{-0.6e-3, 0, 0}, 0.8e-3}, {{0.6e-3, 0, 0}, 0.8e-3}}});
  same(balls);
  silt::Particles<silt::SuperEllipsoid> cubes;
  cubes.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.9e-3, .c = 1.1e-3, .s1 = 5, .s2 = 4});
  same(cubes);
}

// A body that is made another size in flight is the one that was made so: mass, inertia, radii, the
// narrow phase's forms. Spins before and after are the same.
TEST_CASE("edits: a particle of another radius falls and rebounds like one that was made so") {
  const auto rebound = [](auto shapes, double made, bool gear) {
    const auto run = [&](auto sim) {
      sim.gravity = {0, 0, -g};
      sim.threads = 1;
      sim.time_step = 1e-6;
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
      if (made == 1e-3) {
        sim.run(1e-3);
        sim.run(1e-3, silt::at(silt::every(0.5e-3), [](auto& s) { s.set_radius(0, 1.3e-3); }));
      } else {
        sim.run(2e-3);
      }
      CHECK(sim.radius(0) == near(1.3e-3).epsilon(1e-12));
      sim.run(0.02);
      CHECK(sim.peak_overlap() > 1e-3);
      return std::array{sim.position(0), sim.velocity(0), sim.angular_velocity(0),
                        Vec3d{sim.mass(0), sim.radius(0), 0}};
    };
    shapes.add({.position = {0, 0, 5e-3},
                .radius = made,
                .density = 2500,
                .velocity = {0.1, 0, -0.5},
                .angular_velocity = {0, 30, 10}});
    const silt::Contacts<HertzMindlin> contacts{rubber};
    if constexpr (std::is_same_v<decltype(shapes), silt::Particles<Sphere>>)
      if (gear) return run(silt::Simulation{std::move(shapes), contacts, silt::Gear{}});
    return run(silt::Simulation{std::move(shapes), contacts});
  };
  const auto same = [&](const auto& shapes, bool gear = false) {
    const auto changed = rebound(shapes, 1e-3, gear), made = rebound(shapes, 1.3e-3, gear);
    for (std::size_t k = 0; k < made.size(); ++k)
      CHECK(norm(changed[k] - made[k]) < 1e-9 * norm(made[k]) + 1e-12);
    CHECK(made[1].z > 0.05);  // it has rebounded
  };
  same(silt::Particles<Sphere>{});
  same(silt::Particles<Sphere>{}, true);
  silt::Particles<silt::MultiSphere> balls;
  balls.add_form(silt::MultiSphere{.balls = {{{-0.6e-3, 0, 0}, 0.8e-3}, {{0.6e-3, 0, 0}, 0.8e-3}}});
  same(balls);
  silt::Particles<silt::SuperEllipsoid> pills;
  pills.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.9e-3, .c = 1.1e-3, .s1 = 5, .s2 = 4});
  same(pills);
  silt::Particles<silt::Polyhedron> cubes;
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(
        {k & 1 ? 0.5e-3 : -0.5e-3, k & 2 ? 0.6e-3 : -0.6e-3, k & 4 ? 0.7e-3 : -0.7e-3});
  cubes.add_form(silt::Polyhedron::from_points(corners));
  same(cubes);
}

// Catches: mass or inertia of the form before, an id or field that is lost, rows of the form before
// that go on touching, velocities of half a step ago taken for those of now.
TEST_CASE("edits: a body that is given another form in flight rebounds as if it had been made so") {
  const auto same = [](auto shapes) {
    const auto rebound = [&](std::size_t made) {
      auto grains = shapes;
      grains.add({.form = made,
                  .position = {0, 0, 5e-3},
                  .radius = 1.2e-3,
                  .density = 2500,
                  .velocity = {0.1, 0, -0.5},
                  .angular_velocity = {0, 30, 0}});  // about an axis of both forms
      silt::Simulation sim{std::move(grains), silt::Contacts<HertzMindlin>{rubber},
                           silt::EnergyLedger{}, silt::Field<"mark">{}};
      sim.gravity = {0, 0, -g};
      sim.threads = 1;
      sim.time_step = 1e-6;
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
      sim.template field<"mark">(0) = 7;
      sim.run(1e-3);
      sim.run(1e-3, silt::at(silt::every(0.5e-3), [](auto& s) {
                if (s.step() == 1500) s.set_form(0, 1);
              }));
      sim.run(0.02);
      const std::size_t k = sim.find(0);
      REQUIRE(k < sim.rows());
      CHECK(sim.size() == 1);
      CHECK(sim.form(k) == 1);
      CHECK(sim.template field<"mark">(k) == 7);
      CHECK(sim.peak_overlap() > 1e-3);
      CHECK(std::abs(sim.energy().residual()) < 1e-3 * sim.energy().turned_over);
      return std::array{sim.position(k), sim.velocity(k), sim.angular_velocity(k),
                        Vec3d{sim.mass(k), sim.radius(k), 0}};
    };
    const auto changed = rebound(0), made = rebound(1);
    for (std::size_t k = 0; k < made.size(); ++k)
      CHECK(norm(changed[k] - made[k]) < 1e-9 * norm(made[k]) + 1e-12);
  };
  silt::Particles<silt::MultiSphere> balls;
  balls.add_form(silt::MultiSphere{.balls = {{{-0.6e-3, 0, 0}, 0.8e-3}, {{0.6e-3, 0, 0}, 0.8e-3}}});
  balls.add_form(silt::MultiSphere{
      .balls = {{{-1e-3, 0, 0}, 0.5e-3}, {{0, 0, 0}, 0.8e-3}, {{1e-3, 0, 0}, 0.5e-3}}});
  same(balls);
  silt::Particles<silt::SuperEllipsoid> pills;
  pills.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.9e-3, .c = 1.1e-3, .s1 = 5, .s2 = 4});
  pills.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.8e-3});
  same(pills);

  silt::Simulation sim{balls, silt::Contacts<HertzMindlin>{rubber}};
  silt::Particles<silt::MultiSphere> one = balls;
  one.add({.position = {0, 0, 5e-3}, .density = 2500});
  sim.add(one);
  CHECK(has_words(refusal<InputError>([&] { sim.set_form(0, 2); }),
                  {"Simulation::set_form", "form 2", "2 forms"}));
  CHECK(has_words(refusal<InputError>([&] { sim.set_form(9, 1); }), {"no particle 9"}));
}

// Catches: a removed body that still counts in the pair list.
TEST_CASE("edits: a convex body that was removed touches nothing") {
  silt::Particles<silt::SuperEllipsoid> pills;
  pills.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 1e-3, .s1 = 4, .s2 = 4});
  for (int k = 0; k < 3; ++k) pills.add({.position = {1.99e-3 * k, 0, 0}, .density = 2500});
  silt::Simulation sim{std::move(pills), silt::Contacts<HertzMindlin>{rubber}};
  sim.threads = 1;
  sim.time_step = 1e-7;
  sim.run(1e-7);
  CHECK(sim.touching_pairs() == 2);
  sim.remove(2);
  CHECK(sim.touching_pairs() == 1);
  sim.remove(1);
  CHECK(sim.touching_pairs() == 0);
}

// Catches: an area of contact that the ellipsoids' contacts never had, read as if they had one;
// springs of friction that are lost, or come back, where a contact gets further points (1e-3
// rad/s).
TEST_CASE("edits: ellipsoids on a floor move as before when the first body with flat sides comes") {
  enum Visit { Never, Comes, ComesAgain };
  const auto roll = [](Visit visit) {
    silt::Particles<silt::SuperEllipsoid> eggs;
    eggs.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.8e-3, .c = 0.9e-3});
    eggs.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 1e-3, .s1 = 6, .s2 = 6});
    auto block = eggs;
    block.add({.form = 1, .position = {0, 0, 0.5}, .density = 2500});
    for (int k = 0; k < 6; ++k)
      eggs.add({.position = {5e-3 * k, 0, 0.899e-3},
                .density = 2500,
                .velocity = {0, 0.05, 0},
                .angular_velocity = {0, 0, 40}});
    silt::Simulation sim{std::move(eggs), silt::Contacts<HertzMindlin>{rubber}};
    sim.gravity = {0, 0, -g};
    sim.threads = 1;
    sim.time_step = 1e-6;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    sim.run(1e-3);
    if (visit == ComesAgain) {
      sim.add(block);
      sim.run(0.5e-3);
      sim.remove(6), sim.engine().lists.forget();
    } else {
      sim.run(0.5e-3);
    }
    sim.run(0.5e-3);
    if (visit != Never) sim.add(block);
    sim.run(2e-3);
    std::array<Vec3d, 6> spins{};
    for (std::size_t id = 0; id < spins.size(); ++id)
      spins[id] = sim.angular_velocity(sim.find(id));
    return spins;
  };
  const auto alone = roll(Never);
  CHECK(norm(alone[0] - Vec3d{0, 0, 40}) > 1);  // [rad/s] the floor acts on them
  for (const Visit visit : {Comes, ComesAgain}) {
    CAPTURE(visit);
    const auto with = roll(visit);
    // 4.5e-5 rad/s is what the area of an ellipsoid's contact resists to its spin.
    for (std::size_t k = 0; k < alone.size(); ++k) CHECK(norm(alone[k] - with[k]) < 1e-4);
  }
}

}  // namespace edits_shapes_test
