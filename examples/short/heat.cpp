// silt - BSD-3-Clause, see LICENSE
//
// Heat conduction through a bed. Aluminium grains lie between a hot and a cold wall; heat flows
// through their contacts until the flow is steady. Loose grains, which hardly touch others, lag
// behind. The program prints the heat flow and the bed's conductivity.
//
// picture: draw heat/particles.pvd --colour temperature --time 0.2 0.22 0.3 0.6 --range 300,400 --map magma -o heat.png

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material metal{
      .youngs_modulus = 1e7, .poisson_ratio = 0.33, .restitution = 0.3, .friction = 0.3};
  const double length = 0.03, width = 0.01, height = 0.02;  // [m]
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {length, width, 2 * height}},
              {.radius = silt::uniform(0.9e-3, 1.1e-3),
               .density = 2700,
               .solid_volume = 0.6 * length * width * height,
               .arrangement = silt::Arrangement::Random});

  // Soft contacts have too large an area: given the real modulus, silt corrects their conductance.
  // Only 1/10 000 of the real heat capacity, 900 J/(kg K), is used: the flow is steady after 0.4 s
  // instead of an hour, at the same temperatures.
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{metal},
                       silt::HeatConduction{.conductivity = 230,         // [W/(m K)]
                                            .heat_capacity = 900 / 1e4,  // [J/(kg K)]
                                            .youngs_modulus = 70e9,      // [Pa]
                                            .poisson_ratio = 0.33,
                                            .start_temperature = 300}};  // [K]
  sim.gravity = {0, 0, -9.81};
  // [s] sufficient for the contacts. silt would choose a far shorter one because of the heat
  // conduction: the heat capacity is small, and the contacts far larger than these.
  sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, metal, {.name = "hot"});
  sim.add_wall(silt::Plane{{length, 0, 0}, {-1, 0, 0}}, metal, {.name = "cold"});
  sim.add_wall(silt::box({-1, 0, 0}, {1, width, 3 * height}), metal, {.name = "insulated"});
  sim.run(0.2);  // the grains come to rest

  sim.set_wall_heat("hot", silt::held_at(400));  // [K]
  sim.set_wall_heat("cold", silt::held_at(300));
  sim.run(0.4, silt::vtk_series("heat", silt::every(0.02)));

  const double in = sim.given_by_wall<silt::Temperature>("hot").rate;     // [W]
  const double out = -sim.given_by_wall<silt::Temperature>("cold").rate;  // [W]
  const double area = width * 2 * sim.centre_of_mass().z;                 // [m2]
  std::printf("%.3f W come in, %.3f W go out: the bed conducts %.2f W/(m K), its grains 230\n", in,
              out, 0.5 * (in + out) / area * length / 100);

  double coldest = 400, hottest = 300;  // [K]
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    coldest = std::min(coldest, sim.field<silt::Temperature>(k));
    hottest = std::max(hottest, sim.field<silt::Temperature>(k));
  }
  // Fails for heat lost between the walls, and for heat that flows from cold to hot.
  return in > 0 && std::abs(out / in - 1) < 0.05 && coldest >= 300 && hottest <= 400 ? 0 : 1;
}
