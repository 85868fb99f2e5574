// silt - BSD-3-Clause, see LICENSE
//
// Pneumatic conveying. Plastic pellets enter a horizontal pipe and are carried by a turbulent air
// flow; the program prints their speed at the outlet and the pressure drop.
//
// picture: draw pneumatic_pipe/particles.pvd --colour velocity.x --time 0.03 0.06 0.2 --walls-as glass --width 1200 -o pneumatic_pipe.png

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/fluid.hpp>

int main() {
  const double length = 0.4, radius = 0.015;               // [m]
  const double area = std::numbers::pi * radius * radius;  // [m2]
  const double speed = 20;                                 // [m/s] of the air, mean
  const silt::HertzMindlin::Material plastic{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.3};

  // The pipe wall, for the pellets and for the air.
  const silt::Cylinder wall{{-0.02, 0, 0}, {length + 0.02, 0, 0}, radius, silt::Side::Inside};
  const double side = 0.0175;  // [m] 3.5 cells
  silt::FlowSolver air(
      silt::Grid({{0, -side, -side}, {length, side, side}}, {80, 7, 7}),  // cells of 5 mm
      {.density = 1.2, .viscosity = 1.8e-5});
  air.set_boundary(silt::boundary_of(wall));
  air.set_turbulence(silt::MixingLength{.half_width = radius});
  air.set_side(0, 0, silt::Inflow{.rate = speed * area});  // [m3/s]
  air.set_side(0, 1, silt::Outflow{.pressure = 0});

  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{plastic},
                       silt::CoupledFlow{silt::DiFelice{}, silt::Kernel{}, air}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(wall, plastic);
  sim.add_outlet({{length, -1, -1}, {length + 0.02, 1, 1}});
  sim.add_inlet(silt::CylinderRegion{{0, 0, 0}, {0.02, 0, 0}, 0.9 * radius},
                {.radius = 1e-3,         // [m]
                 .density = 1000,        // [kg/m3]
                 .velocity = {3, 0, 0},  // [m/s]
                 .mass_rate = 0.02});    // [kg/s]

  // Means over the second half: the pressure at the inlet, and the speed near the end.
  double pressure = 0, looks = 0, leaving = 0, pellets = 0;
  const auto look = [&](const auto& s) {
    if (s.time() < 0.1) return;
    pressure += s.fluid().flow().pressure()(0, 3, 3), ++looks;
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.is_present(k) && s.position(k).x > 0.9 * length) leaving += s.velocity(k).x, ++pellets;
  };
  sim.run(0.2, silt::vtk_series("pneumatic_pipe", silt::every(0.01)),
          silt::at(silt::every(2e-3), look), silt::progress());
  pressure /= looks, leaving /= pellets;

  // Friction of air alone by Blasius' law, plus the momentum that the pellets gain; what they lose
  // at the wall comes on top.
  const double reynolds = 1.2 * speed * 2 * radius / 1.8e-5;
  const double air_alone =
      0.316 / std::pow(reynolds, 0.25) * length / (2 * radius) * 0.6 * speed * speed;  // [Pa]
  const double momentum = 0.02 * (leaving - 3) / area;                                 // [Pa]
  std::printf("pellets leave at %.1f m/s, in air of %.0f m/s\n", leaving, speed);
  std::printf(
      "pressure drop %.0f Pa; friction of air alone %.0f Pa, to speed the pellets up %.0f Pa\n",
      pressure, air_alone, momentum);
  // Fails for pellets that are not carried or are faster than the air, and for drag without a
  // pressure drop.
  const double expected = air_alone + momentum;
  return leaving > 4 && leaving < speed && std::abs(pressure / expected - 1) < 0.4 ? 0 : 1;
}
