// silt - BSD-3-Clause, see LICENSE
// The time step and the limit of the overlap where there are several materials.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <engine/support.hpp>
#include <silt/contact/formulas.hpp>

#include "near.hpp"

namespace several_materials_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::SimulationError;
using Contacts = silt::Contacts<HertzMindlin, silt::SeveralMaterials>;

constexpr HertzMindlin::Material glass{
    .youngs_modulus = 1e9, .poisson_ratio = 0.25, .restitution = 0.8};
constexpr HertzMindlin::Material steel{
    .youngs_modulus = 2e11, .poisson_ratio = 0.3, .restitution = 0.8};
constexpr HertzMindlin::Material foam{
    .youngs_modulus = 1e7, .poisson_ratio = 0.1, .restitution = 0.8};

double modulus(const HertzMindlin::Material& a, const HertzMindlin::Material& b) {
  return silt::effective_modulus(a.youngs_modulus, a.poisson_ratio, b.youngs_modulus,
                                 b.poisson_ratio);
}
double mass_of(double radius, double density) {
  return density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

/// Materials 0, 1, 2 = glass, steel, foam.
auto three_materials() {
  Contacts contacts{{glass, steel, foam}};
  const HertzMindlin::Pair pair{.restitution = 0.8, .friction = 0.1};
  contacts.set_pair(glass, steel, pair).set_pair(glass, foam, pair).set_pair(steel, foam, pair);
  return contacts;
}
using Grains = silt::Particles<Sphere>;
auto scene(Grains grains) {
  silt::Simulation sim{std::move(grains), three_materials()};
  sim.threads = 1;
  return sim;
}
const silt::Plane floor_plane{{0, 0, -0.1}, {0, 0, 1}};

/// Grains of glass of 1 mm and a ball of steel of 10 mm.
Grains grains_and_ball(double speed) {
  Grains p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, speed}});
  p.add({.position = {0.01, 0, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {0.05, 0, 0}, .radius = 1e-2, .density = 7800, .material = 1});
  return p;
}

}  // namespace

TEST_CASE("several materials: the step is a 20th of the shortest contact that can happen") {
  const double speed = 5, R = 1e-3, m = mass_of(R, 2500);
  auto sim = scene(grains_and_ball(speed));
  sim.add_wall(floor_plane, steel);
  sim.run(0);
  // Glass meets the walls. (Glass spheres with the modulus of steel, which do not exist, would
  // give 1.4e-7 s.)
  const double contact = silt::hertz_contact_time(modulus(glass, steel), R, m, speed);
  CHECK(sim.step_length() == near(contact / 20).epsilon(1e-12));
  CHECK(sim.step_length() > 1e-6);

  auto right = scene(grains_and_ball(speed));
  right.add_wall(floor_plane, steel);
  right.time_step = 5e-7;
  right.run(1e-5);
  CHECK(right.step() == 20);

  auto wrong = scene(grains_and_ball(speed));
  wrong.add_wall(floor_plane, steel);
  wrong.time_step = 1.01 * contact / 8;
  CHECK(has_words(refusal<InputError>([&] { wrong.run(1e-5); }),
                  {"is above the limit ", "guard.max_time_step = 0.125", "at 5 m/s",
                   "a particle of radius 0.001 m and material 0 (youngs_modulus = 1e+09 Pa)",
                   "with a wall of material 1 (youngs_modulus = 2e+11 Pa)", "lower it"}));

  // Without walls of steel the ball is the stiffest that they meet.
  auto open = scene(grains_and_ball(speed));
  open.run(0);
  const double with_ball =
      silt::hertz_contact_time(modulus(glass, steel), silt::effective_radius(R, 1e-2),
                               silt::effective_mass(m, mass_of(1e-2, 7800)), speed);
  CHECK(open.step_length() == near(with_ball / 20).epsilon(1e-12));
  open.time_step = 1.01 * with_ball / 8;
  CHECK(has_words(refusal<InputError>([&] { open.run(1e-5); }),
                  {"radius 0.001 m and material 0", "with one of radius 0.01 m and material 1"}));
}

