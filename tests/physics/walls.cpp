// silt - BSD-3-Clause, see LICENSE
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>

#include "boundary/support.hpp"
#include "physics/support.hpp"

namespace walls_test {

// Walls in a Simulation: meshes that act as the plane they tile, walls that move, loads on walls.

namespace {

using namespace silt;
using namespace physics_test;
using boundary_test::Soup;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
using Law = Contacts<HertzMindlin>;
using Scene = Simulation<Particles<Sphere>, Law>;

HertzMindlin::Material material(double friction, double modulus = 1e8) {
  return {
      .youngs_modulus = modulus, .poisson_ratio = 0.25, .restitution = 0.5, .friction = friction};
}
const double mass = mass_of(radius, density);

/// [m] overlap of a sphere and a wall that press each other with `force` [N]
double depth(double force, const HertzMindlin::Material& m) {
  const double E =
      effective_modulus(m.youngs_modulus, m.poisson_ratio, m.youngs_modulus, m.poisson_ratio);
  return std::pow(force / hertz_stiffness(E, radius), 2.0 / 3.0);
}

/// One sphere and one wall; 20 steps of a contact at 1 m/s.
Scene on_wall(const Particles<Sphere>::Particle& sphere, const Surfaces& wall,
              const HertzMindlin::Material& m, const Motion& motion = {}) {
  Particles<Sphere> one;
  one.add(sphere);
  Scene sim{std::move(one), Law{m}};
  sim.add_wall(wall, m, motion);
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  sim.time_step = 5e-6 * std::pow(1e8 / m.youngs_modulus, 0.4);
  return sim;
}
/// At rest on z = 0, at (x, y).
Particles<Sphere>::Particle resting(const HertzMindlin::Material& m, double x = 0, double y = 0) {
  return {.position = {x, y, radius - depth(mass * g, m)}, .radius = radius, .density = density};
}

// ---- the square [-side, side]^2 at z = 0, cut in several ways --------------------------------

constexpr double side = 0.02;  // [m]

Soup two_triangles() {
  Soup soup;
  boundary_test::add_quad(soup, {-side, -side, 0}, {2 * side, 0, 0}, {0, 2 * side, 0});
  return soup;
}

/// 10 x 10 quadrilaterals with corners moved at random, each cut along one of its diagonals.
Soup irregular() {
  const int n = 10;
  std::mt19937_64 random(11);
  const auto corner = [&](int i, int j) {
    const bool inside = i > 0 && i < n && j > 0 && j < n;
    const double shift = inside ? 0.35 : 0;
    return Vec3d{side * (2 * (i + boundary_test::uniform(random, -shift, shift)) / n - 1),
                 side * (2 * (j + boundary_test::uniform(random, -shift, shift)) / n - 1), 0};
  };
  std::vector<Vec3d> corners;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) corners.push_back(corner(i, j));
  Soup soup;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto at = [&](int a, int b) {
        return corners[static_cast<std::size_t>((i + a) * (n + 1) + j + b)];
      };
      if ((i + j) % 2) {
        soup.push_back({at(0, 0), at(1, 0), at(1, 1)});
        soup.push_back({at(0, 0), at(1, 1), at(0, 1)});
      } else {
        soup.push_back({at(0, 0), at(1, 0), at(0, 1)});
        soup.push_back({at(1, 0), at(1, 1), at(0, 1)});
      }
    }
  return soup;
}

/// Strips across x, each of its own number of quadrilaterals: corners hang on the edges beside.
Soup t_junctions() {
  Soup soup;
  const int strips = 8;
  for (int i = 0; i < strips; ++i) {
    const int pieces = 1 + (5 * i) % 7;
    const double width = 2 * side / strips, height = 2 * side / pieces;
    for (int j = 0; j < pieces; ++j)
      boundary_test::add_quad(soup, {-side + i * width, -side + j * height, 0}, {width, 0, 0},
                              {0, height, 0});
  }
  return soup;
}

struct State {
  Vec3d position, velocity, spin;
};
/// 1e4 steps over the seams: down a slope, from a start that slides, spins and bounces a little.
State roll(const Surfaces& wall, double friction) {
  const auto m = material(friction);
  auto start = resting(m, -0.6 * side, -0.5 * side);
  start.position.z += 0.01 * radius;
  start.velocity = {0.3, 0.25, 0};
  start.angular_velocity = {-200, 150, 80};
  auto sim = on_wall(start, wall, m);
  sim.gravity = {0.3, 0.2, -g};
  sim.run(1e4 * *sim.time_step);
  CHECK(sim.step() == 10000);
  return {sim.position(0), sim.velocity(0), sim.angular_velocity(0)};
}

/// Speed [m/s] of the sphere's surface at its contact with a fixed plane z = 0.
Vec3d slip(const State& s) { return s.velocity + cross(s.spin, Vec3d{0, 0, -radius}); }

}  // namespace

