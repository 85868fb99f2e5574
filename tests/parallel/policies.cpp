// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/cohesion/capillary_bridge.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/module/body_force.hpp>
#include <silt/module/field.hpp>

#include "rank_scenes.hpp"

namespace parallel_policies_test {

namespace {

using silt::Vec3d;
using silt_test::Seen;
using Ranks = silt::Ranks<silt::ThreadComm, silt_test::WanderingSlabs>;

/// Runs a scene on one process and on three ranks, whose cuts move at each search.
template <class Scene>
std::array<double, 2> off_on_ranks(const Scene& scene) {
  Seen one, many;
  scene(one);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    scene(many, Ranks{comm, {0, 0.11}, {.above = 1, .each = 0, .per_moved = 0}});
  });
  return many.off(one);
}

// The first and the last rank are neighbours; parts by place, of which each takes in what comes.
TEST_CASE("ranks: a ring; a decomposition by place, and particles that come") {
  using Law = silt::HertzMindlin;
  const Law::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
  const silt::PeriodicBox ring{{{0, 0, 0}, {0.11, 0.04, 1}}, {true, false, false}};
  const auto scene = [&](Seen& seen, auto... ranks) {
    silt::Simulation sim{silt_test::cloud(12, 4, 2), silt::Contacts<Law>{glass}, ring, ranks...};
    sim.gravity = {1, 0, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
    sim.add_wall(silt::Plane{{0, 0.04, 0}, {0, -1, 0}}, glass);
    sim.run(0.01);
    const auto more = silt_test::cloud(8, 3, 1);
    silt::Particles<silt::Sphere> above;
    for (auto p : more.all()) p.position.z += 0.03, above.add(p);
    sim.add(above);
    sim.run(0.02);
    seen.add(sim);
  };
  const auto [place, velocity] = off_on_ranks(scene);
  CHECK(place < 1e-12);
  CHECK(velocity < 1e-10);
  Seen one, by_place;
  scene(one);
  silt::run_on_ranks(4, [&](const silt::ThreadComm& comm) {
    scene(by_place, silt::Ranks{comm, silt::Bisection{}});
  });
  CHECK(by_place.off(one)[0] < 1e-12);
}

// What a law remembers in float and of rolling, and of the triangles of a mesh that moves, goes
// with the particles. Sums of floats in another order differ by 1e-7 of the forces.
TEST_CASE("ranks: two materials, rolling, Mixed, a box that repeats, a paddle of triangles") {
  using Law = silt::HertzMindlin;
  const Law::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4},
      steel{.youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.8, .friction = 0.2};
  const auto [place, velocity] = off_on_ranks([&](Seen& seen, auto... ranks) {
    silt::Contacts<Law, silt::SeveralMaterials, silt::RollingEpsd> contacts{
        {glass, steel}, {.rolling_friction = 0.05}};
    contacts.add(glass, "glass"), contacts.add(steel, "steel");
    contacts.set_pair(glass, steel, {.restitution = 0.7, .friction = 0.3});
    silt::Simulation sim{silt_test::cloud(12, 4, 3, 0.0085, 2), contacts, silt::Mixed{},
                         silt::PeriodicBox{{{0, 0, 0}, {1, 0.04, 1}}, {false, true, false}},
                         ranks...};
    sim.gravity = {0, 0.5, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.add_wall(silt::Plane{{0.11, 0, 0}, {-1, 0, 0}}, glass);
    const Vec3d a{0, -0.1, -0.1}, b{0, 0.1, -0.1}, c{0, 0.1, 0.2}, d{0, -0.1, 0.2};
    sim.add_wall(silt::TriangleMesh({{a, b, c}, {a, c, d}}), steel,
                 silt::vibration({0.002, 0, 0}, 20));
    sim.run(0.02);
    seen.add(sim);
  });
  CHECK(place < 1e-8);
  CHECK(velocity < 1e-5);
}

// Liquid bridges act over a gap, and are remembered there: ghosts reach farther.
TEST_CASE("ranks: liquid bridges") {
  using Wet = silt::Cohesive<silt::HertzMindlin, silt::CapillaryBridge>;
  const auto [place, velocity] = off_on_ranks([&](Seen& seen, auto... ranks) {
    const Wet::Material wet{
        {.youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4},
        {.surface_tension = 0.07, .contact_angle = 0.2, .volume = 2e-9}};
    silt::Simulation sim{silt_test::cloud(12, 4, 3), silt::Contacts<Wet>{wet}, ranks...};
    sim.gravity = {1, 0, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wet);
    sim.run(0.02);
    seen.add(sim);
  });
  CHECK(place < 1e-12);
  CHECK(velocity < 1e-10);
}

// The integrator's derivatives, fields and forces of modules.
TEST_CASE("ranks: Gear, a field and a force that reads it") {
  using Law = silt::HertzMindlin;
  const Law::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
  const auto [place, velocity] = off_on_ranks([&](Seen& seen, auto... ranks) {
    silt::Simulation sim{silt_test::cloud(12, 4, 3),
                         silt::Contacts<Law>{glass},
                         silt::Gear{},
                         silt::Field<"charge">{.initial = 1e-3},
                         silt::BodyForce{silt::Field<"charge">{},
                                         [](const silt::Seen& p, double charge) {
                                           return Vec3d{charge * p.position.y, 0, 0};
                                         }},
                         ranks...};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<"charge">(k) = 1e-3 * static_cast<double>(sim.id(k) % 7);
    sim.gravity = {1, 0, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.run(0.02);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      CHECK(sim.template field<"charge">(k) == 1e-3 * static_cast<double>(sim.id(k) % 7));
    seen.add(sim);
  });
  CHECK(place < 1e-12);
  CHECK(velocity < 1e-10);
}

// Catches: ranks that choose steps of their own, as each knows its own particles' forces alone.
TEST_CASE("ranks: where a module pushes on one rank alone, all take the step of one process") {
  using Law = silt::HertzMindlin;
  const Law::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
  const auto step_of = [&](auto... ranks) {
    silt::Simulation sim{silt_test::cloud(12, 4, 1), silt::Contacts<Law>{glass},
                         silt::BodyForce{[](const silt::Seen& p) {
                           return Vec3d{p.position.x > 0.09 ? 0.05 : 0.0, 0, 0};
                         }},
                         ranks...};
    sim.threads = 1;
    sim.run(0);
    return sim.step_length();
  };
  const double one = step_of();
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    CHECK(step_of(silt::Ranks{comm, silt_test::WanderingSlabs{0, 0.11}}) == one);
  });
}

}  // namespace

}  // namespace parallel_policies_test
