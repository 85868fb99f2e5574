// silt - BSD-3-Clause, see LICENSE
//
// Bodies of convex parts at walls of all kinds: against spheres, planes against meshes, energy, and
// walls that move.
#include <functional>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

#include "engine/body_totals.hpp"
#include "engine/stones.hpp"
#include "engine/support.hpp"
#include "near.hpp"

namespace convex_walls_test {

namespace {

using namespace engine_test;
using silt::Polyhedron;
using Grains =
    silt::Mix<silt::MultiSphere, silt::SuperEllipsoid, silt::PolySuperEllipsoid, Polyhedron>;

silt::Particles<Grains> of_all_forms() {
  silt::Particles<Grains> grains;
  grains.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 0.7e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}});
  grains.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.6e-3, .s1 = 6, .s2 = 2});
  grains.add_form(silt::SuperEllipsoid{.a = 0.9e-3, .b = 0.9e-3, .c = 0.9e-3, .s1 = 8, .s2 = 8});
  grains.add_form(silt::PolySuperEllipsoid{{0.7e-3, 1e-3, 1.3e-3}, {1e-3, 0.8e-3, 0.6e-3}});
  grains.add_form(block(0.8e-3, 0.6e-3, 0.7e-3));
  grains.add_form(block(0.5e-3, 0.7e-3, 0.6e-3, 0.3e-3));
  return grains;
}

/// The inside of a box as triangles, two a side, or more.
silt::TriangleMesh mesh_box(const Vec3d& min, const Vec3d& max, int cuts) {
  std::vector<std::array<Vec3d, 3>> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int u = 0; u < cuts; ++u)
        for (int v = 0; v < cuts; ++v) {
          const auto corner = [&](int du, int dv) {
            double t[3];
            t[axis] = side, t[(axis + 1) % 3] = double(u + du) / cuts,
            t[(axis + 2) % 3] = double(v + dv) / cuts;
            return Vec3d{min.x + t[0] * (max.x - min.x), min.y + t[1] * (max.y - min.y),
                         min.z + t[2] * (max.z - min.z)};
          };
          triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
          triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
        }
  return silt::TriangleMesh(triangles);
}

}  // namespace

TEST_CASE("Balls as super-ellipsoids move at round walls and meshes as spheres do") {
  struct Case {
    silt::Surfaces wall;
    Vec3d from;
    silt::Motion motion;
  };
  const auto run = [](auto particles, const Case& c, double time_step) {
    silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{stone(0.7, 0.5)}};
    sim.gravity = {0.5, 0, -9.81};
    sim.time_step = time_step;
    sim.add_wall(c.wall, stone(0.7, 0.5), c.motion);
    sim.run(0.012);
    return std::array{sim.velocity(0), sim.angular_velocity(0) * 1e-3};
  };
  const auto apart = [&](const Case& c, double time_step) {
    const Vec3d v{0.1, 0.2, -0.5}, w{30, 40, 50};
    silt::Particles<Sphere> sphere;
    sphere.add({c.from, 1e-3, 2500, v, w});
    silt::Particles<silt::SuperEllipsoid> body;
    body.add_form({.a = 1e-3, .b = 1e-3, .c = 1e-3});
    body.add({.position = c.from,
              .orientation = silt::rotation_about({0.6, 0, 0.8}, 1),
              .density = 2500,
              .velocity = v,
              .angular_velocity = w});
    const auto a = run(sphere, c, time_step), b = run(body, c, time_step);
    CHECK(norm(a[0] - v) > 0.3);  // it has met the wall
    return std::max(norm(a[0] - b[0]), norm(a[1] - b[1]));
  };
  const silt::Cylinder drum{{0, -0.1, 0}, {0, 0.1, 0}, 0.01, silt::Side::Inside};
  const silt::Cone funnel{{0, 0, 0}, {0, 0, 0.05}, 0.001, 0.03, silt::Side::Inside};
  const silt::Surfaces box(mesh_box({-5e-3, -5e-3, 0}, {5e-3, 5e-3, 0.02}, 3));
  for (const Case& c : {Case{drum, {0, 0, -8e-3}, {}},
                        Case{drum, {0, 0, -8e-3}, silt::rotation({0, 0, 0}, {0, 1, 0}, 10)},
                        Case{funnel, {2e-3, 0, 8e-3}, {}}, Case{box, {0, 0, 2e-3}, {}}}) {
    // First order in the step: arms of contacts are those of now, velocities half a step older.
    const double coarse = apart(c, 8e-6), fine = apart(c, 1e-6);
    CHECK(coarse < 5e-5);
    CHECK(fine < std::max(coarse / 4, 1e-9));
  }
}

