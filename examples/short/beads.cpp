// silt - BSD-3-Clause, see LICENSE
//
// A box of beads. Glass beads fall into a box and come to rest; the program prints the depth of the
// bed and the coordination number.
//
// picture: draw beads/particles.pvd --colour velocity --time 0.02 0.05 0.3 -o beads.png

#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e7,  // [Pa], 1000 times softer than glass: a larger time step
      .poisson_ratio = 0.25,
      .restitution = 0.8,
      .friction = 0.4,
  };

  // Random positions in a box, filled with beads of 1.8 to 2.2 mm.
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.03, 0.02, 0.06}},  // [m]
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.03, 0.02, 0.07}), glass);

  // Open beads/particles.pvd in ParaView.
  sim.run(0.3, silt::vtk_series("beads", silt::every(0.01)), silt::progress());

  double top = 0;
  for (std::size_t k = 0; k < sim.size(); ++k) top = std::max(top, sim.position(k).z);
  const double touching =
      2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size());
  std::printf("%zu beads, %.1f mm deep, %.1f contacts a bead\n", sim.size(), 1e3 * top, touching);
  return sim.kinetic_energy() < 1e-8 && touching > 3 ? 0 : 1;  // [J] at rest, and packed
}
