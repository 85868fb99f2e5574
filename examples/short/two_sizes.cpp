// silt - BSD-3-Clause, see LICENSE
//
// Size segregation in a drum. Small grains of one material and large ones of another rotate in a
// drum: after one or two turns the small ones form a core, surrounded by the large ones.
//
// picture: draw two_sizes/particles.pvd --colour material --names small,large --time 0.3 1.5 3.3 -o two_sizes.png

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material ore{
      .youngs_modulus = 2e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  const silt::HertzMindlin::Material coal{
      .youngs_modulus = 2e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.6};
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials, silt::RollingEpsd> contacts{
      {ore, coal}, {.rolling_friction = 0.1}};
  contacts.add(ore, "ore"), contacts.add(coal, "coal");
  contacts.set_pair(ore, coal, {.restitution = 0.4, .friction = 0.55});

  // A slice of a long drum: periodic along its axis y.
  const double radius = 0.03, depth = 0.0125;  // [m]
  const silt::CylinderRegion drum{{0, 0, 0}, {0, depth, 0}, radius};
  silt::Particles<silt::Sphere> grains;
  grains.fill(drum, {.radius = 2e-3,
                     .density = 1300,
                     .solid_volume = 3.6e-6,  // [m3]
                     .arrangement = silt::Arrangement::Random,
                     .material = contacts.add(coal)});
  grains.fill(drum, {.radius = silt::uniform(0.9e-3, 1.1e-3),
                     .density = 2500,
                     .solid_volume = 2.7e-6,
                     .arrangement = silt::Arrangement::Random,
                     .material = contacts.add(ore)});

  const silt::Box slice{{-radius, 0, -radius}, {radius, depth, radius}};
  silt::Simulation sim{std::move(grains), contacts, silt::PeriodicBox{slice, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  const double rate = 2 * std::numbers::pi * 0.6;  // [rad/s], 36 1/min
  sim.add_wall(silt::Cylinder{{0, 0, 0}, {0, depth, 0}, radius, silt::Side::Inside}, coal,
               {.name = "drum", .motion = silt::rotation({0, 0, 0}, {0, 1, 0}, rate)});

  // Mean distance from the drum's wall of the grains of a material.
  const auto from_wall = [&](std::size_t material) {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (sim.material(k) != material) continue;
      sum += radius - std::hypot(sim.position(k).x, sim.position(k).z), count += 1;
    }
    return sum / count;
  };
  auto files = silt::vtk_series("two_sizes", silt::every(0.1));
  sim.run(0.3, files);
  const double mixed = from_wall(0) - from_wall(1);
  sim.run(3, files);
  const double segregated = from_wall(0) - from_wall(1);

  std::printf(
      "after %.1f turns small grains are %.1f mm further from the wall than large ones "
      "(%.1f mm at first)\n",
      sim.time() * rate / (2 * std::numbers::pi), 1e3 * segregated, 1e3 * mixed);
  // Fails without segregation: in a mixed bed the two distances differ by less than a small grain.
  return segregated > 2e-3 ? 0 : 1;
}
