// silt - BSD-3-Clause, see LICENSE
//
// What follows from contacts: stress, coordination, fabric, loads on fixed particles and on parts
// of walls; against statics.
#include <cmath>
#include <filesystem>

#include "engine/support.hpp"
#include "near.hpp"

#include <silt/measure/coordination.hpp>
#include <silt/measure/stress.hpp>
#include <silt/measure/wall_loads.hpp>

namespace measures_test {

using namespace engine_test;
using silt::Particles;

/// Without friction, and with losses that bring all to rest.
inline constexpr HertzMindlin::Material smooth{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.2, .friction = 0};

template <class... Policies>
auto scene(Particles<Sphere> p, const HertzMindlin::Material& m, const Policies&... policies) {
  return silt::Simulation{std::move(p), silt::Contacts<HertzMindlin>{m}, policies...};
}

TEST_CASE("stress: in a column at rest the mean weight above, over the area") {
  // Nine spheres on each other. A stress by contact points, or without the branch to the floor,
  // would err by half a weight near the floor.
  Particles<Sphere> p;
  for (int k = 0; k < 9; ++k)
    p.add({.position = {0, 0, (1 + 1.99 * k) * 1e-3}, .radius = 1e-3, .density = 2500.0 + 100 * k});
  auto sim = scene(std::move(p), smooth);
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  sim.run(0.5);
  for (const auto& [low, high] : {std::pair{0.0, 20e-3}, std::pair{0.0, 0.7e-3},
                                  std::pair{3.3e-3, 9.1e-3}, std::pair{12e-3, 30e-3}}) {
    double weight = 0;  // [N] above, mean over the heights of the region
    for (std::size_t k = 0; k < sim.rows(); ++k)
      weight += 9.81 * sim.mass(k) * std::clamp((sim.position(k).z - low) / (high - low), 0.0, 1.0);
    const auto s = silt::stress(sim, {{-2e-3, -3e-3, low}, {2e-3, 3e-3, high}});
    const double area = 4e-3 * 6e-3;
    // What is left of the motion: accelerations of 1e-5 g.
    CHECK(s.contact.zz * area == near(weight).epsilon(1e-4));
    CHECK(std::abs(s.contact.xx) < 1e-9 * s.contact.zz);
    CHECK(s.kinetic.zz < 1e-4 * s.contact.zz);
  }
  const auto loads = silt::contact_loads(sim);
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    CHECK(loads[k].force.z == near(9.81 * sim.mass(k)).epsilon(1e-2));
    CHECK(loads[k].contacts == (sim.id(k) == 8 ? 1 : 2));
  }
  const auto refused = refusal<silt::InputError>([&] {
    silt::stress(sim, {{0, 0, 0}, {1, 0, 1}});
  });
  CHECK(has_words(refused, {"stress: the region", "must have a volume"}));
}

/// A lid that comes down by 8.9 mm within 20 ms and then stays.
silt::Pose lid(double t) {
  const double s = std::min(t / 0.02, 1.0);
  return {{}, {0, 0, -8.9e-3 * s * s * (3 - 2 * s)}};
}
auto compressed() {
  Particles<Sphere> p;
  p.fill({{0, 0, 0}, {10e-3, 10e-3, 15e-3}}, {.radius = silt::uniform(0.8e-3, 1.1e-3),
                                              .density = 2500,
                                              .count = 110,
                                              .arrangement = silt::Arrangement::Random});
  auto sim = scene(std::move(p), smooth);
  const double w = 10e-3;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, smooth);
  sim.add_wall(silt::Plane{{w, 0, 0}, {-1, 0, 0}}, smooth);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, smooth);
  sim.add_wall(silt::Plane{{0, w, 0}, {0, -1, 0}}, smooth);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  sim.add_wall(silt::Plane{{0, 0, 15e-3}, {0, 0, -1}}, smooth, lid);
  sim.guard.max_overlap = 0.6;
  sim.time_step = 1e-5;
  return sim;
}

