// silt - BSD-3-Clause, see LICENSE
//
// docs/sph.md: balls of steel and of cork in a rotating drum of water.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

int main() {
  const double R = 0.06, spacing = 0.006, width = 12 * spacing, g = 9.81;  // [m], [m/s2]
  const silt::HertzMindlin::Material ball{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.5};
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 20 * std::sqrt(g * R)},
                  {.spacing = spacing,
                   .region = {{-R, 0, -R}, {R, width, R}},
                   .periodic = {false, true, false},
                   .gravity = {0, 0, -g}},
                  silt::LaminarViscosity{.kinematic = 1e-6, .alpha = 0.05}};
  water.fill([=](const silt::Vec3d& x) {
    return x.z < 0 && std::hypot(x.x, x.z) < R - 0.5 * spacing;
  });
  silt::Particles<silt::Sphere> balls;
  balls.add({.position = {0, width / 2, -0.035}, .radius = 0.012, .density = 7800});
  balls.add({.position = {0, width / 2, 0.005}, .radius = 0.012, .density = 240});

  silt::Simulation sim{std::move(balls), silt::Contacts<silt::HertzMindlin>{ball},
                       silt::PeriodicBox{{{-R, 0, -R}, {R, width, R}}, {false, true, false}},
                       std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 2e-5;
  sim.add_wall(silt::Cylinder{{0, -1, 0}, {0, 1, 0}, R, silt::Side::Inside}, ball,
               {.name = "drum",
                .motion = silt::rotation({0, 0, 0}, {0, 1, 0}, std::numbers::pi)});
  sim.run(0.1);
  const auto [force, torque] = sim.fluid().wall_load(0);  // beside the balls' sim.wall("drum").force
  std::printf("steel at %.4f m, cork at %.4f m; the water bears on the drum with %.3f N\n",
              sim.position(0).z, sim.position(1).z, -force.z);
  return sim.position(0).z < -0.03 && sim.position(1).z > -0.005 && sim.fluid().left() == 0 ? 0 : 1;
}
