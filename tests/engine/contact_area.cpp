// silt - BSD-3-Clause, see LICENSE
//
// Contacts that have an area: friction against spin, damping of rocking, rest.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/engine/convex/contact_area.hpp>
#include <silt/silt.hpp>

#include "engine/stones.hpp"
#include "engine/support.hpp"

namespace contact_area_test {

namespace {

using namespace engine_test;
using silt::Contacts;
using silt::Plane;
using silt::Polyhedron;
using silt::Random;
using silt::SuperEllipsoid;

constexpr double g = 9.81;

/// |a - b| <= tolerance.
bool within(double a, double b, double tolerance) { return std::abs(a - b) <= tolerance; }

/// Mean distance from the middle of a rectangle of half edges a, b, under uniform pressure.
double mean_distance(double a, double b) {
  constexpr int n = 400;
  double sum = 0;
  for (int k = 0; k < n; ++k)
    for (int l = 0; l < n; ++l) sum += std::hypot((k + 0.5) / n * a, (l + 0.5) / n * b);
  return sum / (n * n);
}

silt::TriangleMesh ground() {
  const Vec3d a{-0.2, -0.2, 0}, b{0.2, -0.2, 0}, c{0.2, 0.2, 0}, d{-0.2, 0.2, 0};
  return silt::TriangleMesh({{a, b, c}, {a, c, d}}, 0.1);
}

template <class Shape>
auto on_ground(const Shape& shape, const typename silt::Particles<Shape>::Particle& at,
               const HertzMindlin::Material& m, bool mesh) {
  silt::Particles<Shape> one;
  one.add_form(shape);
  one.add(at);
  silt::Simulation sim{std::move(one), Contacts<HertzMindlin>{m}};
  sim.gravity = {0, 0, -g};
  if (mesh)
    sim.add_wall(ground(), m);
  else
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, m);
  return sim;
}

/// How deep a block of these half edges lies on a plane at rest.
double depth_at_rest(double a, double b, double c, const HertzMindlin::Material& m) {
  auto sim = on_ground(block(a, b, c), {.position = {0, 0, c}, .density = 2500}, m, false);
  sim.run(0.3);
  return c - sim.position(0).z;
}

/// When a body that lies flat and spins at w0 about the vertical has come down to a tenth: so early
/// that the last swing of the spring does not matter.
template <class Sim>
double time_to_a_tenth(Sim& sim, double w0) {
  while (sim.angular_velocity(0).z > 0.1 * w0 && sim.time() < 1) sim.run(sim.step_length());
  return sim.time();
}

}  // namespace

TEST_CASE("contact_area: the points have the mean and the covariance of the contact region") {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    const auto q = silt::random_orientation(random);
    const Vec3d u = rotate(q, {1, 0, 0}), v = rotate(q, {0, 1, 0}), normal = rotate(q, {0, 0, 1});
    const double a = std::pow(10, random.uniform(-8, -2)), b = a * random.uniform(0, 1);
    const silt::Symmetric3 c = silt::tensor_along(u, v, normal, {a, b, 5 * a, 0, 0, 0});
    Vec3d way{0, 0, 0};
    if (n % 2 == 0) way = silt::normalised(u + random.uniform(-2, 2) * v);
    const Vec3d before = way;
    const silt::Spread<double> spread{c.xx, c.yy, c.zz, c.xy, c.yz, c.zx};
    silt::detail::AreaFrame<double> frame{way, 0, 0, 0};
    frame.turn_with(normal, {0, 0, 0});
    frame.begin(spread, normal, {0, 0, 0}, {0, 0, 0});
    frame.set_root(spread, normal, true);
    way = frame.way;
    const auto points = frame.arms(normal);
    Vec3d sum{0, 0, 0};
    silt::Symmetric3 covariance;
    for (const Vec3d& p : points) sum += p, covariance += (1.0 / 3) * silt::outer(p);
    const double factor = silt::detail::area_factor * silt::detail::area_factor;
    const silt::Symmetric3 wanted = factor * silt::tensor_along(u, v, normal, {a, b, 0, 0, 0, 0});
    CHECK(norm(sum) < 1e-12 * std::sqrt(a));
    CHECK(within(covariance.xx, wanted.xx, 1e-10 * a));
    CHECK(within(covariance.yz, wanted.yz, 1e-10 * a));
    CHECK(within(covariance.zx, wanted.zx, 1e-10 * a));
    CHECK(within(norm(way), 1, 1e-12));
    CHECK(std::abs(dot(way, normal)) < 1e-12);
    if (n % 2 == 0)
      CHECK(norm(way - before) < 1e-12);  // turned with the contact, which rests
    else if (b < 0.99 * a)
      CHECK(std::abs(dot(way, u)) > 1 - 1e-6);  // a new one: along the longer side
  }
}

