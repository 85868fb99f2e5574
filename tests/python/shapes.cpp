// silt - BSD-3-Clause, see LICENSE
#include "scenes.hpp"

#include <vector>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

namespace {

const silt::HertzMindlin::Material stone{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};

void write_mix(const std::string& folder) {
  using Grains = silt::Mix<silt::Sphere, silt::SuperEllipsoid, silt::Polyhedron>;
  silt::Particles<Grains> grains;
  std::vector<silt::Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 2e-3 : -2e-3, k & 2 ? 1.5e-3 : -1.5e-3, k & 4 ? 1e-3 : -1e-3});
  const auto bead = grains.add_form(silt::Sphere{}, "bead");
  const auto pill = grains.add_form(silt::SuperEllipsoid{2e-3, 2e-3, 1e-3, 6, 2}, "pill");
  const auto brick = grains.add_form(silt::Polyhedron::from_points(corners), "brick");
  for (const auto form : {bead, pill, brick})
    grains.fill(
        {.min = {0, 0, 0}, .max = {0.02, 0.02, 0.03}},
        {.radius = silt::uniform(2.2e-3, 2.6e-3), .density = 2500, .count = 6, .form = form});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{stone}};
  sim.gravity = {0, 0, -9.81}, sim.threads = 1;
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.04}), stone);
  sim.run(0.04, silt::vtk_series(folder, silt::every(0.02)),
          silt::csv_series(folder, silt::every(0.02)));
}

void write_rods(const std::string& folder) {
  silt::Particles<silt::MultiSphere> rods;
  const auto rod = rods.add_form({.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}});
  rods.fill({.min = {0, 0, 0}, .max = {0.012, 0.012, 0.02}},
            {.radius = 2e-3, .density = 2500, .count = 20, .form = rod});
  silt::Simulation sim{std::move(rods), silt::Contacts<silt::HertzMindlin>{stone}};
  sim.gravity = {0, 0, -9.81}, sim.threads = 1;
  sim.add_wall(silt::box({0, 0, 0}, {0.012, 0.012, 0.03}), stone);
  sim.run(0.02, silt::vtk_series(folder, silt::every(0.02)));
}

}  // namespace

void write_shapes(const std::string& folder) {
  write_mix(folder + "/shapes");
  write_rods(folder + "/parts");
}