TEST_CASE("All shapes in a box of triangles move as in one of planes") {
  const auto run = [](bool as_mesh) {
    auto grains = of_all_forms();
    silt::Random random(3);
    for (std::size_t form = 0; form < grains.forms().size(); ++form)
      grains.add({.form = form,
                  .position = {0.003 * static_cast<double>(form + 1), 0.003, 0.003},
                  .orientation = silt::random_orientation(random),
                  .density = 2500,
                  .velocity = {0, 0.1, -0.4}});
    silt::Simulation sim{std::move(grains), silt::Contacts<HertzMindlin>{stone(0.5, 0.5)}};
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 4e-6;
    const Vec3d min{0, 0, 0}, max{0.021, 0.006, 0.02};
    if (as_mesh)
      sim.add_wall(mesh_box(min, max, 2), stone(0.5, 0.5));
    else
      sim.add_wall(silt::box(min, max), stone(0.5, 0.5));
    sim.run(0.02);
    std::vector<Vec3d> places;
    for (std::uint32_t k = 0; k < sim.size(); ++k) {
      CHECK(norm(sim.velocity(sim.find(k)) - Vec3d{0, 0.1, -0.6}) > 0.1);  // it has met the floor
      places.push_back(sim.position(sim.find(k)));
    }
    return places;
  };
  const auto planes = run(false), mesh = run(true);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    INFO("form ", k);
    // A sharp polyhedron has a law of its own at meshes: as corners strike, it is softer.
    CHECK(norm(planes[k] - mesh[k]) < (k == 4 ? 1e-3 : 1e-9));
  }
}

TEST_CASE("Walls without friction take no energy from any shape") {
  const std::vector<std::function<silt::Surfaces()>> walls{
      [] {
        return silt::Surfaces(silt::Plane{{0, 0, 0}, {0, 0, 1}});
      },
      [] {
        return silt::Surfaces(
            silt::Cylinder{{0, -0.1, 0.006}, {0, 0.1, 0.006}, 0.006, silt::Side::Inside});
      },
      [] {
        return silt::Surfaces(
            silt::Cylinder{{0, -0.1, -0.004}, {0, 0.1, -0.004}, 0.004, silt::Side::Outside});
      },
      [] {
        return silt::Surfaces(
            silt::Cone{{-0.0298, 0, -0.01}, {-0.0298, 0, 0.03}, 0.02, 0.06, silt::Side::Inside});
      },
      [] {  // the edge of a step
        return silt::Surfaces(silt::TriangleMesh(
            {{Vec3d{-0.01, -0.01, 0}, Vec3d{0.0003, -0.01, 0}, Vec3d{0.0003, 0.01, 0}},
             {Vec3d{-0.01, -0.01, 0}, Vec3d{0.0003, 0.01, 0}, Vec3d{-0.01, 0.01, 0}},
             {Vec3d{0.0003, -0.01, 0}, Vec3d{0.0003, -0.01, -0.01}, Vec3d{0.0003, 0.01, 0}},
             {Vec3d{0.0003, -0.01, -0.01}, Vec3d{0.0003, 0.01, -0.01}, Vec3d{0.0003, 0.01, 0}}}));
      }};
  silt::Random random(5);
  for (std::size_t w = 0; w < walls.size(); ++w)
    for (std::size_t form = 0; form < of_all_forms().forms().size(); ++form) {
      auto one = of_all_forms();
      one.add({.form = form,
               .position = {0.0002, 0, 0.003},
               .orientation = silt::random_orientation(random),
               .density = 2500,
               .velocity = {0, 0.1, -1},
               .angular_velocity = {100, 50, -200}});
      const auto error = [&](double time_step) {
        silt::Simulation sim{one, silt::Contacts<HertzMindlin>{stone(1, 0)}};
        sim.time_step = time_step;
        sim.add_wall(walls[w](), stone(1, 0));
        sim.run(0);
        const double before = totals(sim).energy;
        sim.run(0.004);
        CHECK(norm(sim.velocity(0) - Vec3d{0, 0.1, -1}) > 0.1);  // it has met the wall
        return std::abs(totals(sim).energy / before - 1);
      };
      INFO("wall ", w, ", form ", form);
      // Second order in the step; but the die of s = 8 ends in the funnel a contact that has merged
      // with another one while both are deep, which is a jump (narrow/solid_walls.hpp).
      const bool merges = w == 3 && form == 2;
      CHECK(error(2e-6) < (merges ? 5e-3 : 2e-3));
      CHECK(error(0.5e-6) < (merges ? 5e-3 : 2e-3 / 16));
    }
}