// Catches a root of what is no covariance: a closing contact's region is as small as rounding, and
// a force of 1e131 N threw a tetrahedron off a mesh.
TEST_CASE("contact_area: a region of rounding alone gives points within its size") {
  using Frame = silt::detail::AreaFrame<double>;
  const Vec3d n = Vec3d{0.76, -0.539, 0.362} * (1 / norm(Vec3d{0.76, -0.539, 0.362}));
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const auto any = [&] { return 1e-21 * random.uniform(-1, 1); };
    const silt::Spread<double> spread{any(), any(), any(), any(), any(), any()};
    Frame frame{};
    frame.begin(spread, n, {1e-3, 0, 1e-3}, {0, 0, 0});
    frame.set_root(spread, n, true);
    for (const Vec3d& arm : frame.arms(n)) CHECK(norm(arm) < 1e-10);
  }
}

// Catches points that lie by a convention of space: three points turned by half a turn lose other
// energies. Spins after the first bounce were two sets, 2 and 7 rad/s apart.
TEST_CASE("contact_area: a scene that lies otherwise in space gives the same motion") {
  const HertzMindlin::Material m{
      .youngs_modulus = 2e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.4};
  const std::vector<Vec3d> corners{{1.5e-3, 1.5e-3, 1.5e-3},
                                   {1.5e-3, -1.5e-3, -1.5e-3},
                                   {-1.5e-3, 1.5e-3, -1.5e-3},
                                   {-1.5e-3, -1.5e-3, 1.5e-3}};
  const auto thrown = [&](const Polyhedron& form, std::uint64_t seed, const silt::Quaternion& q) {
    Random random(seed);
    const auto turned = [&](const Vec3d& x) { return rotate(q, x); };
    const auto any = [&](double size) {
      return size * Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    };
    silt::Particles<Polyhedron> one;
    one.add_form(form);
    const Vec3d axis = any(1), v = any(0.3), w = any(30);
    one.add({.position = turned({0, 0, 4e-3}),
             .orientation = q * silt::rotation_about(axis, random.uniform(-3, 3)),
             .density = 2500,
             .velocity = turned({v.x, v.y, -0.3}),
             .angular_velocity = turned(w)});
    silt::Simulation sim{std::move(one), Contacts<HertzMindlin>{m}};
    sim.gravity = turned({1, 0.5, -g}), sim.time_step = 1.5e-6;
    sim.add_wall(Plane{{0, 0, 0}, turned({0, 0, 1})}, m);
    sim.run(0.015);
    return rotate(conjugate(q), sim.angular_velocity(0));
  };
  int turned_by_more = 0;
  for (const Polyhedron& form : {Polyhedron::from_points(corners), block(1.5e-3, 1.2e-3, 1e-3)})
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Vec3d as_is = thrown(form, seed, {});
      for (const auto& q :
           {silt::rotation_about({1, 2, -0.5}, 1.234), silt::rotation_about({0.3, -1, 0.7}, 2.7)})
        CHECK(norm(thrown(form, seed, q) - as_is) < 1e-3);  // rounding, grown in a bounce
      turned_by_more += norm(as_is) > 5;
    }
  CHECK(turned_by_more > 12);  // they have met the plane
}

