// silt - BSD-3-Clause, see LICENSE
// What passes a surface, of particles of several kinds: materials, bodies, fragments.
#include <array>
#include <utility>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/measure/passing_counter.hpp>
#include <silt/shape/multi_sphere.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"

namespace passing_kinds_test {

namespace {

using namespace engine_test;
using silt::PassingCounter;

/// Beads of 64 sizes that fly down without touching.
silt::Particles<Sphere> shower() {
  silt::Particles<Sphere> beads;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      beads.add({.position = {3e-3 * (i - 3.5), 3e-3 * (j - 3.5), 1e-3 + 1e-4 * (i + 3 * j)},
                 .radius = 0.5e-3 + 1e-5 * (8 * i + j),
                 .density = 2500,
                 .velocity = {0, 0, -1}});
  return beads;
}

// Catches: a predicate that is ignored, or asked about another particle.
TEST_CASE("passing: of two materials each, and of all") {
  silt::Particles<Sphere> beads = shower(), mixed;
  std::size_t n = 0;
  for (auto p : beads.all()) p.material = n++ % 3 == 0 ? 1 : 0, mixed.add(p);
  HertzMindlin::Material other = rubber;
  other.restitution = 0.3;
  silt::Simulation sim{std::move(mixed),
                       silt::Contacts<HertzMindlin, silt::SeveralMaterials>{{rubber, other}}};
  sim.set_pair(0, 1, {.restitution = 0.5, .friction = 0.5});
  sim.time_step = 1e-5;
  const silt::Plane ground{{0, 0, 0}, {0, 0, -1}};
  std::array<double, 2> mass{0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k) mass[sim.material(k)] += sim.mass(k);
  PassingCounter first(ground, {.which = [&](std::size_t k) { return sim.material(k) == 0; }}),
      second(ground, {.which = [&](std::size_t k) { return sim.material(k) == 1; }}), all(ground);
  sim.run(6e-3, first, second, all);
  CHECK(first.forwards().number == 42);
  CHECK(second.forwards().number == 22);
  CHECK(all.forwards().number == 64);
  CHECK(first.forwards().mass == near(mass[0]).epsilon(1e-14));
  CHECK(second.forwards().mass == near(mass[1]).epsilon(1e-14));
}

// Catches: parts of a body that count each; the mass of a part.
TEST_CASE("passing: a body counts once, where its centre of mass passes") {
  silt::Particles<silt::MultiSphere> rods;
  rods.add_form({.balls = {{{-2e-3, 0, 0}, 1e-3}, {{0, 0, 0}, 1e-3}, {{3e-3, 0, 0}, 1e-3}}});
  rods.add({.position = {0, 0, 4e-3},
            .density = 2500,
            .velocity = {0, 0, -1},
            .angular_velocity = {0, 2000, 0}});
  silt::Simulation sim{std::move(rods), silt::Contacts<HertzMindlin>{rubber}};
  sim.time_step = 1e-5;
  PassingCounter disc(silt::disc({0, 0, 0}, {0, 0, -1}, 1e-3));
  sim.run(8e-3, disc);
  CHECK(disc.forwards().number == 1);
  CHECK(disc.backwards().number == 0);
  CHECK(disc.forwards().mass == sim.mass(0));
}

// Catches: fragments that are taken for their parent, and a parent that still counts.
TEST_CASE("passing: fragments begin anew") {
  auto of = breakage_scene::policy();
  silt::Particles<Sphere> grains;
  grains.add({.position = {0, 0, 5e-3}, .radius = 1e-3, .density = 2165, .velocity = {0, 0, -60}});
  auto sim = breakage_scene::simulation(std::move(grains), of);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, breakage_scene::salt);
  PassingCounter plane(silt::Plane{{0, 0, 3e-3}, {0, 0, 1}}),
      once(silt::Plane{{0, 0, 3e-3}, {0, 0, 1}}, {.once = true});
  sim.run(1e-3, plane, once);
  std::size_t above = 0;
  double mass = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && sim.position(k).z > 3e-3) ++above, mass += sim.mass(k);
  CHECK(sim.broken() > 0);
  CHECK(above > 1);
  CHECK(plane.backwards().number == 1);
  CHECK(plane.forwards().number == above);
  CHECK(plane.forwards().mass == near(mass).epsilon(1e-12));
  CHECK(once.forwards().number == above);
}

}  // namespace

}  // namespace passing_kinds_test
