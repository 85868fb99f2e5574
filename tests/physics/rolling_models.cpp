// silt - BSD-3-Clause, see LICENSE
#include <algorithm>
#include <cmath>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/directional.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/own.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/contact/rolling/viscous.hpp>

#include "boundary/support.hpp"
#include "physics/support.hpp"

namespace rolling_models_test {

// Rolling models A, B, D and twisting against their closed forms (B8); model C: rolling.cpp.

namespace {

using namespace silt;
using namespace physics_test;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
constexpr HertzMindlin::Material material{
    .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.6};

/// [m] overlap at rest under `weight` [m/s2]
double depth(double weight) {
  const double E = effective_modulus(1e8, 0.25, 1e8, 0.25);
  return std::pow(mass_of(radius, density) * weight / hertz_stiffness(E, radius), 2.0 / 3.0);
}

/// On a plane tilted so that +x leads down, pressed in as at rest, rolling or spinning.
template <class Rolling>
auto on_slope(const typename Rolling::Pair& pair, double tangent, double speed, double twist,
              bool mesh = false) {
  const double angle = std::atan(tangent);
  const Vec3d gravity{g * std::sin(angle), 0, -g * std::cos(angle)};
  Particles<Sphere> one;
  one.add({.position = {0, 0, radius - depth(-gravity.z)},
           .radius = radius,
           .density = density,
           .velocity = {speed, 0, 0},
           .angular_velocity = {0, speed / radius, twist}});
  Simulation sim{std::move(one), Contacts<HertzMindlin, Rolling>{material, pair}};
  if (mesh)
    sim.add_wall(TriangleMesh(boundary_test::box_soup({-1, -1.3, -1}, {1, 1, 0})), material);
  else
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.gravity = gravity;
  sim.threads = 1;
  sim.time_step = 5e-6;  // [s] 20 steps of a contact at 1 m/s
  return sim;
}

/// Models A and D on a wall: R* = R, and w is the sphere's own.
template <class Model>
void stops_and_rolls() {
  const double mu_r = 0.1, v0 = 0.05;
  for (const bool mesh : {false, true}) {
    auto level = on_slope<Model>({mu_r}, 0, v0, 0, mesh);
    const double stops = 7 * v0 / (5 * mu_r * g);
    level.run(0.5 * stops);
    CHECK(near_relative(level.velocity(0).x, 0.5 * v0, 0.01));
    level.run(0.5 * stops + 0.1);
    CHECK(near_relative(level.position(0).x, v0 * stops / 2, 0.01));
    CHECK(norm(level.velocity(0)) < 1e-8);
  }
  for (const double share : {1.5, 4.0}) {
    auto slope = on_slope<Model>({mu_r}, share * mu_r, 0, 0);
    slope.run(0.05);
    const double time = slope.time(), v = slope.velocity(0).x;
    slope.run(0.1);
    const double a = 5.0 / 7.0 * (slope.gravity.x + mu_r * slope.gravity.z);
    CAPTURE(share);
    // The lever arm of friction is R less the overlap: a share of each of the terms.
    CHECK(std::abs(slope.velocity(0).x - v - a * (slope.time() - time)) <
          2 * depth(g) / radius * slope.gravity.x * 0.1);
  }
  // Below mu_r it does not roll off, but creeps: damped over 8 steps.
  auto creeps = on_slope<Model>({mu_r}, 0.5 * mu_r, 0, 0);
  creeps.run(0.2);
  const double v = creeps.velocity(0).x;
  CHECK(v > 0);
  CHECK(v < 8 * 5e-6 * creeps.gravity.x);
}

}  // namespace

TEST_CASE(
    "rolling models: with A and D a sphere stops after 7 v0/(5 mu_r g), and rolls down a slope "
    "with 5/7 g (sin - mu_r cos)") {
  stops_and_rolls<RollingDirectional>();
  stops_and_rolls<RollingOwn>();
}

TEST_CASE("rolling models: with B the speed decays as exp(-5/7 mu_v g t)") {
  const double mu_v = 2, v0 = 0.05;  // [s/m], [m/s]
  auto sim = on_slope<RollingViscous>({mu_v}, 0, v0, 0);
  for (int k = 0; k < 4; ++k) {
    sim.run(0.05);
    // The contact rocks, and slips a little as it takes up its load.
    CHECK(near_relative(sim.velocity(0).x, v0 * std::exp(-5.0 / 7 * mu_v * g * sim.time()), 5e-3));
  }
}

TEST_CASE("rolling models: twisting brakes a spin at 3 pi/16 mu a F_n over I, then holds") {
  const double mu = 0.4, w0 = 20;
  const double a = std::sqrt(radius * depth(g)), mass = mass_of(radius, density);
  const double rate = 3 * pi / 16 * mu * a * mass * g / (0.4 * mass * radius * radius);
  for (const bool mesh : {false, true}) {
    auto sim = on_slope<Twisting>({.twisting_friction = mu}, 0, 0, w0, mesh);
    const double stops = w0 / rate;
    sim.run(0.5 * stops);
    CHECK(near_relative(sim.angular_velocity(0).z, 0.5 * w0, 2e-3));
    sim.run(0.5 * stops + 0.5);
    CHECK(std::abs(sim.angular_velocity(0).z) < 1e-6 * w0);
  }
  auto free = on_slope<RollingDirectional>({0.1}, 0, 0, w0);
  free.run(0.1);
  CHECK(near_relative(free.angular_velocity(0).z, w0, 1e-9));  // nothing else brakes it
}

TEST_CASE("rolling models: rolling and twisting resistance together, each its own") {
  using Full = Both<RollingEpsd, Twisting>;
  const double mu_r = 0.1, v0 = 0.05;
  auto sim = on_slope<Full>({{.rolling_friction = mu_r}, {.twisting_friction = 0.4}}, 0, v0, 20);
  const double stops = 7 * v0 / (5 * mu_r * g);
  sim.run(0.5 * stops);
  CHECK(near_relative(sim.velocity(0).x, 0.5 * v0, 0.01));
  CHECK(sim.angular_velocity(0).z < 20);
  sim.run(0.5 * stops + 0.5);
  CHECK(norm(sim.velocity(0)) < 1e-8);
  CHECK(norm(sim.angular_velocity(0)) < 1e-5);
}

namespace {

/// Two spheres pressed together along x by their own weights, that spin about it or across it.
template <class Rolling>
auto pair(const typename Rolling::Pair& values, const Vec3d& spin_i, const Vec3d& spin_j) {
  Particles<Sphere> p;
  p.add({.position = {0, 0, 0},
         .radius = radius,
         .density = density,
         .velocity = {0.1, 0, 0},
         .angular_velocity = spin_i});
  p.add({.position = {1.6 * radius, 0, 0},
         .radius = 0.6 * radius,
         .density = density,
         .velocity = {-0.1, 0, 0},
         .angular_velocity = spin_j});
  Simulation sim{std::move(p), Contacts<HertzMindlin, Rolling>{material, values}};
  sim.threads = 1;
  return sim;
}
template <class Sim>
Vec3d angular_momentum(const Sim& s) {
  Vec3d sum{0, 0, 0};
  for (std::size_t k = 0; k < 2; ++k)
    sum += s.mass(k) * cross(s.position(k), s.velocity(k)) +
           0.4 * s.mass(k) * s.radius(k) * s.radius(k) * s.angular_velocity(k);
  return sum;
}
template <class Rolling>
double momentum_lost(const typename Rolling::Pair& values) {
  auto sim = pair<Rolling>(values, {50, 300, -100}, {-400, 20, 60});
  const Vec3d before = angular_momentum(sim), spin = spin_of(sim, 1);
  sim.run(1e-3);
  CHECK(norm(spin_of(sim, 1) - spin) > 1);  // they did touch
  return norm(angular_momentum(sim) - before) / norm(before);
}

}  // namespace

TEST_CASE(
    "rolling models: couples of A, B and twisting conserve angular momentum, those of D do not") {
  // Round-off of some thousand steps.
  CHECK(momentum_lost<RollingDirectional>({0.3}) < 1e-12);
  CHECK(momentum_lost<RollingViscous>({5}) < 1e-12);
  CHECK(momentum_lost<Twisting>({0.3}) < 1e-12);
  CHECK(momentum_lost<Both<RollingEpsd, Twisting>>({{0.3}, {0.3}}) < 1e-12);
  CHECK(momentum_lost<RollingOwn>({0.3}) > 1e-4);
}

TEST_CASE("rolling models: D brakes spheres of a pair by mu_r R_i times the impulse between them") {
  // Rotating alike, across the normal, without friction: nothing but the model acts on the spins.
  auto slick = material;
  slick.friction = 0;
  Particles<Sphere> p;
  const double w0 = 5000;
  p.add({.position = {0, 0, 0},
         .radius = radius,
         .density = density,
         .velocity = {0.1, 0, 0},
         .angular_velocity = {0, 0, w0}});
  p.add({.position = {1.61 * radius, 0, 0},
         .radius = 0.6 * radius,
         .density = density,
         .angular_velocity = {0, 0, w0}});
  Simulation sim{std::move(p),
                 Contacts<HertzMindlin, RollingOwn>{slick, {.rolling_friction = 0.2}}};
  sim.threads = 1;
  sim.run(1e-3);
  const double impulse = mass_of(0.6 * radius, density) * velocity_of(sim, 1).x;  // [N s]
  for (const std::uint32_t k : {0u, 1u}) {
    const double R = k == 0 ? radius : 0.6 * radius;
    const double I = 0.4 * mass_of(R, density) * R * R;
    CAPTURE(k);
    CHECK(near_relative(w0 - spin_of(sim, k).z, 0.2 * R * impulse / I, 1e-9));
  }
}

}  // namespace rolling_models_test