TEST_CASE(
    "Sharp polyhedra keep their energy on ground finer than they are, and come to rest on it") {
  // Facets of 1/2 and 1/4 of the bodies' size, heights of up to 20 % of a facet.
  const auto ground = [](double facet) {
    silt::Random random(2);
    const int n = 16;
    std::vector<Vec3d> p;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        p.push_back({facet * (i - n / 2), facet * (j - n / 2), facet * random.uniform(-0.1, 0.1)});
    std::vector<std::array<Vec3d, 3>> triangles;
    const auto at = [&](int i, int j) { return p[static_cast<std::size_t>(j * (n + 1) + i)]; };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    return silt::TriangleMesh(triangles);
  };
  silt::Random random(8);
  std::vector<Vec3d> points;
  for (int k = 0; k < 12; ++k) {
    const Vec3d p{random.normal(), random.normal(), random.normal()};
    points.push_back((1e-3 / norm(p)) * p);
  }
  const double a = 0.8e-3;
  const Polyhedron forms[] = {
      block(a, a, a), Polyhedron::from_points(points),
      Polyhedron::from_points({{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}})};
  for (const double facet : {0.8e-3, 0.4e-3})
    for (std::size_t form = 0; form < 3; ++form) {
      silt::Particles<Polyhedron> one;
      one.add_form(forms[form]);
      one.add({.position = {0, 0, 2e-3},
               .orientation = silt::random_orientation(random),
               .density = 2500,
               .velocity = {0.1, 0.05, -1},
               .angular_velocity = {100, 50, -200}});
      const auto error = [&](double time_step) {
        silt::Simulation sim{one, silt::Contacts<HertzMindlin>{stone(1, 0)}};
        sim.time_step = time_step;
        sim.guard.max_overlap = 0.6;
        sim.add_wall(ground(facet), stone(1, 0));
        sim.run(0);
        const double before = totals(sim).energy;
        sim.run(0.003);
        CHECK(sim.velocity(0).z > 0);  // it has bounced
        return std::abs(totals(sim).energy / before - 1);
      };
      INFO("facet ", facet, ", form ", form);
      // Second order in the step, as from one plane.
      const double coarse = error(2e-6), fine = error(0.5e-6);
      CHECK(coarse < 2e-3);
      CHECK(fine < 2e-3 / 16);

      one[0].velocity = {0, 0, -0.2}, one[0].angular_velocity = {0, 0, 0};
      silt::Simulation rest{one, silt::Contacts<HertzMindlin>{stone(0.2, 0.5)}};
      rest.gravity = {0, 0, -9.81};
      rest.time_step = 4e-6;
      rest.guard.max_overlap = 0.6;
      rest.add_wall(ground(facet), stone(0.2, 0.5));
      rest.run(0.55);
      const Vec3d here = rest.position(0);
      rest.run(0.05);
      // With friction that follows the normal force across the face, the first cube rocked for ever
      // (0.4 um, 3e-5 m/s).
      CHECK(norm(rest.position(0) - here) < 1e-9);
      CHECK(norm(rest.velocity(0)) < 1e-7);
    }
}

TEST_CASE("A mesh that moves carries a cube, which stays on it") {
  silt::Particles<Polyhedron> one;
  one.add_form(block(1e-3, 1e-3, 1e-3));
  one.add({.position = {0, 0, 1e-3}, .density = 2500});
  silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{stone(0.5, 0.5)}};
  sim.gravity = {0, 0, -9.81};
  // Accelerated gently enough for friction: 1 m/s2 to and fro.
  const auto shake = [](double t) {
    silt::Pose pose{};
    pose.translation = {0.001 * std::sin(30 * t), 0, 0.002 * t};
    return pose;
  };
  sim.add_wall(mesh_box({-0.01, -0.01, 0}, {0.01, 0.01, 0.05}, 3), stone(0.5, 0.5), shake);
  sim.run(0.05);
  const auto off = [&] { return sim.position(0) - shake(sim.time()).translation; };
  const Vec3d from = off();
  sim.run(0.4);
  CHECK(norm(off() - from) < 2e-6);  // the springs' give
  CHECK(near_relative(-sim.wall(0).force.z, 9.81 * sim.mass(0), 0.05));
}

}  // namespace convex_walls_test
