// silt - BSD-3-Clause, see LICENSE
//
// Glass beads fall into a box: the shortest complete program. Open out/particles.pvd in ParaView.

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e7,  // [Pa]
      .poisson_ratio = 0.25,  // [-]
      .restitution = 0.8,     // [-]
      .friction = 0.4,        // [-]
  };
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.02, 0.02, 0.10}},  // [m]
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::VerletList<>{.skin = 0.3e-3}, silt::NoFluid{}};
  sim.gravity = {0, 0, -9.81};  // [m/s2]
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.11}), glass);

  sim.run(0.2, silt::vtk_series("out", silt::every(0.01)), silt::progress());
}
