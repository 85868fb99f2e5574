// silt - BSD-3-Clause, see LICENSE
// SIDE WARMUP STEPS: a cube of SIDE^3 spheres on a lattice, bonded to their neighbours, that
// oscillates along x (peers/bonds.py).

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <utility>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const int side = std::atoi(argv[1]);
  const double radius = 1e-3, modulus = 1e7, step = 1e-6, middle = radius * (side - 1);
  silt::Particles<silt::Sphere> spheres;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        spheres.add({.position = {2 * radius * x, 2 * radius * y, 2 * radius * z},
                     .radius = radius,
                     .density = 2000,
                     .velocity = {(2 * radius * x - middle) * 0.1, 0, 0}});
  // Yade's bond of two equal spheres has k_n = E R; this one E_b pi R/2.
  silt::Simulation sim{
      std::move(spheres),
      silt::Contacts<silt::HertzMindlin>{
          {.youngs_modulus = modulus, .poisson_ratio = 0.4, .restitution = 0.5, .friction = 0.5}},
      silt::Bonds{
          silt::ParallelBond{.youngs_modulus = 2 * modulus / std::numbers::pi, .damping = 0}}};
  silt::bond_near(sim, 0.01 * radius);
  sim.time_step = step, sim.threads = 1;
  const double start = sim.kinetic_energy();
  sim.run(std::atof(argv[2]) * step);
  const auto begin = std::chrono::steady_clock::now();
  sim.run(std::atof(argv[3]) * step);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("seconds %g bonds %zu kinetic %.12g start %.12g\n", took.count(), sim.bonds(),
              sim.kinetic_energy(), start);
}