TEST_CASE("several materials: the step against all pairs of random scenes, one by one") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  const HertzMindlin::Material materials[] = {glass, steel, foam};
  for (int k = 0; k < 60; ++k) {
    const bool one_density = k % 2 == 0;
    double density[3], size[3];
    for (int m = 0; m < 3; ++m)
      density[m] = 500 * std::pow(20, unit(random)), size[m] = 5e-4 * std::pow(20, unit(random));
    Grains p;
    struct One {
      double radius, mass;
      std::size_t material;
    };
    std::vector<One> all;
    const std::size_t used = 1 + k % 3, n = 20;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t m = i % used;
      const double r = size[m] * (1 + 2 * unit(random));
      const double rho = density[m] * (one_density ? 1 : std::pow(5, unit(random)));
      const double x = 0.1 * static_cast<double>(i);
      const bool fixed = i % 7 == 5;
      p.add({.position = {x, 0, 0}, .radius = r, .density = rho, .material = m, .fixed = fixed});
      all.push_back({r, fixed ? INFINITY : mass_of(r, rho), m});
    }
    auto sim = scene(p);
    const std::size_t of_wall = k % 4;  // 3: none
    if (of_wall < 3) sim.add_wall(floor_plane, materials[of_wall]);
    sim.gravity = {0, 0, -1};
    sim.run(0);
    const double speed = 1;
    const double step = *sim.time_step_limit(speed) * 8;
    double shortest = std::numeric_limits<double>::infinity();
    for (const One& a : all) {
      if (!std::isfinite(a.mass)) continue;
      for (const One& b : all) {
        const auto E = modulus(materials[a.material], materials[b.material]);
        const double m = std::isfinite(b.mass) ? silt::effective_mass(a.mass, b.mass) : a.mass;
        const double R = silt::effective_radius(a.radius, b.radius);
        shortest = std::min(shortest, silt::hertz_contact_time(E, R, m, speed));
      }
      if (of_wall < 3)
        shortest = std::min(
            shortest, silt::hertz_contact_time(modulus(materials[a.material], materials[of_wall]),
                                               a.radius, a.mass, speed));
    }
    CAPTURE(k);
    CHECK(step <= shortest * (1 + 1e-12));
    // Spheres of one material and several densities are bounded, not searched pair by pair.
    CHECK(step >= shortest * (one_density ? 1 - 1e-12 : 0.8));
  }
}

TEST_CASE("several materials: inlets to come count, those that are done and walls taken away not") {
  const double speed = 1;
  const auto base = [&] {
    Grains p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, speed}});
    return scene(p);
  };
  auto alone = base();
  alone.run(0);
  auto inflow = base();
  inflow.add_inlet({{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}}, {.radius = silt::uniform(2e-4, 5e-4),
                                                        .density = 7800,
                                                        .rate = 1e4,
                                                        .total = 3,
                                                        .material = 1,
                                                        .interval = 1e-5});
  inflow.run(0);
  const double m = mass_of(2e-4, 7800);
  CHECK(inflow.step_length() ==
        near(silt::hertz_contact_time(modulus(steel, steel), 1e-4, m / 2, speed) / 20)
            .epsilon(1e-12));
  inflow.run(2e-3);
  REQUIRE(inflow.size() == 4);
  for (std::size_t k = 0; k < inflow.rows(); ++k)  // all steel leaves; the inlet is done
    if (inflow.material(k) == 1) inflow.engine().park(k);
  CHECK(*inflow.time_step_limit(speed) == near(*alone.time_step_limit(speed)).epsilon(1e-12));

  auto lidded = base();
  const auto lid = lidded.add_wall(silt::Plane{{0, 0, 0.5}, {0, 0, -1}}, steel);
  lidded.run(0);
  CHECK(lidded.step_length() < 0.99 * alone.step_length());
  lidded.remove_wall(lid);
  CHECK(*lidded.time_step_limit(speed) == near(*alone.time_step_limit(speed)).epsilon(1e-12));

  inflow.add_inlet({{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}},
                   {.radius = 1e-3, .density = 1, .rate = 1, .material = 7});
  CHECK(has_words(refusal<InputError>([&] { inflow.run(0); }),
                  {"InletFlow.material = 7", "table of 3 materials"}));
}

