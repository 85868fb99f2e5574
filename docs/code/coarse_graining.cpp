// silt - BSD-3-Clause, see LICENSE
// The program of docs/contact_data.md, fields on a grid: a bed at rest carries its weight.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({{0, 0, 0}, {0.02, 0.02, 0.06}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 1800});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 1}}, {true, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.run(0.3);

  const silt::CoarseGrid grid{{{0, 0, 6e-3}, {0.02, 0.02, 14e-3}}, {8, 8, 8}};
  auto bed = silt::coarse_grained(grid, silt::LucyKernel{.radius = 4e-3}, silt::every(1e-3));
  sim.run(0.02, bed);
  bed.fields().write_vti("bed.vti");
  bed.fields().write_csv("bed.csv");

  // Means over the layers of the grid: the pressure decreases upwards by the weight of each layer.
  double zz[8] = {}, weight[8] = {}, solid = 0;  // [Pa], [Pa/m]
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) {
        const silt::CoarseValues v = bed.fields().at(i, j, k);
        zz[k] += v.contact_stress.zz / 64, weight[k] += 9.81 * v.density / 64;
        solid += v.solid_fraction / 512;
      }
  double fall = 0;  // [Pa] relative to the inner layers' weight, trapezoidal rule
  for (int k = 0; k < 7; ++k) fall += 0.5 * (weight[k] + weight[k + 1]) * grid.spacing().z;
  std::printf("solid fraction %.3f; stress falls by %.4g Pa, the weight between is %.4g Pa\n",
              solid, zz[0] - zz[7], fall);
  // Fails if the stress has another sign, size or branch vector. The means of the layers are exact,
  // except for the rounding of sums over cells of 1 mm, and the remaining motion.
  const bool right = std::abs((zz[0] - zz[7]) / fall - 1) < 0.02 && solid > 0.5 && solid < 0.7;
  return right ? 0 : 1;
}
