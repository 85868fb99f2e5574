// silt - BSD-3-Clause, see LICENSE
// Bodies at walls that repeat with a PeriodicBox, as wall_images.cpp for spheres.
#include <algorithm>
#include <array>
#include <cmath>

#include <silt/boundary/finite_walls.hpp>
#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

#include "engine/stones.hpp"
#include "engine/support.hpp"

namespace wall_images_bodies_test {

namespace {

using namespace engine_test;
using silt::PeriodicBox;
using Grains = silt::Mix<silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron>;

constexpr double length = 0.015625, half = length / 2;  // [m] a whole number of 2^-k
constexpr std::size_t forms = 4, ball = forms;

auto scene(std::size_t form, const Vec3d& position, const Vec3d& velocity, const Vec3d& spin) {
  silt::Particles<Grains> grains;
  grains.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 0.7e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}});
  grains.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.8e-3, .c = 0.6e-3});
  grains.add_form(block(0.8e-3, 0.6e-3, 0.7e-3));          // sharp
  grains.add_form(block(0.5e-3, 0.7e-3, 0.6e-3, 0.3e-3));  // rounded
  grains.add_form(silt::MultiSphere{{{{0, 0, 0}, 0.8e-3}}});
  grains.add({.form = form,
              .position = position,
              .orientation = silt::rotation_about({0.6, 0, 0.8}, 0.4),
              .density = 2500,
              .velocity = velocity,
              .angular_velocity = spin});
  silt::Simulation sim{std::move(grains), silt::Contacts<HertzMindlin>{stone(0.6, 0.5)},
                       PeriodicBox{{{0, 0, 0}, {length, length, 1}}, {true, true, false}}};
  sim.threads = 1;
  sim.gravity = {0, 0, -9.81}, sim.time_step = 1e-6;
  return sim;
}

}  // namespace

TEST_CASE(
    "wall_images_bodies: bodies that fall on a plate, tip over its edge or are hit by a blade do "
    "the same, to 1e-7, at the corner of a periodic box") {
  for (std::size_t form = 0; form < forms; ++form)
    for (const bool turns : {false, true}) {
      CAPTURE(form);
      CAPTURE(turns);
      const Vec3d way{half, half, 0}, start{half - 1e-3, half - 0.4e-3, 1.8e-3}, v{0.2, 0.1, -0.3},
          w{30, -50, 20};
      auto a = scene(form, start, v, w), b = scene(form, start + way, v, w);
      const auto add = [&](auto& sim, const Vec3d& c) {
        if (turns)
          sim.add_wall(silt::box_mesh(c - Vec3d{3e-3, 2.5e-3, 0.5e-3}, c + Vec3d{3e-3, 2.5e-3, 0}),
                       stone(0.6, 0.5), {.motion = silt::rotation(c, {0.1, 0.3, 1}, 20)});
        else
          sim.add_wall(silt::rectangle(c - Vec3d{3e-3, 2.5e-3, 0}, {6e-3, 0, 0}, {0, 5e-3, 0}),
                       stone(0.6, 0.5));
      };
      add(a, {half, half, 0}), add(b, Vec3d{half, half, 0} + way);
      b.set_reference(0, a.wall(0).reference + way);
      double off = 0, load = 0, largest = 0;
      for (int piece = 0; piece < 40; ++piece) {
        a.run(1e-3), b.run(1e-3);
        const Vec3d apart = b.domain().shortest(b.position(0) - a.position(0) - way);
        off = std::max({off, norm(apart) / 1e-3, norm(a.velocity(0) - b.velocity(0)),
                        1e-3 * norm(a.angular_velocity(0) - b.angular_velocity(0))});
        const auto &wa = a.wall(0), &wb = b.wall(0);
        load = std::max(load, norm(wa.impulse - wb.impulse) +
                                  norm(wa.angular_impulse - wb.angular_impulse) / 1e-3);
        largest = std::max(largest, norm(wa.impulse));
      }
      CHECK(largest > 1e-9);  // it has touched the wall
      CHECK(off < 1e-7);
      CHECK(load < 1e-6 * largest);
    }
}

TEST_CASE(
    "wall_images_bodies: bodies that slide over the faces of a periodic box on a floor of a mesh "
    "that ends there move as on one that covers the box") {
  for (std::size_t form = 0; form < forms; ++form) {
    CAPTURE(form);
    const auto run = [&](bool ends) {
      auto sim = scene(form, {0.8 * length, 0.9 * length, 0.9e-3}, {0.3, 0.15, 0}, {0, 0, 5});
      if (ends)
        sim.add_wall(silt::rectangle({0, 0, 0}, {length, 0, 0}, {0, length, 0}), stone(0.6, 0.5));
      else
        sim.add_wall(silt::rectangle({-1, -1.5, 0}, {3, 0, 0}, {0, 3, 0}), stone(0.6, 0.5));
      sim.run(0.04);
      return std::array{sim.velocity(0), 1e-3 * sim.angular_velocity(0), sim.wall(0).impulse * 1e3};
    };
    const auto ends = run(true), covers = run(false);
    for (std::size_t k = 0; k < 3; ++k) {
      CAPTURE(k);
      CHECK(norm(ends[k] - covers[k]) < 1e-4);
    }
  }
}

// Catches a ridge that is met twice, once by the wall and once by its image, and so is twice as
// stiff: balls of a Mix bounced off it by 1.4 times their time.
TEST_CASE(
    "wall_images_bodies: a ridge at which a mesh ends is that of a mesh that is cut elsewhere") {
  for (std::size_t form = 0; form <= ball; ++form) {
    CAPTURE(form);
    const auto run = [&](bool ends) {
      auto sim = scene(form, {1e-5, half, 1.6e-3}, {0, 0.05, -0.5}, {0, 0, 5});
      sim.gravity = {0, 0, 0};
      // A roof with ridges at multiples of the length, from ridge to ridge or from hollow to
      // hollow.
      const double from = ends ? 0 : -half, depth = 1e-3;
      std::vector<std::array<Vec3d, 3>> mesh;
      for (int k = 0; k < 2; ++k) {
        const double x = from + k * half, y = length;
        const double low = (ends == (k == 0)) ? 0 : -depth, high = -depth - low;
        const Vec3d a{x, 0, low}, b{x + half, 0, high}, c{x + half, y, high}, d{x, y, low};
        mesh.push_back({a, b, c}), mesh.push_back({a, c, d});
      }
      sim.add_wall(silt::TriangleMesh(mesh), stone(0.6, 0.5));
      sim.run(6e-3);
      return std::array{sim.velocity(0), 1e-3 * sim.angular_velocity(0), sim.wall(0).impulse * 1e3};
    };
    const auto ends = run(true), whole = run(false);
    CHECK(norm(whole[2]) > 1e-4);  // it has hit the ridge
    for (std::size_t k = 0; k < 3; ++k) {
      CAPTURE(k);
      CHECK(norm(ends[k] - whole[k]) < 1e-9);
    }
  }
}

}  // namespace wall_images_bodies_test
