// silt - BSD-3-Clause, see LICENSE
// An agglomerate dropped on a plate, of docs/bonds.md: how much of it breaks.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

int main() {
  const double R = 0.5e-3;  // [m]
  const silt::HertzMindlin::Material stone{
      .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{stone},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e8,    // [Pa]
                                                      .tensile_strength = 2e5,  // [Pa]
                                                      .shear_strength = 2e5,    // [Pa]
                                                      .weibull_modulus = 5}}};
  const auto ball = silt::sphere_mesh({0, 0, 0}, 6 * R, 6);
  const auto agglomerate =
      silt::agglomerate(silt::MeshRegion(ball), {.radius = R}, 0.2 * R, {.density = 2500});
  silt::add_bonded(sim, silt::placed(agglomerate, {0, 0, 8 * R}, {}, {0, 0, -4}));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, stone, {.name = "plate"});

  const std::size_t made = sim.bonds();
  double lost = 0;  // [J]
  sim.run(2e-3, silt::on_bond_break([&](const silt::BondBreak& b) { lost += b.energy; }),
          silt::bond_series("bonds", silt::every(5e-4)));

  const auto parts = silt::fragments(sim);
  const auto largest = *std::max_element(parts.spheres.begin(), parts.spheres.end());
  std::printf("%zu spheres; %zu of %zu bonds broke, which took %.2g J\n", sim.size(),
              made - sim.bonds(), made, lost);
  std::printf("%zu pieces, the largest of %zu spheres\n", parts.spheres.size(), largest);
  return sim.broken_bonds() == made - sim.bonds() && parts.spheres.size() > 1 ? 0 : 1;
}