TEST_CASE("contact_area: a block that spins on its face stops when Coulomb's torque says so") {
  // The torque is mu m g times the mean distance, from when the block bears its weight; points
  // instead of the area err by 2.6 % on a rectangle, the bounces at the start by less.
  const auto m = stone(0.5, 0.4);
  struct Case {
    double a, b;
  };
  for (const Case& of : {Case{3e-3, 3e-3}, Case{6e-3, 3e-3}, Case{2e-3, 3e-3}}) {
    const double a = of.a, b = of.b;
    const double c = 2e-3, depth = depth_at_rest(a, b, c, m);
    for (const bool mesh : {false, true}) {
      CAPTURE(mesh);
      CAPTURE(a);
      const double w0 = 20;
      auto sim = on_ground(
          block(a, b, c),
          {.position = {0, 0, c - depth}, .density = 2500, .angular_velocity = {0, 0, w0}}, m,
          mesh);
      const double deceleration = m.friction * g * mean_distance(a, b) / ((a * a + b * b) / 3);
      const double measured = time_to_a_tenth(sim, w0);
      CHECK(within(measured, 0.9 * w0 / deceleration, 0.06 * measured));
    }
  }
}

TEST_CASE("contact_area: a block slides with mu g, and slides farther while it spins") {
  const auto m = stone(0.5, 0.4);
  const double a = 3e-3, depth = depth_at_rest(a, a, a, m);
  const double way = 0.5 * 0.3 * 0.3 / (m.friction * g);  // [m] from 0.3 m/s
  std::vector<double> slid;
  for (const double spin : {0.0, 200.0}) {
    auto sim = on_ground(block(a, a, a),
                         {.position = {-way, 0, a - depth},
                          .density = 2500,
                          .velocity = {0.3, 0, 0},
                          .angular_velocity = {0, 0, spin}},
                         m, false);
    sim.run(0.4);
    slid.push_back(sim.position(0).x + way);
    CHECK(norm(sim.velocity(0)) < 1e-6);
    CHECK(norm(sim.angular_velocity(0)) < 1e-4);
  }
  // What the block tips forwards shifts the force, not its size; at the end the spring swings.
  CHECK(within(slid[0], way, 0.02 * way));
  // Friction that has to stop the spin as well holds less against sliding (Coulomb: 1.9 times).
  CHECK(slid[1] > 1.2 * slid[0]);
}

TEST_CASE("contact_area: thrown polyhedra come to rest on planes and meshes") {
  std::vector<Polyhedron> shapes{block(3e-3, 3e-3, 3e-3), block(4e-3, 4e-3, 1e-3),
                                 block(6e-3, 3e-3, 2e-3)};
  const double s = 3e-3;
  shapes.push_back(Polyhedron::from_points({{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}}));
  Random random(7);
  for (const auto& shape : shapes)
    for (const bool mesh : {false, true}) {
      const Vec3d spin{random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30)};
      auto sim = on_ground(shape,
                           {.position = {0, 0, 0.015},
                            .orientation = silt::random_orientation(random),
                            .density = 2500,
                            .velocity = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0},
                            .angular_velocity = spin},
                           stone(0.4, 0.4), mesh);
      sim.run(2);
      CAPTURE(mesh);
      CAPTURE(shape.faces().size());
      CHECK(norm(sim.angular_velocity(0)) < 1e-6 * norm(spin));
      CHECK(norm(sim.velocity(0)) < 1e-8);
    }
}

TEST_CASE("contact_area: a block on a tilted plane or mesh slides beyond atan(mu)") {
  for (const bool mesh : {false, true})
    for (const double share : {0.99, 1.01}) {
      const auto m = stone(0.5, 0.5);
      const double tilt = std::atan(share * m.friction), c = 2e-3;
      auto sim =
          on_ground(block(4e-3, 3e-3, c), {.position = {-0.1, 0, c}, .density = 2500}, m, mesh);
      sim.gravity = {g * std::sin(tilt), 0, -g * std::cos(tilt)};
      sim.run(0.2);
      const double from = sim.velocity(0).x;
      sim.run(0.2);
      const double pull = g * (std::sin(tilt) - m.friction * std::cos(tilt));
      CAPTURE(mesh);
      if (share < 1)
        CHECK(std::abs(sim.velocity(0).x) < 1e-9);
      else
        CHECK(within(sim.velocity(0).x - from, 0.2 * pull, 0.01 * 0.2 * pull));
    }
}

