// silt - BSD-3-Clause, see LICENSE
// Heat in a bed, of docs/heat.md: grains settle on a plate of 5 W in a gas, with the heat of
// friction.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material soft{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.6, .friction = 0.4};
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {0.02, 0.02, 0.02}},
              {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 300});

  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{soft},
      silt::HeatConduction{.conductivity = 1.1,     // [W/(m K)]
                           .heat_capacity = 840,    // [J/(kg K)]
                           .youngs_modulus = 63e9,  // [Pa] of glass, for the real contact circle
                           .poisson_ratio = 0.25,
                           .walls = {{"plate", silt::heated_by(5)}}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft, {.name = "plate"});
  sim.add_wall(silt::box({0, 0, -0.01}, {0.02, 0.02, 0.05}), soft);
  sim.run(0.3);  // until they lie on the plate
  for (std::size_t k = 0; k < sim.rows(); ++k) sim.field<silt::Temperature>(k) = 293.15;  // [K]

  const double begin = sim.time();
  sim.run(0.2, silt::vtk_series("heated", silt::every(0.05)));

  double heat = 0, hottest = 0;  // [J], [K]
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double T = sim.field<silt::Temperature>(k);
    heat += sim.mass(k) * 840 * (T - 293.15), hottest = std::max(hottest, T);
  }
  const double given = 5 * (sim.time() - begin);  // [J]
  std::printf("%.6f J of %.6f J, hottest grain %.2f K\n", heat, given, hottest);
  sim.set_wall_heat("plate", silt::held_at(320));  // [K] from now on
  sim.run(0.05);

  // Fails if the plate gives its power to each contact, if heat is lost between grains, or if
  // insulated walls take heat.
  return std::abs(heat / given - 1) < 1e-9 ? 0 : 1;
}