TEST_CASE("several materials: what is added between runs makes the step shorter, or is refused") {
  const auto start = [](std::optional<double> step) {
    Grains p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, 1}});
    auto sim = scene(p);
    sim.time_step = step;
    sim.run(1e-5);
    return sim;
  };
  Grains light;
  light.add({.position = {0.1, 0, 0}, .radius = 1e-4, .density = 2500, .material = 1});
  auto sim = start({});
  const double before = sim.step_length();
  sim.add(light);
  sim.run(1e-6);
  const double contact =
      silt::hertz_contact_time(modulus(steel, steel), 5e-5, mass_of(1e-4, 2500) / 2, 1);
  CHECK(sim.step_length() == near(contact / 20).epsilon(1e-12));
  CHECK(sim.position(sim.find(0)).z == near(sim.time()).epsilon(1e-9));

  // What needs no shorter step leaves it, bit for bit.
  auto same = start({});
  Grains heavy;
  heavy.add({.position = {0.1, 0, 0}, .radius = 1e-3, .density = 2600});
  same.add(heavy);
  same.run(1e-6);
  CHECK(same.step_length() == before);

  auto fixed = start(before);
  fixed.add(light);
  CHECK(has_words(refusal<InputError>([&] { fixed.run(1e-6); }),
                  {"Simulation::time_step = ", "is above the limit ", "material 1"}));
  auto walled = start(before);
  walled.add_wall(floor_plane, HertzMindlin::Material{1e15, 0.3, 0.8, 0.0});
  CHECK(has_words(refusal<InputError>([&] { walled.run(1e-6); }),
                  {"materials 0 and 3 have no pair value"}));
}

TEST_CASE("several materials: a heavy body may press light grains deeper, others may not") {
  const HertzMindlin::Material soft{
      .youngs_modulus = 1e7, .poisson_ratio = 0.1, .restitution = 0.8};
  // A ball of steel falls on a grain that lies on a plane of `below`.
  const auto drop = [&](const HertzMindlin::Material& below) {
    Grains p;
    p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 100, .material = 2});
    p.add({.position = {0, 0, 7.01e-3},
           .radius = 5e-3,
           .density = 7800,
           .velocity = {0, 0, -1},
           .material = 1});
    auto sim = scene(p);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, below);
    return sim;
  };
  REQUIRE(soft == foam);
  auto strict = drop(foam);
  const auto sentence = refusal<SimulationError>([&] { strict.run(2e-3); });
  CHECK(has_words(sentence, {"of the smaller radius, above the limit guard.max_overlap = 0.3",
                             "use a stiffer material", "Simulation::set_max_overlap raises",
                             "material 2 (youngs_modulus = 1e+07 Pa)"}));

  // The grain is pressed in twice: by the ball, and into the plane. Either has its own limit.
  auto ball = drop(foam);
  ball.set_max_overlap(steel, foam, 0.9);
  CHECK(has_words(refusal<SimulationError>([&] { ball.run(2e-3); }),
                  {"particle 0 at ", "overlaps wall 0 by 0.3", "guard.max_overlap = 0.3"}));
  auto plane = drop(foam);
  plane.set_max_overlap(foam, foam, 0.9);
  CHECK(has_words(refusal<SimulationError>([&] { plane.run(2e-3); }),
                  {"particles 0 and 1", "overlap by 0.3", "guard.max_overlap = 0.3"}));
  auto both = drop(foam);
  both.set_max_overlap(foam, steel, 0.9);
  both.set_max_overlap(foam, foam, 0.9);
  both.run(2e-3);
  CHECK(both.peak_overlap() > 0.31);

  // A limit of a pair may also be lower than that of all.
  auto low = drop(foam);
  low.set_max_overlap(steel, foam, 0.05);
  CHECK(has_words(refusal<SimulationError>([&] { low.run(2e-3); }),
                  {"particles 0 and 1", "overlap by 0.05",
                   "above the limit 0.05 that "
                   "set_max_overlap gives to ",
                   "material 1 (youngs_modulus = 2e+11 Pa)"}));

  auto bad = drop(foam);
  CHECK(has_words(refusal<InputError>([&] { bad.set_max_overlap(foam, steel, 0); }),
                  {"set_max_overlap: limit = 0 [-]"}));
  CHECK(has_words(refusal<InputError>([&] {
                    bad.set_max_overlap(foam, HertzMindlin::Material{3e9, 0.3}, 0.5);
                  }),
                  {"set_max_overlap: a material (youngs_modulus = 3e+09 Pa) is none of the 3"}));
}

TEST_CASE("several materials: limits of pairs count where a mesh must not be passed") {
  Grains p;
  p.add({.position = {0, 0, 1}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  auto sim = scene(p);
  sim.add_wall(silt::TriangleMesh(std::vector<std::array<Vec3d, 3>>{
                   {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}}),
               steel);
  sim.set_max_overlap(glass, glass, 2);  // not the mesh's
  sim.run(0);
  sim.set_max_overlap(glass, steel, 0.8);
  CHECK(has_words(refusal<InputError>([&] { sim.run(0); }),
                  {"the limit of set_max_overlap = 0.8", "less than 1 together"}));
}

}  // namespace several_materials_test