// Below the friction angle and below the slope at which it tips, 0.785. A friction force that
// follows the normal force across the face turns a block that rolls sideways: the cube rocked with
// 0.6 to 8 rad/s for ever, and walked 1.6 to 45 mm/s downhill, at any step and stiffness.
TEST_CASE("contact_area: a cube stays where it is on a steep slope") {
  const double a = 5e-3;
  for (const bool mesh : {false, true})
    for (const double e : {0.5, 0.8}) {
      const HertzMindlin::Material m{
          .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = e, .friction = 0.8};
      auto sim = on_ground(block(a, a, a), {.position = {0, 0, a}, .density = 2500}, m, mesh);
      sim.run(0.02);
      sim.run(0.2, silt::at(silt::every(2e-4), [](auto& s) {
                const double slope = 0.62 * std::min(1.0, (s.time() - 0.02) / 0.15);
                s.gravity = {g * std::sin(slope), 0, -g * std::cos(slope)};
              }));
      sim.run(0.5);
      const Vec3d before = sim.position(0);
      sim.run(0.1);
      CAPTURE(e);
      CHECK(norm(sim.angular_velocity(0)) < 1e-5);  // 3e-6 on the mesh, e = 0.8
      CHECK(norm(sim.position(0) - before) < 1e-9);
    }
}

TEST_CASE("contact_area: stacks and brick walls stand still") {
  const auto m = stone(0.5, 0.5);
  silt::Particles<Polyhedron> all;
  const double a = 4e-3, b = 2e-3, c = 1.5e-3;
  all.add_form(block(a, b, c)), all.add_form(block(a / 2, b, c));
  const auto put = [&](std::size_t form, double x, double y, int row) {
    all.add({.form = form, .position = {x, y, c + 2 * c * row}, .density = 2500});
  };
  for (int row = 0; row < 5; ++row) put(0, 0, 0.02, row);  // a stack, and a wall of five rows
  for (int row = 0; row < 5; ++row) {
    const double first = row % 2 == 0 ? 0 : a;
    for (int k = 0; k < (row % 2 == 0 ? 3 : 2); ++k) put(0, first + 2 * a * k, 0, row);
    if (row % 2 == 1) put(1, -a / 2, 0, row), put(1, 4.5 * a, 0, row);
  }
  silt::Simulation sim{std::move(all), Contacts<HertzMindlin>{m}};
  sim.gravity = {0, 0, -g};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, m);
  sim.run(0.5);
  std::vector<Vec3d> then;
  for (std::size_t k = 0; k < sim.size(); ++k) then.push_back(sim.position(k));
  sim.run(0.5);
  for (std::size_t k = 0; k < sim.size(); ++k) {
    CHECK(norm(sim.position(k) - then[k]) < 1e-4 * c);
    CHECK(norm(sim.angular_velocity(k)) < 1e-3);
    CHECK(norm(sim.velocity(k)) < 1e-5);
  }
}

TEST_CASE("contact_area: a stack of dilated cubes comes to rest, and its balance closes") {
  for (const double turn : {0.0, 0.3}) {
    const auto m = stone(0.3, 0.5);
    const double a = 2e-3, r = 0.2e-3;
    silt::Particles<Polyhedron> all;
    all.add_form(block(a - r, a - r, a - r, r));
    for (int k = 0; k < 5; ++k)
      all.add({.position = {turn * 1e-3 * (k % 2), turn * 0.7e-3 * (k % 3), a + 2 * a * k},
               .orientation = silt::rotation_about({0, 0, 1}, turn * k),
               .density = 2500});
    silt::Simulation sim{std::move(all), Contacts<HertzMindlin>{m}, silt::EnergyLedger{}};
    sim.gravity = {0, 0, -g};
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, m);
    sim.run(2);
    const auto top = sim.find(4);
    CAPTURE(turn);
    CHECK(norm(sim.angular_velocity(top)) < 1e-5);  // 0.25 rad/s while the point jumped
    CHECK(sim.kinetic_energy() < 1e-16);            // 6e-10 J
    CHECK(std::abs(sim.energy().residual()) < 1e-5 * sim.mass(top) * g * 9 * a);  // 0.3
  }
}

