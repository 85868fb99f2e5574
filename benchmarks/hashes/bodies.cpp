// silt - BSD-3-Clause, see LICENSE
// Bodies: multi-spheres, superellipsoids, polyhedra, mixes; planes, meshes, periodic boxes.

#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>

#include "scene_hash.hpp"

namespace {

using Law = silt::HertzMindlin;
const Law::Material stone{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};

std::vector<silt::Vec3d> corners(double a, double b, double c) {
  std::vector<silt::Vec3d> all;
  for (int k = 0; k < 8; ++k) all.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return all;
}

template <class Shape, class Forms, class... Policies>
auto bed(std::size_t count, const Forms& forms, const Policies&... policies) {
  silt::Particles<Shape> all;
  for (const auto& form : forms) {
    const auto number = all.add_form(form);
    all.fill(
        {{0, 0, 0}, {0.02, 0.02, 0.04}},
        {.radius = silt::uniform(1.6e-3, 2e-3), .density = 2500, .count = count, .form = number});
  }
  silt::Simulation sim{std::move(all), silt::Contacts<Law>{stone}, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.06}), stone);
  return sim;
}

auto drum() {
  using Grains = silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron,
                           silt::Compound<silt::Polyhedron>>;
  silt::Particles<Grains> grains;
  const auto slab = silt::Polyhedron::from_points(corners(2e-3, 0.5e-3, 1e-3));
  for (const auto form :
       {grains.add_form(silt::Sphere{}),
        grains.add_form(silt::SuperEllipsoid{2e-3, 2e-3, 1e-3, 6, 2}),
        grains.add_form(silt::Polyhedron::from_points(corners(2e-3, 1.5e-3, 1e-3))),
        grains.add_form(silt::Compound<silt::Polyhedron>{
            .parts = {{slab},
                      {slab, {-1.5e-3, 1.5e-3, 0}, silt::rotation_about({0, 0, 1}, M_PI / 2)}}})})
    grains.fill(
        {{-0.014, 0, -0.014}, {0.014, 0.03, 0.014}},
        {.radius = silt::uniform(2.3e-3, 2.7e-3), .density = 2500, .count = 12, .form = form});
  silt::Simulation sim{
      std::move(grains), silt::Contacts<Law>{stone},
      silt::PeriodicBox{{{-0.02, 0, -0.02}, {0.02, 0.03, 0.02}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, -0.03, 0}, {0, 0.06, 0}, 0.02, silt::Side::Inside}, stone,
               silt::rotation({0, 0, 0}, {0, 1, 0}, 3));
  return sim;
}

}  // namespace

void hashes::bodies() {
  using silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron;
  const std::vector<MultiSphere> rods{
      {.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}},
      {.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1.2e-3}, {{0, 1e-3, 0}, 1e-3}}}};
  print("balls", 0.05, [&] { return bed<MultiSphere>(60, rods); });
  print("balls, mixed", 0.05, [&] { return bed<MultiSphere>(60, rods, silt::Mixed{}); });
  const std::vector<SuperEllipsoid> smooth{{2e-3, 1.5e-3, 1e-3}}, pills{{2e-3, 2e-3, 1e-3, 6, 2}};
  print("ellipsoids, ledger", 0.05,
        [&] { return bed<SuperEllipsoid>(100, smooth, silt::EnergyLedger{}); });
  print("super-ellipsoids", 0.05, [&] { return bed<SuperEllipsoid>(80, pills); });
  print("cubes", 0.05, [&] {
    return bed<Polyhedron>(60, std::vector{Polyhedron::from_points(corners(1e-3, 1e-3, 1e-3))});
  });
  print("mix in a drum, periodic", 0.05, drum);
}
