// silt - BSD-3-Clause, see LICENSE
// Free walls and belts with bodies that are no spheres: the same as in free_walls.cpp.
#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/shape/mesh_body.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation.hpp>

namespace free_walls_bodies_test {

using namespace engine_test;

namespace {

silt::Polyhedron block(double half_height) {
  std::vector<Vec3d> corners;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-half_height, half_height}) corners.push_back({x, y, z});
  return silt::Polyhedron::from_points(corners);
}

}  // namespace

TEST_CASE("free walls: momentum and angular momentum are kept when a polyhedron hits a free box") {
  silt::Particles<silt::Polyhedron> p;
  const auto cube = p.add_form(block(1));
  p.add({.form = cube,
         .position = {0.05, 0.03, 0.045},
         .radius = 0.01,
         .density = 2500,
         .velocity = {-0.3, 0.1, -1},
         .angular_velocity = {20, -10, 5}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.threads = 1;
  const auto mesh = silt::box_mesh({0, 0, 0}, {0.06, 0.04, 0.02});
  sim.add_wall(mesh, rubber, {.name = "box", .drive = silt::free_body(mesh, 2500)});
  struct Momenta {
    Vec3d linear, angular;
  };
  const auto momenta = [&] {
    const auto& s = sim.wall("box").state;
    const double M = std::get<silt::FreeBody>(sim.wall("box").drive).mass, m = sim.mass(0);
    // A cube has the same moment about every axis: m a^2/6, its radius is a sqrt(3)/2.
    const double a = 2 * sim.radius(0) / std::sqrt(3.0);
    return Momenta{m * sim.velocity(0) + M * s.velocity_now,
                   m * cross(sim.position(0), sim.velocity(0)) +
                       m * a * a / 6 * sim.angular_velocity(0) +
                       M * cross(s.centre, s.velocity_now) + rotate(s.turn, s.momentum_now)};
  };
  sim.run(0);
  const Momenta before = momenta();
  sim.run(0.06);
  const Momenta after = momenta();
  CHECK(sim.wall("box").state.velocity_now.z < -0.03);  // they have met
  CHECK(norm(after.linear - before.linear) < 1e-13 * norm(before.linear));
  CHECK(norm(after.angular - before.angular) < 1e-12 * norm(before.angular));
}

TEST_CASE("free walls: a lid and a box rest on fixed cubes") {
  silt::Particles<silt::Polyhedron> p;
  const auto cube = p.add_form(block(1));
  const double a = 0.01 / std::sqrt(3.0);  // [m] half the edge
  for (const double x : {-0.02, 0.02})
    for (const double y : {-0.02, 0.02})
      p.add({.form = cube, .position = {x, y, a}, .radius = 0.01, .density = 2500, .fixed = true});
  p.add({.form = cube, .position = {1, 1, a}, .radius = 0.01, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.threads = 1;
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber, {.name = "floor"});
  const auto mesh = silt::box_mesh({-0.03, -0.03, 2 * a + 1e-5}, {0.03, 0.03, 2 * a + 0.01});
  const auto body = silt::free_body(mesh, 500);
  sim.add_wall(mesh, rubber, {.name = "box", .drive = body});
  sim.run(0.3);
  // Each of them would fall freely: 0.4 m.
  CHECK(sim.wall("box").force.z == doctest::Approx(body.mass * 9.81).epsilon(1e-3));
  CHECK(std::abs(sim.wall("box").pose.translation.z) < 1e-4);
  sim.remove_wall("box");
  sim.add_wall(
      silt::rectangle({-0.03, -0.03, 2 * a + 1e-3}, {0.06, 0, 0}, {0, 0.06, 0}), rubber,
      {.name = "lid",
       .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 0.5, .max_speed = 0.05}});
  sim.run(0.2);
  CHECK(sim.wall("lid").force.z == doctest::Approx(0.5).epsilon(1e-3));
  CHECK(sim.wall("lid").pose.translation.z == doctest::Approx(-1e-3).epsilon(0.1));
}

TEST_CASE("belts: a cube that lies flat reaches the belt's speed with mu g") {
  silt::Particles<silt::Polyhedron> p;
  const auto cube = p.add_form(block(0.1));
  const double radius = 0.01, scale = radius / std::sqrt(2.01);
  p.add({.form = cube, .position = {0, 0, 0.1 * scale - 2e-6}, .radius = radius, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.threads = 1;
  sim.gravity = {0, 0, -9.81};
  const double u = 0.2, takes = u / (rubber.friction * 9.81);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber,
               {.name = "belt", .surface_velocity = {.velocity = {u, 0, 0}}});
  sim.run(0.6 * takes);
  // The plate is flat and tilts little: its weight rests on all four corners.
  CHECK(sim.velocity(0).x == doctest::Approx(0.6 * u).epsilon(0.05));
  sim.run(2 * takes);
  CHECK(sim.velocity(0).x == doctest::Approx(u).epsilon(0.01));
}

TEST_CASE("belts: a body that lies on a turning surface is taken along as by one that turns") {
  // The pressure over the contact area resists spin relative to the surface.
  const auto run = [](bool belt) {
    silt::Particles<silt::SuperEllipsoid> p;
    p.add_form(silt::SuperEllipsoid{8e-3, 8e-3, 4e-3, 8, 2});
    p.add({.position = {0, 0, 4e-3}, .radius = 8e-3, .density = 2500});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::EnergyLedger{}};
    sim.threads = 1, sim.gravity = {0, 0, -9.81};
    if (belt)
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber,
                   {.surface_velocity = {.rate = {0, 0, 5}}});
    else
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber,
                   {.motion = silt::rotation({0, 0, 0}, {0, 0, 1}, 5)});
    sim.run(0.1);
    CHECK(std::abs(sim.energy().residual()) < 1e-3 * sim.energy().turned_over);
    return std::pair{sim.angular_velocity(0).z, sim.energy().walls};
  };
  const auto [w, work] = run(true);
  const auto [v, wanted] = run(false);
  CHECK(v > 1);  // rad/s
  CHECK(w == doctest::Approx(v).epsilon(1e-3));
  CHECK(work == doctest::Approx(wanted).epsilon(1e-2));
}

}  // namespace free_walls_bodies_test
