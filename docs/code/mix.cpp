// silt - BSD-3-Clause, see LICENSE
// The program of docs/shapes.md on polyhedra and mixes.

#include <cstdio>

#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

/// The corners of a block of edges 2a, 2b, 2c.
std::vector<silt::Vec3d> corners(double a, double b, double c) {
  std::vector<silt::Vec3d> all;
  for (int k = 0; k < 8; ++k) all.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return all;
}

int main() {
  using Grains = silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron,
                           silt::Compound<silt::Polyhedron>>;
  silt::Particles<Grains> grains;
  const auto bead = grains.add_form(silt::Sphere{}, "bead");  // a name, for messages
  const auto pill = grains.add_form(silt::SuperEllipsoid{2e-3, 2e-3, 1e-3, 6, 2});
  const auto brick = grains.add_form(silt::Polyhedron::from_points(corners(2e-3, 1.5e-3, 1e-3)));
  const auto slab = silt::Polyhedron::from_points(corners(2e-3, 0.5e-3, 1e-3));
  const auto angle = grains.add_form(silt::Compound<silt::Polyhedron>{
      .parts = {{slab}, {slab, {-1.5e-3, 1.5e-3, 0}, silt::rotation_about({0, 0, 1}, M_PI / 2)}}});
  for (const auto form : {bead, pill, brick, angle})
    grains.fill(
        {.min = {-0.014, 0, -0.014}, .max = {0.014, 0.03, 0.014}},
        {.radius = silt::uniform(2.3e-3, 2.7e-3), .density = 2500, .count = 12, .form = form});
  const silt::HertzMindlin::Material stone{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{stone},
      silt::PeriodicBox{{{-0.02, 0, -0.02}, {0.02, 0.03, 0.02}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, -0.03, 0}, {0, 0.06, 0}, 0.02, silt::Side::Inside}, stone,
               silt::rotation({0, 0, 0}, {0, 1, 0}, 3));  // [rad/s]
  sim.run(0.2);
  std::printf("%zu grains, %zu contacts, the deepest ever %.1f %% of the thinnest half\n",
              sim.size(), sim.touching_pairs(), 100 * sim.peak_overlap());
  return sim.size() == 48 ? 0 : 1;
}