TEST_CASE("stress: of a compressed box the pressure on its walls, whole and in halves") {
  auto sim = compressed();
  sim.run(0.15);
  const double w = 10e-3, h = 6.1e-3;
  const auto s = silt::stress(sim, {{-1e-6, -1e-6, -1e-6}, {w, w, h}});
  const auto on = [&](std::size_t k) { return sim.wall(k).force; };
  CHECK(s.contact.xx > 1000);
  // Of all at rest sum F l is the moment of the walls' forces.
  CHECK(s.contact.xx == near(on(1).x / (w * h)).epsilon(1e-3));
  CHECK(s.contact.yy == near(on(3).y / (w * h)).epsilon(1e-3));
  CHECK(s.contact.zz == near(on(5).z / (w * w)).epsilon(1e-3));
  CHECK(s.pressure() == near(s.contact.trace() / 3).epsilon(1e-3));
  // Every plane across z bears what the lid bears, so that each part of the height has the same zz.
  for (const double from : {0.5e-3, 1.7e-3}) {
    const auto part = silt::stress(sim, {{-1e-6, -1e-6, from}, {w, w, from + 4e-3}});
    CHECK(part.contact.zz == near(s.contact.zz).epsilon(2e-3));
  }
  // Parts that leave no gap add up.
  const auto low = silt::stress(sim, {{-1e-6, -1e-6, -1e-6}, {4e-3, w, h}}),
             high = silt::stress(sim, {{4e-3, -1e-6, -1e-6}, {w, w, h}});
  CHECK(0.4 * low.contact.yy + 0.6 * high.contact.yy == near(s.contact.yy).epsilon(1e-3));
  // In all directions alike but for the lid's way: fabric, and contacts enough to be rigid.
  const auto f = silt::fabric(sim);
  CHECK(f.trace() == near(1).epsilon(1e-12));
  CHECK(f.xx == near(1.0 / 3).epsilon(0.15));
  const auto z = silt::coordination(sim, {.least = 4});
  CHECK(z.without_rattlers > 5.5);  // 6 of frictionless spheres at the limit of rigidity
  CHECK(z.without_rattlers < 9);
  CHECK(z.mean <= z.without_rattlers);
}

#ifdef SILT_LONG_TESTS
TEST_CASE("stress: of a periodic crystal that is pressed together, in closed form") {
  // A simple cubic lattice whose spheres overlap by d: F/a^2 along each axis, also where branches
  // go through the sides of the box.
  Particles<Sphere> p;
  const double a = 1.98e-3;
  for (int k = 0; k < 64; ++k)
    p.add({.position = {a * (k % 4 + 0.1), a * (k / 4 % 4 + 0.1), a * (k / 16 + 0.1)},
           .radius = 1e-3,
           .density = 2500});
  auto sim = scene(std::move(p), smooth,
                   silt::PeriodicBox{{{0, 0, 0}, {4 * a, 4 * a, 4 * a}}, {true, true, true}});
  sim.time_step = 1e-6;
  sim.run(0);
  double force = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) { force = c.normal_force; });
  const auto s = silt::stress(sim, {{0, 0, 0}, {4 * a, 4 * a, 4 * a}});
  // Of a region far beyond the box it would be averaged over nothing.
  const auto beyond = refusal<silt::InputError>([&] {
    silt::stress(sim, {{-1, -1, -1}, {1, 1, 1}});
  });
  CHECK(has_words(beyond, {"stress: the region", "reaches beyond the box that repeats"}));
  for (const double part : {s.contact.xx, s.contact.yy, s.contact.zz})
    CHECK(part == near(force / (a * a)).epsilon(1e-9));
  CHECK(std::abs(s.contact.xy) < 1e-9 * s.contact.xx);
  const auto z = silt::coordination(sim);
  CHECK(z.mean == 6);
  CHECK(z.without_rattlers == 6);
  CHECK(silt::fabric(sim).xx == near(1.0 / 3).epsilon(1e-9));
}
#endif

TEST_CASE("stress: of a gas that does not touch, the square of its velocities") {
  Particles<Sphere> p;
  for (int k = 0; k < 6; ++k)
    p.add({.position = {(5.0 * k + 2) * 1e-3, 0, 0},
           .radius = 1e-3,
           .density = 2500,
           .velocity = {k % 2 ? 0.3 : -0.1, k % 3 == 0 ? 0.2 : 0.0, 0}});
  auto sim = scene(std::move(p), smooth);
  sim.run(0);
  const auto s = silt::stress(sim, {{0, -1e-3, -1e-3}, {30e-3, 1e-3, 1e-3}});
  const double n = 6 / (30e-3 * 4e-6), m = sim.mass(0);  // [1/m3], [kg]
  CHECK(s.velocity.x == near(0.1).epsilon(1e-9));
  CHECK(s.kinetic.xx == near(n * m * 0.04).epsilon(1e-9));
  CHECK(s.kinetic.yy == near(n * m * (0.04 / 3 - 0.04 / 9)).epsilon(1e-9));
  CHECK(s.density == near(n * m).epsilon(1e-9));
  CHECK(s.contact.trace() == 0);
}

