// silt - BSD-3-Clause, see LICENSE
#pragma once

// Three balls hit a plate, one normally and two obliquely: milliseconds of computing time, and
// outputs that depend on restitution, friction and stiffness in known ways.

#include <cmath>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

namespace calibrate {

/// Rebound speed over impact speed of the normal impact [-]; tangential speed after over before at
/// 25 and 50 degrees from the normal [-]; contact time of the normal impact [us].
///   p: restitution [-], friction [-], Young's modulus [Pa]
inline std::vector<double> impacts(const std::vector<double>& p) {
  constexpr double radius = 5e-3, density = 2500, speed = 1;  // [m], [kg/m3], [m/s]
  constexpr double angles[] = {0, 25, 50};                    // [degrees] from the normal
  const silt::HertzMindlin::Material material{
      .youngs_modulus = p[2], .poisson_ratio = 0.25, .restitution = p[0], .friction = p[1]};
  silt::Particles<silt::Sphere> balls;
  for (int k = 0; k < 3; ++k) {
    const double a = angles[k] * std::numbers::pi / 180;
    balls.add({.position = {10 * k * radius, 0, 1.0001 * radius},
               .radius = radius,
               .density = density,
               .velocity = {speed * std::sin(a), 0, -speed * std::cos(a)}});
  }
  silt::Simulation sim{std::move(balls), silt::Contacts<silt::HertzMindlin>{material}};
  sim.gravity = {0, 0, 0};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material);
  // Hertz contact time, 2.87 (m^2/(R E*^2 v))^(1/5), of ball and plate of one material.
  const double stiff = p[2] / (2 * (1 - 0.25 * 0.25)), m = density * silt::Sphere::volume(radius);
  const double contact = 2.87 * std::pow(m * m / (radius * stiff * stiff * speed), 0.2);
  const double step = contact / 60;  // [s]
  sim.time_step = step;
  double touched = 0;  // [s]
  for (double t = 0; t < 3 * contact + 1e-4 * radius / speed; t += step) {
    sim.run(step);
    if (sim.position(0).z < radius) touched += step;
  }
  const auto along = [&](std::size_t k) {
    return sim.velocity(k).x / (speed * std::sin(angles[k] * std::numbers::pi / 180));
  };
  return {sim.velocity(0).z / speed, along(1), along(2), 1e6 * touched};
}

}  // namespace calibrate
