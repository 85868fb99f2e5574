// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "sph/floating.hpp"

namespace sph_body_shapes_test {

using namespace silt;

namespace {

constexpr double g = 9.81;

Polyhedron brick(double a, double b, double c) {  // half lengths
  std::vector<Vec3d> corners;
  for (const double x : {-a, a})
    for (const double y : {-b, b})
      for (const double z : {-c, c}) corners.push_back({x, y, z});
  return Polyhedron::from_points(corners);
}
/// A tank of liquid with a ball, a brick and an ellipsoid in it.
auto raft(const std::string& checkpoint = {}) {
  Particles<Mix<Sphere, SuperEllipsoid, Polyhedron>> bodies;
  const auto ball = bodies.add_form(Sphere{}), block = bodies.add_form(brick(0.04, 0.03, 0.025)),
             egg = bodies.add_form(SuperEllipsoid{0.04, 0.03, 0.03});
  bodies.add({.form = ball, .position = {0.15, 0.15, 0.09}, .radius = 0.025, .density = 500});
  bodies.add({.form = block, .position = {0.05, 0.06, 0.1}, .density = 500});
  bodies.add({.form = egg, .position = {0.05, 0.15, 0.06}, .density = 2000});
  return sph_test::floating(std::move(bodies), 0.35, checkpoint);
}
template <class Sim>
std::vector<double> state_of(const Sim& sim) {
  return sph_test::state_of(sim, 3);
}

}  // namespace

TEST_CASE("SPH: a box of half the liquid's density floats half immersed, in 2D") {
  // 0.2 by 0.1 m, in the middle of still water, 8 spacings high: from then on it moves by less than
  // a sixth of a spacing, 2 % of its height (0.7 % seen), the error of where its surface is.
  // Without the pressure on its sides and bottom it would sink by 0.1 m in 0.2 s; points of which
  // one layer more or less counted would shift it by 6 mm.
  const double s = 0.0125, width = 0.6, depth = 0.2;
  Sph water{Liquid{.density = 1000, .sound_speed = 20 * std::sqrt(g * depth)},
            {.spacing = s, .region = {{0, 0, 0}, {width, 0, 0.4}}, .dimensions = 2}};
  water.gravity = {0, 0, -g};
  Particles<Polyhedron> boxes;
  const auto form = boxes.add_form(brick(0.1, 0.5, 0.05));
  boxes.add({.form = form, .position = {0.3, 0, depth}, .density = 500});
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{width, 0, 0}, {-1, 0, 0}});
  water.fill([depth](const Vec3d& x) {
    return x.z < depth && !(std::abs(x.x - 0.3) < 0.1 && x.z > depth - 0.05);
  });
  Simulation sim{std::move(boxes), Contacts<HertzMindlin>{sph_test::plastic}, std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-4;
  double off = 0;
  for (int k = 0; k < 20; ++k) {
    sim.run(0.05);
    off = std::max(off, std::abs(sim.position(0).z - depth));
  }
  CHECK(off < 0.002);
  CHECK(std::abs(sim.position(0).x - 0.3) < 0.002);
  CHECK(std::abs(sim.angular_velocity(0).y) < 0.05);
  // Nothing leaves the plane: what rounding turns out of it would grow.
  CHECK(std::abs(sim.position(0).y) < 1e-20);
  CHECK(std::abs(sim.angular_velocity(0).x) < 1e-20);
  CHECK(std::abs(sim.angular_velocity(0).z) < 1e-20);
  CHECK(sim.fluid().displaced() == 0);
}

TEST_CASE("SPH: a body of any shape gives the liquid what it gets from it") {
  // An askew brick that moves and turns in a box that repeats: the sum of what it got is what the
  // liquid lost, to rounding.
  const double side = 1.2;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 0.1,
             .region = {{0, 0, 0}, {side, side, side}},
             .smoothing = 0.8,
             .periodic = {true, true, true}},
            ArtificialViscosity{.alpha = 0.05}};
  water.fill([](const Vec3d&) { return true; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [](const Vec3d&) { return 2000.0; });
  const Polyhedron shape = brick(0.35, 0.25, 0.2);
  water.take_form(0, shape);
  std::vector<Vec3d> x{{0.3, 0.5, 0.6}}, v{{0.4, 0.1, 0}}, w{{0, 0.5, 0.7}}, force(1), torque(1);
  const std::vector<double> r{std::cbrt(0.75 * 8 * 0.35 * 0.25 * 0.2 / std::numbers::pi)}, one{1},
      held{INFINITY};
  std::vector<Quaternion> axes{rotation_about({0, 0, 1}, 0.4)};
  const std::vector<std::uint32_t> form{0};
  CoupledParticles of{};
  of.shape.position = x, of.shape.radius = r, of.velocity = v, of.volume = one, of.mass = held;
  of.angular_velocity = w, of.shape.orientation = axes, of.shape.form = form;
  Vec3d given{0, 0, 0};
  const double dt = 1e-3;
  for (int k = 0; k < 40; ++k) {
    water.advance(of, dt, force, {}, torque);
    given += dt * force[0], x[0] += dt * v[0];
    axes[0] = rotation_about((1 / norm(w[0])) * w[0], norm(w[0]) * dt) * axes[0];
  }
  CHECK(norm(given) > 1);  // [N s]
  CHECK(norm(water.momentum() + given) < 1e-12 * norm(given));
}

TEST_CASE("SPH with bodies in a Simulation: same bits with threads, and from a checkpoint on") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_shapes.silt").string();
  auto sim = raft();
  sim.run(0.01);
  save_checkpoint(sim, path);
  const auto loads = sph_test::loads_of(sim);
  sim.run(0.0104);
  auto again = raft(path);
  CHECK(sph_test::loads_of(again) == loads);  // with the bodies where and as they were
  again.threads = 3;
  again.run(0.0104);
  CHECK(state_of(again) == state_of(sim));
  // The ball of half the density rises, the egg of twice the density sinks. (Rows of a mix stand by
  // kind.)
  for (std::size_t k = 0; k < 3; ++k) {
    if (sim.id(k) == 0) CHECK(sim.velocity(k).z > 0.01);
    if (sim.id(k) == 2) CHECK(sim.velocity(k).z < -0.01);
  }
  std::filesystem::remove(path);
}

}  // namespace sph_body_shapes_test