TEST_CASE(
    "walls: over a plane of triangles a sphere slides and rolls as over the plane, to 1e-12") {
  for (const double friction : {0.05, 0.5}) {
    const auto plane = roll(Plane{{0, 0, 0}, {0, 0, 1}}, friction);
    CAPTURE(friction);
    CHECK(plane.position.x > 0);                            // it has crossed most of the strips
    CHECK((norm(slip(plane)) > 0.05) == (friction < 0.1));  // the smoother one still slides
    for (const auto& soup : {two_triangles(), irregular(), t_junctions()}) {
      const auto mesh = roll(TriangleMesh{soup}, friction);
      CAPTURE(soup.size());
      CHECK(norm(mesh.position - plane.position) < 1e-12 * norm(plane.position));
      CHECK(norm(mesh.velocity - plane.velocity) < 1e-12 * norm(plane.velocity));
      CHECK(norm(mesh.spin - plane.spin) < 1e-12 * norm(plane.spin));
    }
  }
}

TEST_CASE("walls: in the corner of a box mesh a sphere rests on three contacts") {
  const auto m = material(0, 1e7);
  const Vec3d gravity{-3, -5, -8};
  auto sim = on_wall({.position = {1.01 * radius, 1.01 * radius, 1.01 * radius},
                      .radius = radius,
                      .density = density},
                     TriangleMesh{boundary_test::box_soup({0, 0, 0}, {0.01, 0.01, 0.01})}, m);
  sim.gravity = gravity;
  sim.run(0.2);
  const Vec3d p = sim.position(0);
  // Each face bears its component of the weight: the closed form of three separate contacts, once
  // the damped bounces have died away.
  CHECK(near_relative(radius - p.x, depth(3 * mass, m), 1e-8));
  CHECK(near_relative(radius - p.y, depth(5 * mass, m), 1e-8));
  CHECK(near_relative(radius - p.z, depth(8 * mass, m), 1e-8));
  CHECK(norm(sim.wall(0).force - mass * gravity) < 1e-8 * mass * norm(gravity));
}

TEST_CASE("walls: a vibrating plane carries a sphere with the force m (g + acceleration)") {
  const double frequency = 50, amplitude = 5e-5;  // [Hz], [m]
  const double rate = 2 * pi * frequency, peak = amplitude * rate * rate;
  REQUIRE(peak < g);
  const auto m = material(0.3);
  // amplitude (cos(rate t) - 1): starts at rest, with the acceleration -peak.
  auto start = resting(m);
  start.position.z = radius - depth(mass * (g - peak), m);
  auto sim = on_wall(start, Plane{{0, 0, 0}, {0, 0, 1}}, m,
                     vibration({0, 0, amplitude}, frequency, pi / 2));
  double worst = 0;
  sim.run(0.02);  // what the start from a standing wall leaves has died away
  sim.run(0.1, [&](const auto& s) {
    const double expected = mass * (g - peak * std::cos(rate * s.time()));
    worst = std::max(worst, std::abs(-s.wall(0).force.z - expected));
  });
  // The overlap's own change adds its acceleration: depth rate^2 = 0.003 of g.
  const double change = depth(mass * (g + peak), m) * rate * rate;
  CHECK(worst < mass * change);
  CHECK(change < 0.005 * g);
}

TEST_CASE("walls: a rotating cylinder carries a pressed sphere round, rigidly") {
  const double drum = 0.01, rate = 50;  // [m], [rad/s]
  const auto m = material(0.5);
  // Without gravity the wall pulls it inwards with m rate^2 times the radius of its orbit.
  double orbit = drum - radius;
  for (int k = 0; k < 20; ++k) orbit = drum - radius + depth(mass * rate * rate * orbit, m);
  auto sim = on_wall({.position = {orbit, 0, 0},
                      .radius = radius,
                      .density = density,
                      .velocity = {0, rate * orbit, 0},
                      .angular_velocity = {0, 0, rate}},
                     Cylinder{{0, 0, -0.01}, {0, 0, 0.01}, drum, Side::Inside}, m,
                     rotation({0, 0, 0}, {0, 0, 1}, rate));
  sim.gravity = {0, 0, 0};
  // The cylinder's curvature is no part of R*: the closed form is that of a plane, as in the law.
  sim.run(0.01);  // the overlap takes up the pull
  double off = 0, force = 0;
  sim.run(2 * 2 * pi / rate, [&](const auto& s) {
    const double angle = rate * s.time();
    const Vec3d expected{orbit * std::cos(angle), orbit * std::sin(angle), 0};
    off = std::max(off, norm(s.position(0) - expected));
    force = std::max(force, std::abs(norm(s.wall(0).force) / (mass * rate * rate * orbit) - 1));
  });
  // A circle in steps of rate dt = 2.5e-4: leapfrog is off by (rate dt)^2/24 of the angle, and a
  // chord for the arc asks for as much less force.
  CHECK(off < 1e-6 * orbit);
  CHECK(force < 1e-6);
  CHECK(near_relative(sim.angular_velocity(0).z, rate, 1e-6));
}

