// silt - BSD-3-Clause, see LICENSE
//
// A bed of beads is fluidised. The air velocity is increased: the pressure drop rises until the air
// carries the weight of the beads; then the bed expands and bubbles rise. The program prints the
// minimum fluidisation velocity beside Ergun's.
//
// picture: draw coupled_bed/particles.pvd --colour velocity --time 0.45 0.65 0.7 0.75 --width 1200 -o coupled_bed.png
// picture: curves coupled_bed/pressure.csv --x velocity --y pressure,weight --y-label pressure -o coupled_bed_pressure.png

#include <algorithm>
#include <array>
#include <cstdio>

#include <silt/fluid.hpp>

int main() {
  const double width = 0.036, depth = 0.006, height = 0.09;  // [m]
  const double diameter = 1.5e-3, density = 2500;            // [m], [kg/m3]
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e6,  // [Pa], soft: a larger time step
      .poisson_ratio = 0.25,
      .restitution = 0.9,
      .friction = 0.3,
  };
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {width, depth, 0.05}},
             {.radius = silt::uniform(0.48 * diameter, 0.52 * diameter),
              .density = density,
              .count = 2000});

  // Cells of two diameters. The inlet velocity, uniform over the floor, increases with time.
  const auto velocity = [](double t) { return 2.4 * std::max(t - 0.1, 0.0); };  // [m/s]
  const silt::FluidProperties gas{.density = 1.2, .viscosity = 1.8e-5};         // [kg/m3], [Pa s]
  silt::FlowSolver air(silt::Grid({{0, 0, 0}, {width, depth, height}}, {12, 2, 30}), gas);
  air.set_side(2, 0, silt::Inflow{.velocity_in_time = [=](const silt::Vec3d&, double t) {
                 return silt::Vec3d{0, 0, velocity(t)};
               }});
  air.set_side(2, 1, silt::Outflow{.pressure = 0});
  for (const int direction : {0, 1})  // the slice has no walls that brake the air
    for (const int end : {0, 1}) air.set_side(direction, end, silt::FreeSlip{});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, air}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {width, depth, 2 * height}), glass);

  const double weight = sim.total_mass() * 9.81 / (width * depth);  // [Pa]
  double borne = 0;                                                 // [m/s] from which on
  sim.run(0.1);                                                     // the beads come to rest
  sim.run(0.65, silt::vtk_series("coupled_bed", silt::every(0.05)),
          silt::table("coupled_bed/pressure.csv",
                      {"velocity [m/s]", "pressure drop [Pa]", "weight over area [Pa]"},
                      silt::every(5e-3),
                      [&](const auto& s) {
                        const auto& p = s.fluid().flow().pressure();
                        double mean = 0;  // [Pa] on the floor
                        for (int i = 0; i < 12; ++i)
                          for (int j = 0; j < 2; ++j)
                            mean += (1.5 * p(i, j, 0) - 0.5 * p(i, j, 1)) / 24;
                        const double v = velocity(s.time());
                        if (borne == 0 && mean > 0.98 * weight) borne = v;
                        return std::array{v, mean, weight};
                      }),
          silt::progress());

  const double ergun = silt::minimum_fluidisation_velocity(silt::Ergun{}, 0.41, diameter, density,
                                                           gas.density, gas.viscosity);
  std::printf(
      "the air bears the bed from %.2f m/s on; Ergun's law for a voidage of 0.41: %.2f m/s\n",
      borne, ergun);
  // Fails for a drag or a void fraction with which the bed would be blown out or stay at rest. The
  // kernel smooths the bed's ends over some beads; as the bed is only 18 beads high, it needs a
  // tenth more air.
  return borne > 0.8 * ergun && borne < 1.35 * ergun ? 0 : 1;
}