TEST_CASE("contact_area: dilated cubes that meet by their faces rebound with their restitution") {
  for (const double e : {0.9, 0.5}) {
    const double a = 1e-3, r = 0.2e-3, v = 0.1;
    silt::Particles<Polyhedron> two;
    two.add_form(block(a - r, a - r, a - r, r));
    two.add({.position = {-1.02 * a, 0, 0}, .density = 1000, .velocity = {v, 0, 0}});
    two.add({.position = {1.02 * a, 0, 0}, .density = 3000, .velocity = {-v, 0, 0}});
    silt::Simulation sim{std::move(two), Contacts<HertzMindlin>{stone(e, 0.4)}};
    sim.run(0.1 * a / v);
    const double rebound = sim.velocity(sim.find(1)).x - sim.velocity(sim.find(0)).x;
    CHECK(within(rebound / (2 * v), e, 0.01));  // 0.94 and 0.65
  }
}

// The points of friction were kept relative to the first of two bodies: up to 2.7 % of the speed.
TEST_CASE("contact_area: two cubes rebound alike, whichever was added first") {
  const auto m = stone(0.6, 0.4);
  for (int seed = 0; seed < 6; ++seed) {
    Vec3d velocity[2][2];
    for (const std::size_t first : {0u, 1u}) {
      silt::Particles<silt::Polyhedron> cubes;
      cubes.add_form(block(0.7e-3, 0.7e-3, 0.7e-3));
      for (const std::size_t n : {first, 1 - first})
        cubes.add({.position = n == 0 ? Vec3d{-1.2e-3, 0, 0} : Vec3d{1.2e-3, 0.5e-3, 0.1e-3},
                   .orientation = silt::rotation_about(silt::normalised(Vec3d{1, 2.0 * n, 3}),
                                                       0.7 * seed + 1.9 * static_cast<double>(n)),
                   .density = 2500,
                   .velocity = {n == 0 ? 0.5 : -0.5, 0, 0},
                   .angular_velocity = n == 0 ? Vec3d{100, -200, 150} : Vec3d{0, 0, 0}});
      silt::Simulation sim{std::move(cubes), silt::Contacts<HertzMindlin>{m}};
      sim.threads = 1, sim.time_step = 1e-6;
      sim.run(4e-3);
      velocity[first][0] = sim.velocity(sim.find(first)),
      velocity[first][1] = sim.velocity(sim.find(1 - first));
    }
    CHECK(velocity[0][0].x < 0.45);  // they met
    for (int n = 0; n < 2; ++n) CHECK(norm(velocity[1][n] - velocity[0][n]) < 1e-9);
  }
}

TEST_CASE("contact_area: a die of high exponents stops spinning and comes to rest") {
  const auto m = stone(0.5, 0.4);
  const double a = 3e-3;
  for (const double s : {8.0, 40.0}) {
    const SuperEllipsoid die{.a = a, .b = a, .c = a, .s1 = s, .s2 = s};
    for (const bool mesh : {false, true}) {
      auto spinning = on_ground(
          die, {.position = {0, 0, a}, .density = 2500, .angular_velocity = {0, 0, 20}}, m, mesh);
      // At s = 40 the face is 0.9 of the cube's, at 8 about 0.6.
      const double torque = m.friction * g * mean_distance(a, a), inertia = 2 * a * a / 3;
      const double time = time_to_a_tenth(spinning, 20) / (0.9 * 20 * inertia / torque);
      CAPTURE(s);
      CAPTURE(mesh);
      CHECK(time > 1);
      CHECK(time < (s == 40 ? 1.35 : 2.2));
      auto thrown = on_ground(die,
                              {.position = {0, 0, 0.012},
                               .orientation = silt::rotation_about({0.6, 0.8, 0}, 0.5),
                               .density = 2500,
                               .angular_velocity = {20, -10, 15}},
                              m, mesh);
      thrown.run(2);
      CHECK(norm(thrown.angular_velocity(0)) < 1e-5);
    }
  }
}

}  // namespace contact_area_test