TEST_CASE("coordination: a chain between two walls, and a rattler") {
  Particles<Sphere> p;
  for (int k = 0; k < 3; ++k)
    p.add({.position = {(1 + 1.98 * k - 0.01) * 1e-3, 0, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {3e-3, 0.01, 0}, .radius = 1e-3, .density = 2500});
  auto sim = scene(std::move(p), smooth);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, smooth);
  sim.add_wall(silt::Plane{{5.94e-3, 0, 0}, {-1, 0, 0}}, smooth);
  sim.time_step = 1e-6;
  sim.run(0);
  const auto z = silt::coordination(sim);
  for (std::size_t k = 0; k < 4; ++k) CHECK(z.of[k] == (sim.id(k) == 3 ? 0u : 2u));
  CHECK(z.mean == 1.5);
  CHECK(z.without_rattlers == 2);
  CHECK(z.rattlers == 1);
  // Without walls nothing holds the ends, then nothing the middle.
  const auto alone = silt::coordination(sim, {.walls = false});
  CHECK(alone.mean == 1);
  CHECK(alone.rattlers == 4);
  CHECK(alone.without_rattlers == 0);
  const auto middle =
      silt::coordination(sim, {.region = silt::Box{{2e-3, -1e-3, -1}, {4e-3, 1e-3, 1}}});
  CHECK(middle.particles == 1);
  CHECK(middle.mean == 2);
  CHECK(silt::fabric(sim).xx == near(1).epsilon(1e-12));
}

TEST_CASE("loads of parts of walls: rings of a silo and facets of its floor add up to the walls'") {
  Particles<Sphere> p;
  p.fill({{-4e-3, -4e-3, 0}, {4e-3, 4e-3, 40e-3}},
         {.radius = silt::uniform(0.8e-3, 1e-3), .density = 2500, .count = 250});
  auto sim = scene(std::move(p), rubber);
  sim.gravity = {0, 0, -9.81};
  sim.guard.max_overlap = 0.6;
  sim.add_wall(silt::Cylinder{{0, 0, -1e-3}, {0, 0, 59e-3}, 6e-3, silt::Side::Inside}, rubber);
  const silt::Vec3d a{-8e-3, -8e-3, 0}, b{8e-3, -8e-3, 0}, c{8e-3, 8e-3, 0}, d{-8e-3, 8e-3, 0};
  // It sinks by 1 mm/s, so that the mantle holds the grains.
  sim.add_wall(silt::TriangleMesh({{a, b, c}, {a, c, d}}), rubber,
               {.name = "floor", .motion = silt::translation({0, 0, -1e-3})});
  sim.run(0.4);
  const auto rings = silt::ring_loads(sim, 0, 12);
  const auto facets = silt::facet_loads(sim, 1);
  REQUIRE(rings.size() == 12);
  REQUIRE(facets.size() == 2);
  const auto total = [](const auto& parts) {
    silt::Vec3d sum{0, 0, 0};
    for (const auto& part : parts) sum += part.force;
    return sum;
  };
  double weight = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) weight += 9.81 * sim.mass(k);
  CHECK(norm(total(rings) - sim.wall(0).force) < 1e-12 * weight);
  CHECK(norm(total(facets) - sim.wall(1).force) < 1e-12 * weight);
  // Together they bear the grains, and friction at the wall a good part of them (Janssen).
  CHECK(-(total(rings).z + total(facets).z) == near(weight).epsilon(1e-2));
  CHECK(-total(rings).z > 0.1 * weight);
  for (const auto& f : facets) {
    CHECK(f.area == near(128e-6).epsilon(1e-9));
    CHECK(f.pressure() == near(-f.force.z / f.area).epsilon(1e-9));
    CHECK(f.contacts > 10);
  }
  CHECK(rings[0].area == near(2 * M_PI * 6e-3 * 5e-3).epsilon(1e-9));
  CHECK(rings[1].pressure() > rings[2].pressure());  // it grows with depth
  CHECK(rings[11].contacts == 0);
  const std::string path = std::filesystem::temp_directory_path() / "silt_facets.vtp";
  silt::write_facet_loads(path, sim, "floor");
  CHECK(std::filesystem::file_size(path) > 6 * 24);
  std::filesystem::remove(path);

  const auto no_mesh = refusal<silt::InputError>([&] { silt::facet_loads(sim, 0); });
  CHECK(has_words(no_mesh, {"facet_loads: surface 0 of wall 0", "not a triangle mesh"}));
  const auto no_ring = refusal<silt::InputError>([&] { silt::ring_loads(sim, 1, 3); });
  CHECK(has_words(no_ring, {"ring_loads: surface 0 of wall 1 'floor'", "not a Cylinder"}));
  const auto none = refusal<silt::InputError>([&] { silt::ring_loads(sim, 0, 0); });
  CHECK(has_words(none, {"rings = 0", "at least 1"}));
}

}  // namespace measures_test
