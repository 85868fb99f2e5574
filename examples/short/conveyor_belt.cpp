// silt - BSD-3-Clause, see LICENSE
//
// Conveyor belt. Ore falls onto an inclined belt between two skirts, is carried up, and discharges
// at its end. The program prints the mass flow and the drive power of the belt.
//
// picture: draw conveyor_belt/particles.pvd --colour velocity.x --range 0,0.8 --view -25,15 -o conveyor_belt.png

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material ore{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.5};
  const silt::HertzMindlin::Material rubber{
      .youngs_modulus = 5e6, .poisson_ratio = 0.45, .restitution = 0.2, .friction = 0.8};
  silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> contacts{ore, {.rolling_friction = 0.2}};
  contacts.set_pair(ore, rubber, {.restitution = 0.2, .friction = 0.8});

  silt::Simulation sim{silt::Particles<silt::Sphere>{}, contacts};
  sim.gravity = {0, 0, -9.81};

  // The belt is a rectangle at rest with a moving surface.
  const double slope = 10 * M_PI / 180, speed = 0.8, feed = 0.8;  // [rad], [m/s], [kg/s]
  const silt::Vec3d along{std::cos(slope), 0, std::sin(slope)};
  const double length = 0.6, half_width = 0.06;  // [m]
  const silt::Vec3d across{0, 2 * half_width, 0}, up{0, 0, 0.06}, right{0, -half_width, 0};
  const auto belt = sim.add_wall(silt::rectangle(right, length * along, across), rubber,
                                 {.name = "belt", .surface_velocity = {.velocity = speed * along}});
  const silt::Vec3d gap{0, 0, 1e-3};  // between belt and skirts
  sim.add_wall(silt::rectangle(right + gap, length * along, up), ore, {.name = "right skirt"});
  sim.add_wall(silt::rectangle(right + across + gap, length * along, up), ore,
               {.name = "left skirt"});
  sim.add_wall(silt::rectangle(right + gap, across, 2 * up), ore, {.name = "back"});

  const silt::Box inlet{{0.02, -0.04, 0.12}, {0.1, 0.04, 0.16}};
  sim.add_inlet(inlet, {.radius = silt::uniform(4e-3, 6e-3),
                        .density = 2700,
                        .velocity = {0, 0, -0.5},
                        .mass_rate = feed});
  const auto outlet = sim.add_outlet({{-1, -1, -1}, {2, 1, -0.05}});

  auto files = silt::vtk_series("conveyor_belt", silt::every(0.02));
  sim.run(1.5, files);  // until the belt is full
  silt::MeanLoad load(sim, belt);
  const double gone = sim.outlet(outlet).mass, since = sim.time();
  sim.run(1, files);
  const double flow = (sim.outlet(outlet).mass - gone) / (sim.time() - since);  // [kg/s]
  const double power = -dot(load.read(sim).force, along) * speed;               // [W]

  // The belt accelerates the ore - sliding dissipates half of that work - and lifts it.
  const double least = feed * (speed * speed + 9.81 * length * along.z);
  std::printf("%.2f kg/s leave of %.2f kg/s; %.2f W drive the belt, at least %.2f W are needed\n",
              flow, feed, power, least);
  // Fails for a belt that does not convey, and for a wrong magnitude or sign of the force on it.
  return std::abs(flow / feed - 1) < 0.15 && power > 0.9 * least && power < 1.6 * least ? 0 : 1;
}
