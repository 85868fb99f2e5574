// silt - BSD-3-Clause, see LICENSE
//
// docs/sph.md: sand trickles into a tank of water in which a block of wood floats.

#include <cmath>
#include <cstdio>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

int main() {
  const double side = 0.12, depth = 0.06, spacing = 0.006, g = 9.81;  // [m], [m/s2]
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 15},
                  {.spacing = spacing, .region = {{0, 0, 0}, {side, side, 0.12}}},
                  silt::ArtificialViscosity{.alpha = 0.1},
                  silt::UnresolvedGrains{silt::DiFelice{}, {.viscosity = 1e-3}}};
  water.gravity = {0, 0, -g};
  water.fill([=](const silt::Vec3d& x) { return x.z < depth; });

  silt::Particles<silt::Mix<silt::Sphere, silt::Polyhedron>> grains;
  const auto sand = grains.add_form(silt::Sphere{});
  std::vector<silt::Vec3d> corners;
  for (const double x : {-0.03, 0.03})
    for (const double y : {-0.018, 0.018})
      for (const double z : {-0.012, 0.012}) corners.push_back({x, y, z});
  const auto block = grains.add_form(silt::Polyhedron::from_points(corners));
  grains.add({.form = block, .position = {0.06, 0.06, 0.06}, .density = 500});
  for (int k = 0; k < 300; ++k)  // 10 by 10 of 3 mm
    grains.add({.form = sand,
                .position = {0.02 + 0.004 * (k % 10), 0.02 + 0.004 * (k / 10 % 10),
                             0.085 + 0.004 * (k / 100)},
                .radius = 1.5e-3,
                .density = 2600});

  const silt::HertzMindlin::Material quartz{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.5};
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{quartz},
                       std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.add_wall(silt::box({0, 0, 0}, {side, side, 0.12}), quartz, {.name = "tank"});
  sim.run(0.2,
          silt::liquid_probes("sph_sand/probes.csv", {{"floor", {0.02, 0.02, 0}}},
                              silt::every(0.01)),
          silt::liquid_levels("sph_sand/levels.csv", {{"corner", {0, 0, 0}}}, silt::every(0.01)));

  const silt::FluidClosure& books = sim.fluid().closure();
  const auto [force, torque] = sim.fluid().wall_load(0);
  std::printf("block at z = %.4f m, books close to %.0e, load on the tank %.2f N\n",
              sim.position(sim.find(0)).z, books.momentum, force.z);
}
