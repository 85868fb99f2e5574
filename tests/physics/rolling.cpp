// silt - BSD-3-Clause, see LICENSE
#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>

#include "physics/support.hpp"

namespace rolling_test {

// A sphere with rolling resistance (model C) on a slope and on level ground (V3, B8).

namespace {

using namespace silt;
using namespace physics_test;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
constexpr double mu_r = 0.1;                     // [-]
constexpr HertzMindlin::Material material{
    .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.6};
using Rough = Contacts<HertzMindlin, RollingEpsd>;
using Scene = Simulation<Particles<Sphere>, Rough>;

double stiffness() {
  const double E = effective_modulus(material.youngs_modulus, material.poisson_ratio,
                                     material.youngs_modulus, material.poisson_ratio);
  return hertz_stiffness(E, radius);
}
/// [m] overlap at rest under `weight` [m/s2]
double depth(double weight) {
  return std::pow(mass_of(radius, density) * weight / stiffness(), 2.0 / 3.0);
}

/// On a plane tilted so that +x leads down, pressed in as at rest.
Scene on_slope(double tangent, double rolling_friction, double speed = 0) {
  const double angle = std::atan(tangent);
  const Vec3d gravity{g * std::sin(angle), 0, -g * std::cos(angle)};
  Particles<Sphere> one;
  one.add({.position = {0, 0, radius - depth(-gravity.z)},
           .radius = radius,
           .density = density,
           .velocity = {speed, 0, 0},
           .angular_velocity = {0, speed / radius, 0}});
  Scene sim{std::move(one), Rough{material, {.rolling_friction = rolling_friction}}};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.gravity = gravity;
  sim.threads = 1;
  sim.time_step = 5e-6;  // [s] 20 steps of a contact at 1 m/s
  return sim;
}

}  // namespace

TEST_CASE("rolling: with model C a sphere rests on a slope of tangent below mu_r") {
  for (const double share : {0.3, 0.45, 0.9}) {
    auto sim = on_slope(share * mu_r, mu_r);
    sim.run(0.1);
    const double x = sim.position(0).x;
    sim.run(0.2);
    CAPTURE(share);
    // At rest: what is left of its swing has died away.
    CHECK(std::abs(sim.position(0).x - x) < 1e-6 * radius);
    CHECK(norm(sim.velocity(0)) < 1e-8);
    // It has yielded by the angle M/k_r of the rolling spring, M = m g sin R, and by F/S_t of the
    // tangential one. (From about half of mu_r on, its first swing goes over the limit, and
    // it rolls on by that.)
    const double overlap = depth(-sim.gravity.z);
    const double Sn = 1.5 * stiffness() * std::sqrt(overlap);  // [N/m]
    const double St = 2 * (1 - 0.25) / (2 - 0.25) * Sn;        // [N/m] B2
    const double push = mass_of(radius, density) * sim.gravity.x;
    const double yields = push / (2.25 * Sn * mu_r * mu_r) + push / St;  // [m]
    if (share < 0.5)
      CHECK(near_relative(x, yields, 1e-3));  // the overlap rocks by 1e-4 while it yields
    else
      CHECK(x < 5 * yields);
  }
}

TEST_CASE("rolling: on a steeper slope it rolls with 5/7 g (sin - mu_r cos)") {
  for (const double share : {1.1, 2.0, 4.0}) {
    auto sim = on_slope(share * mu_r, mu_r);
    sim.run(0.1);  // the springs take up their load
    const double time = sim.time(), v = sim.velocity(0).x;
    sim.run(0.2);
    const double a = 5.0 / 7.0 * (sim.gravity.x + mu_r * sim.gravity.z);
    // The lever arm of friction is R less the overlap: a share of each of the terms.
    const double lever_error = depth(g) / radius;
    const double span = sim.time() - time;
    CAPTURE(share);
    CHECK(std::abs(sim.velocity(0).x - v - a * span) < lever_error * sim.gravity.x * span);
    CHECK(near_relative(sim.angular_velocity(0).y * radius, sim.velocity(0).x, 2 * lever_error));
  }
}

TEST_CASE("rolling: without rolling friction the slope's acceleration is that of free rolling") {
  auto sim = on_slope(mu_r, 0);
  sim.run(0.1);
  CHECK(near_relative(sim.velocity(0).x, 5.0 / 7.0 * sim.gravity.x * sim.time(), 2e-4));
}

TEST_CASE("rolling: on level ground it stops after 7 v0/(5 mu_r g) and stays") {
  const double v0 = 0.05;  // [m/s]
  auto sim = on_slope(0, mu_r, v0);
  const double stops = 7 * v0 / (5 * mu_r * g);
  sim.run(0.5 * stops);
  CHECK(near_relative(sim.velocity(0).x, 0.5 * v0, 0.01));
  sim.run(0.5 * stops + 0.2);
  const double way = v0 * stops / 2;
  CHECK(near_relative(sim.position(0).x, way, 0.01));
  CHECK(norm(sim.velocity(0)) < 1e-8);
}

TEST_CASE("rolling: the couples on a pair are equal and opposite") {
  Particles<Sphere> pair;
  pair.add({.position = {0, 0, 0},
            .radius = radius,
            .density = density,
            .velocity = {1, 0.2, 0},
            .angular_velocity = {50, 300, -100}});
  pair.add({.position = {2.5 * radius, 0.2 * radius, 0},
            .radius = 0.6 * radius,
            .density = density,
            .angular_velocity = {-400, 20, 60}});
  Scene sim{std::move(pair), Rough{material, {.rolling_friction = 0.3}}};
  sim.threads = 1;
  const auto angular_momentum = [](const auto& s) {
    Vec3d sum{0, 0, 0};
    for (std::size_t k = 0; k < 2; ++k)
      sum += s.mass(k) * cross(s.position(k), s.velocity(k)) +
             0.4 * s.mass(k) * s.radius(k) * s.radius(k) * s.angular_velocity(k);
    return sum;
  };
  const Vec3d before = angular_momentum(sim);
  const Vec3d spin = spin_of(sim, 1);
  sim.run(1.5e-3);
  CHECK(norm(spin_of(sim, 1) - spin) > 1);  // they did touch
  // Round-off of some thousand steps.
  CHECK(norm(angular_momentum(sim) - before) < 1e-12 * norm(before));
}

}  // namespace rolling_test
