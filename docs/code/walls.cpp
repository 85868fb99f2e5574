// silt - BSD-3-Clause, see LICENSE
//
// Driven walls (docs/walls.md): a lid that presses with a force, and a box that falls onto it.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 2e7, .poisson_ratio = 0.25, .restitution = 0.6, .friction = 0.4};
  silt::Particles<silt::Sphere> grains;
  grains.fill({.min = {0, 0, 0}, .max = {0.03, 0.03, 0.05}},
              {.radius = silt::uniform(1.5e-3, 2.5e-3), .density = 2500, .count = 300});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};  // [m/s2]
  sim.add_wall(silt::box({0, 0, 0}, {0.03, 0.03, 0.2}), glass, {.name = "container"});
  sim.add_wall(silt::Plane{{0, 0, 0.06}, {0, 0, -1}}, glass,
               {.name = "lid",
                .drive = silt::ServoForce{.direction = {0, 0, -1},  // the wall presses downwards
                                          .force = 2,               // [N]
                                          .max_speed = 0.2}});      // [m/s]

  sim.run(0.3, silt::wall_series("lid.csv", "lid", silt::every(0.01)));
  silt::MeanLoad load(sim, "lid");
  sim.run(0.05);
  const double force = load.read(sim).force.z;  // [N] of the grains on the lid
  std::printf("the lid presses with %.3f N at z = %.4f m\n", force,
              0.06 + sim.wall("lid").pose.translation.z);

  // The lid is slowly pulled up from its present position; a steel box falls onto the bed.
  sim.set_motion("lid", silt::from(sim.time(), silt::translation({0, 0, 0.5})));
  sim.run(0.1);
  sim.remove_wall("lid");
  const auto mesh = silt::box_mesh({0.01, 0.01, 0.026}, {0.02, 0.018, 0.036});
  silt::FreeBody box = silt::free_body(mesh, 7800);  // [kg/m3]
  box.angular_velocity = {5, 0, 0};                  // [rad/s]
  sim.add_wall(mesh, glass, {.name = "box", .drive = box});
  silt::MeanLoad under(sim, "box");
  sim.run(0.5);
  const auto& state = sim.wall("box").state;
  std::printf("the box lies at z = %.4f m and moves with %.2g m/s\n", state.centre.z,
              norm(state.velocity_now));
  const bool holds = std::abs(force - 2) < 0.02 && norm(state.velocity_now) < 0.05 &&
                     state.centre.z > 0 && state.centre.z < 0.03;
  std::printf(holds ? "as it should be\n" : "NOT as it should be\n");
  return holds ? 0 : 1;
}
