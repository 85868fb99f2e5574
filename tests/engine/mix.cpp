// silt - BSD-3-Clause, see LICENSE
//
// Polyhedra, compounds and mixes of all shapes in the engine: conservation in collisions of every
// pair, blocks at rest, and all that a simulation does with particles.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <silt/boundary/domain.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

#include "engine/body_totals.hpp"
#include "engine/stones.hpp"
#include "engine/support.hpp"
#include "near.hpp"

namespace mix_test {

namespace {

using namespace engine_test;
using silt::Polyhedron;
using Grains = silt::Mix<Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::PolySuperEllipsoid,
                         Polyhedron, silt::Compound<Polyhedron>>;

const HertzMindlin::Material rock = stone(0.5, 0.5);

HertzMindlin::Material elastic() {
  auto m = rock;
  m.youngs_modulus = 3e7, m.restitution = 1, m.friction = 0;
  return m;
}

Polyhedron tetrahedron(double size) {
  return Polyhedron::from_points(
      {{size, size, size}, {size, -size, -size}, {-size, size, -size}, {-size, -size, size}});
}
/// An angle of two slabs.
silt::Compound<Polyhedron> angle() {
  return {.parts = {{block(1e-3, 0.3e-3, 0.8e-3), {0, -0.7e-3, 0}},
                    {block(0.3e-3, 0.7e-3, 0.8e-3), {-0.7e-3, 0.3e-3, 0}}}};
}

template <class P>
void add_forms(P& particles) {
  particles.add_form(Sphere{});
  particles.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 0.7e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}});
  particles.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.6e-3, .s1 = 6, .s2 = 2});
  particles.add_form(silt::PolySuperEllipsoid{{0.7e-3, 1e-3, 1.3e-3}, {1e-3, 0.8e-3, 0.6e-3}});
  particles.add_form(tetrahedron(0.8e-3));
  particles.add_form(block(0.5e-3, 0.7e-3, 0.6e-3, 0.3e-3));
  particles.add_form(angle());
}
constexpr std::size_t form_count = 7;

/// All shapes fall into a box.
template <class... Policies>
auto heap(std::size_t of_each, Policies... policies) {
  silt::Particles<Grains> grains;
  add_forms(grains);
  for (std::size_t form = 0; form < form_count; ++form)
    grains.fill({.min = {0, 0, 0}, .max = {0.012, 0.012, 0.1}},
                {.radius = silt::uniform(1e-3, 1.4e-3),
                 .density = 2500,
                 .count = of_each,
                 .velocity = {0.1, 0.05, -0.5},
                 .form = form});
  silt::Simulation sim{std::move(grains), silt::Contacts<HertzMindlin>{rock}, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.012, 0.012, 0.2}), rock);
  return sim;
}

}  // namespace

