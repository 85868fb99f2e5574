// silt - BSD-3-Clause, see LICENSE
//
// A conveyor belt (docs/walls.md): grains dropped on it reach its speed.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material rubber{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.6};
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 10; ++k)
    grains.add({.position = {-0.9 + 0.03 * k, 0, 0.0101}, .radius = 0.01, .density = 2500});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};  // [m/s2]
  sim.add_wall(silt::rectangle({-1, -0.2, 0}, {2, 0, 0}, {0, 0.4, 0}), rubber,
               {.name = "belt", .surface_velocity = {.velocity = {0.7, 0, 0}}});  // [m/s]
  sim.run(0.5);

  // A sphere slides until it rolls on the belt, with 2/7 of its speed.
  const double v = sim.velocity(0).x;
  std::printf("v = %.4f m/s, of a sphere that rolls on the belt %.4f m/s\n", v, 2.0 / 7 * 0.7);
  return std::abs(v - 0.2) < 2e-3 ? 0 : 1;
}