TEST_CASE("walls: on a turntable a rolling sphere runs in circles with 2/7 of its rate") {
  const double rate = 20;  // [rad/s]
  const auto m = material(0.5);
  auto start = resting(m, 0.01, 0);
  const double arm = start.position.z;  // [m] of friction: the radius less the overlap
  // At rest in space it turns on the spot, as the disc moves with rate x there.
  start.angular_velocity = {rate * 0.01 / arm, 0, 0};
  auto still = on_wall(start, Plane{{0, 0, 0}, {0, 0, 1}}, m, rotation({0, 0, 0}, {0, 0, 1}, rate));
  still.run(0.05);
  CHECK(norm(still.position(0) - start.position) < 1e-9);

  // With a velocity v along x it circles with the share I/(I + m arm^2) of the rate, 2/7 for
  // arm = R; rolling: its surface moves with the disc.
  const double v = 0.02;                         // [m/s]
  const double inertia = 0.4 * radius * radius;  // [m2] I/m
  const double share = inertia / (inertia + arm * arm);
  CHECK(near_relative(share, 2.0 / 7.0, 2 * (1 - arm / radius)));
  start.velocity = {v, 0, 0};
  start.angular_velocity = {rate * 0.01 / arm, v / arm, 0};
  auto circling =
      on_wall(start, Plane{{0, 0, 0}, {0, 0, 1}}, m, rotation({0, 0, 0}, {0, 0, 1}, rate));
  const double turn = 2 * pi / (share * rate), size = v / (share * rate);  // [s], [m]
  circling.run(0.5 * turn);
  // Half a circle later it is a diameter to the side, moving back. The spring's first steps and
  // the end of the run (to a step, 3e-6 of the turn) leave an error of 1e-5.
  const Vec3d across = circling.position(0) - start.position;
  CHECK(std::abs(across.x) < 3e-5 * size);
  CHECK(near_relative(std::abs(across.y), 2 * size, 3e-5));
  CHECK(near_relative(circling.velocity(0).x, -v, 3e-5));
  circling.run(0.5 * turn);
  CHECK(norm(circling.position(0) - start.position) < 6e-5 * size);
}

TEST_CASE("walls: a moving plate drags a sphere to 2/7 of its speed in 2 U/(7 mu g)") {
  const double mu = 0.2, U = 0.1;  // [-], [m/s]
  const auto m = material(mu);
  const double rolls = 2 * U / (7 * mu * g);
  const double lever_error = depth(mass * g, m) / radius;
  Vec3d end[2];
  int k = 0;
  for (const Surfaces& plate :
       {Surfaces(Plane{{0, 0, 0}, {0, 0, 1}}), Surfaces(TriangleMesh{irregular()})}) {
    auto sim = on_wall(resting(m, 0.1 * side), plate, m, translation({U, 0, 0}));
    sim.run(0.5 * rolls);
    CHECK(near_relative(sim.velocity(0).x, mu * g * sim.time(), 1e-3));  // the spring's first steps
    CHECK(near_relative(sim.wall(0).force.x, -mu * mass * g, 1e-9));
    CHECK(near_relative(sim.wall(0).force.z, -mass * g, 1e-9));
    sim.run(0.6 * rolls);
    const double v = sim.velocity(0).x;
    CHECK(near_relative(v, 2.0 / 7.0 * U, 2 * lever_error));
    CHECK(near_relative(-sim.angular_velocity(0).y * radius, 5.0 / 7.0 * U, 2 * lever_error));
    const double x = sim.position(0).x, time = sim.time();
    sim.run(rolls);
    CHECK(near_relative(sim.position(0).x - x, v * (sim.time() - time), 1e-4));
    end[k++] = sim.position(0);
  }
  CHECK(norm(end[1] - end[0]) < 1e-12 * norm(end[0]));
}

TEST_CASE("walls: the walls of a heap at rest bear its weight and its moment about the reference") {
  const auto m = material(0.5, 1e7);
  Particles<Sphere> heap;
  const Box room{.min = {0, 0, 0}, .max = {0.008, 0.008, 0.02}};
  heap.fill(room, {.radius = uniform(0.8 * radius, 1.2 * radius), .density = density, .count = 40});
  Scene sim{std::move(heap), Law{m}};
  sim.add_wall(box(room.min, room.max), m);
  const Vec3d reference{0.01, -0.02, 0.03};  // [m]
  sim.set_reference(0, reference);
  sim.gravity = {0.5, -1, -g};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.run(0.6);
  CHECK(kinetic_energy(sim) < 1e-14);
  Vec3d weight{0, 0, 0}, moment{0, 0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d load = sim.mass(k) * sim.gravity;
    weight += load;
    moment += cross(sim.position(k) - reference, load);
  }
  // As far as the heap has come to rest.
  CHECK(norm(sim.wall(0).force - weight) < 1e-5 * norm(weight));
  CHECK(norm(sim.wall(0).torque - moment) < 1e-5 * norm(moment));
}

}  // namespace walls_test