TEST_CASE("Every two shapes that collide keep momentum, angular momentum and energy") {
  int met = 0;
  silt::Random random(7);
  for (std::size_t a = 0; a < form_count; ++a)
    for (std::size_t b = 0; b < form_count; ++b) {
      silt::Particles<Grains> pair;
      add_forms(pair);
      pair.add({.form = a,
                .position = {-2e-3, 0, 0},
                .orientation = silt::random_orientation(random),
                .radius = 1.3e-3,
                .density = 2500,
                .velocity = {1, 0, 0},
                .angular_velocity = {100, 50, -200}});
      pair.add({.form = b,
                .position = {2e-3, 0.2e-3, 0.1e-3},
                .orientation = silt::random_orientation(random),
                .radius = 1.2e-3,
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
      INFO("forms ", a, " and ", b);
      // Second order in the step: every overlap is a potential.
      const double coarse = errors(2e-6), fine = errors(0.5e-6);
      CHECK(coarse < 2e-3);
      CHECK(fine < 2e-3 / 16);
    }
  CHECK(met > 60);
}

TEST_CASE("Every shape that is all but a sphere moves as one") {
  const double r = 1e-3, core = 1e-4 * r;
  using Balls = silt::Mix<Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::PolySuperEllipsoid,
                          Polyhedron>;
  const std::vector<Balls> balls{
      Sphere{}, silt::MultiSphere{{{{0, 0, 0}, r}}}, silt::SuperEllipsoid{r, r, r},
      silt::PolySuperEllipsoid{{r, r, r}, {r, r, r}}, block(core, core, core, r - core)};
  // One falls on a plane, slips, and meets another one.
  const auto run = [&](auto particles, bool with_plane) {
    silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{rock}};
    sim.time_step = 1e-6;
    if (with_plane) sim.add_wall(silt::Plane{{0, 0, -r}, {0, 0, 1}}, rock);
    sim.run(0.004);
    return std::array{sim.velocity(0), sim.angular_velocity(0) * r, sim.velocity(1),
                      sim.angular_velocity(1) * r};
  };
  const Vec3d from[2] = {{0, 0, 0.2e-3}, {2.3e-3, 0.5e-3, 0.4e-3}};
  const Vec3d v{1, 0, -0.5}, w{30, 40, 50};
  silt::Particles<Sphere> spheres;
  spheres.add({from[0], r, 2500, v, w});
  spheres.add({from[1], r, 2500, {0, 0, 0}, {0, 0, 0}});
  for (const Balls& ball : balls) {
    INFO("shape ", ball.kind());
    silt::Particles<Balls> grains;
    grains.add_form(ball);
    grains.add(
        {.position = from[0], .radius = r, .density = 2500, .velocity = v, .angular_velocity = w});
    grains.add({.position = from[1], .radius = r, .density = 2500});
    // At a plane each corner of a dilated polyhedron is a contact of its own.
    const bool with_plane = !std::holds_alternative<Polyhedron>(ball.shape);
    const auto wanted = run(spheres, with_plane), found = run(grains, with_plane);
    CHECK(norm(wanted[2]) > 0.1);  // they have met
    // First order in the step, as the arms of a contact are those of now; and the corners of the
    // dilated cube stand out by 0.7e-4 of the radius.
    for (std::size_t k = 0; k < 4; ++k) CHECK(norm(found[k] - wanted[k]) < 1e-3);
  }
}

TEST_CASE("Bodies of all shapes that tumble in a box never gain energy") {
  silt::Particles<Grains> grains;
  add_forms(grains);
  silt::Random random(11);
  for (std::size_t form = 0; form < form_count; ++form)
    grains.fill({.min = {0, 0, 0}, .max = {0.012, 0.012, 0.012}},
                {.radius = silt::uniform(1e-3, 1.3e-3), .density = 2500, .count = 4, .form = form});
  for (std::size_t k = 0; k < grains.size(); ++k) {
    const auto any = [&](double most) {
      return Vec3d{random.uniform(-most, most), random.uniform(-most, most),
                   random.uniform(-most, most)};
    };
    grains[k].velocity = any(0.5), grains[k].angular_velocity = any(500);
  }
  silt::Simulation sim{std::move(grains), silt::Contacts<HertzMindlin>{rock}};
  sim.add_wall(silt::box({0, 0, 0}, {0.012, 0.012, 0.012}), rock);
  sim.run(0);
  const double start = totals(sim).energy;
  double most = 0;
  for (int k = 0; k < 100; ++k) {
    sim.run(5e-4);
    most = std::max(most, totals(sim).energy);
  }
  CHECK(most < start);
  CHECK(totals(sim).energy < 0.5 * start);
}

TEST_CASE("A mix is filled with bodies as they were made; its spheres need a radius") {
  silt::Particles<Grains> grains;
  add_forms(grains);
  const Box region{{0, 0, 0}, {0.012, 0.012, 0.1}};
  grains.fill(region, {.density = 2500, .count = 5, .form = 4});
  for (const auto& p : grains) CHECK(p.radius == grains.forms()[4].radius);
  CHECK(has_words(refusal<silt::InputError>(
                      [&] { grains.fill(region, {.density = 2500, .count = 5, .form = 0}); }),
                  {"Fill.radius is not given: the form of a Sphere has no size of its own"}));
  CHECK(grains.size() == 5);
}

TEST_CASE("A block on a slope stays, blocks stacked ten high stay, and cards lean on each other") {
  const silt::Particles<Polyhedron>::Particle at_rest{.position = {0, 0, 0}, .density = 2500};
  SUBCASE("slope") {
    const silt::Quaternion turn = silt::rotation_about({0, 1, 0}, -0.35);
    const Vec3d up = rotate(turn, {0, 0, 1});
    silt::Particles<Polyhedron> one;
    one.add_form(block(1e-3, 1e-3, 1e-3));
    auto p = at_rest;
    p.position = 0.999e-3 * up, p.orientation = turn;
    one.add(p);
    silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{rock}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, up}, rock);
    sim.run(0.2);
    const Vec3d from = sim.position(0);
    sim.run(0.5);
    CHECK(norm(sim.position(0) - from) < 1e-9);
  }
  SUBCASE("stack") {
    silt::Particles<Polyhedron> stack;
    stack.add_form(block(1e-3, 1e-3, 0.5e-3));
    for (int k = 0; k < 10; ++k) {
      auto p = at_rest;
      p.position = {0, 0, (0.5 + k) * 1e-3};
      p.orientation = silt::rotation_about({0, 0, 1}, 0.1 * k);
      stack.add(p);
    }
    silt::Simulation sim{std::move(stack), silt::Contacts<HertzMindlin>{rock}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rock);
    sim.run(0.3);
    std::vector<Vec3d> from;
    for (std::size_t k = 0; k < 10; ++k) from.push_back(sim.position(sim.find(k)));
    sim.run(0.5);
    for (std::uint32_t k = 0; k < 10; ++k) {
      const Vec3d x = sim.position(sim.find(k));
      CHECK(norm(x - from[k]) < 1e-7);
      CHECK(std::abs(x.z - (0.5 + k) * 1e-3) < 0.02e-3 * (k + 1));
    }
  }
  SUBCASE("cards") {
    // Two slabs that lean on each other by 20 degrees, their top edges a hair apart.
    const double length = 5e-3, half = 0.4e-3, lean = 0.35;
    silt::Particles<Polyhedron> cards;
    cards.add_form(block(half, 4e-3, length));
    for (const double side : {-1.0, 1.0}) {
      auto p = at_rest;
      const double x = length * std::sin(lean) + half * std::cos(lean) + 1e-7;
      p.position = {side * x, 0, length * std::cos(lean) + half * std::sin(lean)};
      p.orientation = silt::rotation_about({0, 1, 0}, -side * lean);
      cards.add(p);
    }
    silt::Simulation sim{std::move(cards), silt::Contacts<HertzMindlin>{rock}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rock);
    sim.run(0.3);
    const Vec3d from[2] = {sim.position(0), sim.position(1)};
    CHECK(std::abs(from[0].z - from[1].z) < 1e-6);
    CHECK(from[0].z > 0.99 * length * std::cos(lean));
    sim.run(0.5);
    CHECK(norm(sim.position(0) - from[0]) < 2e-6);
    CHECK(norm(sim.position(1) - from[1]) < 2e-6);
  }
}

TEST_CASE("A heap of all shapes comes to rest, the same for any number of threads") {
  auto sim = heap(8), other = heap(8);
  sim.threads = 1;
  other.threads = 3;
  sim.run(0.05), other.run(0.05);
  CHECK(bits(sim) == bits(other));
  sim.run(0.25);
  CHECK(totals(sim).energy < 1e-6);  // of some 3e-4 J
  CHECK(sim.peak_overlap() < 0.3);
  CHECK(sim.touching_pairs() > 56);
}

TEST_CASE("A run of all shapes continued from a checkpoint has the same bits") {
  const std::string path = "mix_checkpoint_test.silt";
  auto sim = heap(6);
  sim.run(0.06);
  silt::save_checkpoint(sim, path);
  sim.run(0.03);
  auto again = heap(6);
  silt::load_checkpoint(again, path);
  again.run(0.03);
  CHECK(bits(sim) == bits(again));
  std::remove(path.c_str());
}

}  // namespace mix_test
