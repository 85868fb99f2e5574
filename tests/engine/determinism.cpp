// silt - BSD-3-Clause, see LICENSE
// The same bits in every run and for every number of threads.
#include <engine/mixed_scene.hpp>

#include "near.hpp"

namespace determinism_test {

namespace {

using namespace engine_test;

constexpr double duration = 0.04;  // [s] 10000 steps

/// Particles, what the walls bear, and what went in and out.
struct Outcome {
  std::vector<ParticleBits> particles;
  std::vector<double> walls;
  std::uint64_t placed, left;
  double peak_overlap;
  bool operator==(const Outcome&) const = default;
};

template <class... Observers>
Outcome outcome(int threads, Observers&&... observers) {
  auto sim = mixed_scene(threads);
  sim.run(duration, observers...);
  Outcome out{bits(sim), {}, sim.inlet(0).placed, sim.outlet(0).count, sim.peak_overlap()};
  for (std::size_t w = 0; w < sim.walls(); ++w)
    for (const Vec3d& v : {sim.wall(w).force, sim.wall(w).torque, sim.wall(w).impulse})
      out.walls.insert(out.walls.end(), {v.x, v.y, v.z});
  return out;
}

}  // namespace

TEST_CASE(
    "determinism: runs with 1, 2 and 3 threads give the same bits, and so does a repeated run") {
  const auto first = outcome(1);
  // The scene is worth it: contacts, spheres that came and went, loads on every wall.
  CHECK(first.placed > 30);
  CHECK(first.left > 5);
  CHECK(first.peak_overlap > 0.01);
  for (std::size_t w = 0; w < 4; ++w) {
    CAPTURE(w);
    const double* impulse = &first.walls[9 * w + 6];
    CHECK(norm(Vec3d{impulse[0], impulse[1], impulse[2]}) > 0);
  }
  CHECK(outcome(1) == first);
  CHECK(outcome(2) == first);
  CHECK(outcome(3) == first);
}

TEST_CASE("determinism: a run that is looked at, and one in several pieces, give the same bits") {
  const auto unseen = outcome(1);
  std::size_t looks = 0;
  CHECK(outcome(1, [&](const auto& sim) { looks += sim.touching_pairs() > 0; }) == unseen);
  CHECK(looks > 1000);

  auto pieces = mixed_scene();
  for (const int steps : {1, 499, 0, 1500, 8000}) pieces.run(steps * 4e-6);
  CHECK(pieces.step() == 10000);
  CHECK(bits(pieces) == unseen.particles);
}

TEST_CASE(
    "several_materials: a sphere leaves a wall with the restitution of the pair of materials") {
  // Spheres of rubber and of resin, side by side, fall on walls of rubber and of resin. The law's
  // damping gives the restitution exactly; the step, 1/200 of the contact time, leaves 2 pi
  // zeta/200 at the most, as the dashpot sets in within a step: 0.8 % where zeta = 0.255, that of
  // 0.5.
  for (const bool on_resin : {false, true}) {
    silt::Particles<Sphere> p;
    for (const std::size_t material : {0, 1})
      p.add({.position = {4e-3 + 8e-3 * static_cast<double>(material), 0, 1.01e-3},
             .radius = 1e-3,
             .density = 2500,
             .velocity = {0, 0, -0.5},
             .material = material});
    silt::Simulation sim{std::move(p), mixed_contacts(), silt::VerletList<>{},
                         silt::PeriodicBox{{{0, 0, 0}, {16e-3, 1, 1}}, {true, false, false}}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, on_resin ? resin : rubber);
    sim.time_step = 2e-6;
    sim.run(5e-3);
    const double e[2] = {sim.velocity(sim.find(0)).z / 0.5, sim.velocity(sim.find(1)).z / 0.5};
    CHECK(e[0] == near(on_resin ? 0.6 : 0.7).epsilon(8e-3));
    CHECK(e[1] == near(on_resin ? 0.5 : 0.6).epsilon(8e-3));
    // Each pair of materials has its own stiffness.
    const auto contacts = sim.contacts();
    CHECK(contacts.coefficients(0, 1).twice_modulus == contacts.coefficients(1, 0).twice_modulus);
    CHECK(contacts.coefficients(0, 1).twice_modulus > contacts.coefficients(0, 0).twice_modulus);
  }
}

TEST_CASE("several_materials: a pair without values is named when the run starts") {
  MixedContacts contacts({rubber, resin});
  silt::Particles<Sphere> p;
  p.add({.position = {8e-3, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  silt::Simulation sim{std::move(p), contacts, silt::VerletList<>{},
                       silt::PeriodicBox{{{0, 0, 0}, {16e-3, 1, 1}}, {true, false, false}}};
  CHECK(has_words(refusal<silt::InputError>([&] { sim.run(1e-3); }),
                  {"materials 0 and 1 have no pair value", "call set_pair("}));
  CHECK(sim.step() == 0);
}

TEST_CASE("several_materials: a particle of a material that is not in the table is refused") {
  auto sim = mixed_scene();
  const auto before = sim.size();
  silt::Particles<Sphere> p;
  p.add({.position = {8e-3, 0, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {8e-3, 0, 0.01}, .radius = 1e-3, .density = 2500, .material = 2});
  CHECK(has_words(
      refusal<silt::InputError>([&] { sim.add(p); }),
      {"particle 1: material 2 is not in the table of 2 materials", "add it to the contacts"}));
  CHECK(sim.size() == before);
}

TEST_CASE("periodic_box: a sphere of more than a third of its length is refused") {
  auto sim = mixed_scene();
  silt::Particles<Sphere> p;
  p.add({.position = {8e-3, 0, 0}, .radius = 3e-3, .density = 2500});
  CHECK(has_words(
      refusal<silt::InputError>([&] { sim.add(p); }),
      {"its length 0.016 [m] must be at least 3 diameters of particle 0 of radius 0.003 m: "
       "0.018 m"}));
}

TEST_CASE("determinism: enough spheres for several shares, sorted or not, give the same bits") {
  const auto run = [](int threads, bool sort) {
    auto sim = many_spheres(threads, sort);
    sim.run(0.01);
    CHECK(sim.engine().lists.pairs.groups().phases() == 8);
    CHECK(sim.touching_pairs() > 10000);
    return bits(sim);
  };
  for (const bool sort : {true, false}) {
    CAPTURE(sort);
    const auto first = run(1, sort);
    CHECK(run(2, sort) == first);
    CHECK(run(3, sort) == first);
  }
}

}  // namespace determinism_test
