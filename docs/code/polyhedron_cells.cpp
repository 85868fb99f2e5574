// silt - BSD-3-Clause, see LICENSE
//
// A block is cut into twelve pieces, which start where they were cut and then fall apart on a floor
// (docs/polyhedra.md).

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material rock{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.3};
  const double a = 5e-3;  // [m] half of the edge
  const auto block = silt::Polyhedron::from_points({{-a, -a, -a},
                                                    {a, -a, -a},
                                                    {-a, a, -a},
                                                    {a, a, -a},
                                                    {-a, -a, a},
                                                    {a, -a, a},
                                                    {-a, a, a},
                                                    {a, a, a}});

  silt::Random random(1);
  std::vector<double> shares(12);  // [-] of the block's volume: 1, 1/2, 1/3, ...
  double sum = 0;
  for (std::size_t k = 0; k < 12; ++k) sum += shares[k] = 1 / (1.0 + static_cast<double>(k));
  for (double& share : shares) share /= sum;
  const auto cells = silt::laguerre_cells(block, shares, random);

  silt::Particles<silt::Polyhedron> pieces;
  const silt::Vec3d place{0, 0, 1.01 * a};  // [m] of the block's own origin
  for (const auto& cell : cells)
    pieces.add({.form = pieces.add_form(cell),
                .position = place + cell.mass_properties().centroid,
                .density = 2600});

  silt::Simulation sim{std::move(pieces), silt::Contacts<silt::HertzMindlin>{rock}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{.point = {0, 0, 0}, .normal = {0, 0, 1}}, rock);
  double mass = 0, worst = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) mass += sim.mass(k);
  for (std::size_t k = 0; k < 12; ++k)
    worst = std::max(worst, std::abs(cells[k].volume() / block.volume() - shares[k]));
  sim.run(1e-4);
  double jump = 0;  // [m/s] of a piece against the first one
  for (std::size_t k = 0; k < sim.rows(); ++k)
    jump = std::max(jump, norm(sim.velocity(k) - sim.velocity(0)));
  std::printf("mass %.3g of the block's, volumes to %.0e of it, kicked apart by %.0e m/s\n",
              mass / (2600 * 8 * a * a * a), worst, jump);
  sim.run(0.2);

  double fastest = 0, widest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    fastest = std::max(fastest, norm(sim.velocity(k))),
    widest = std::max(widest, std::hypot(sim.position(k).x, sim.position(k).y));
  std::printf("after 0.2 s: fastest %.3f m/s, farthest centre %.1f mm\n", fastest, 1e3 * widest);
  // Fails if pieces overlap at birth (kicks), do not fill the block, or fly off.
  if (std::abs(mass / (2600 * 8 * a * a * a) - 1) < 1e-12 && worst < 1e-12 && jump < 1e-6 &&
      fastest < 0.3 && widest < 0.05)
    return 0;
  std::puts(
      "wrong: pieces of the block's mass, at rest against each other when cut, within 50 mm of it");
  return 1;
}
