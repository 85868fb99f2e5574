// silt - BSD-3-Clause, see LICENSE
#pragma once

// The beds shared by the benchmarks, of spheres or of bodies: Hertz, Tsuji damping, Mindlin spring
// with the slip as history, Coulomb friction.

#include <algorithm>
#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/simulation.hpp>

namespace bench {

using Law =
    silt::BasicHertzMindlin<silt::DampingEnd::ZeroOverlap, silt::TangentialMemory::Displacement>;
inline constexpr double time_step = 2e-5;  // [s]

/// Side of the square box [m]: up to 50 000 spheres the same, then beds of the same depth.
inline double width_for(std::size_t n) {
  return 0.15 * std::sqrt(std::max(1.0, static_cast<double>(n) / 50000));
}

inline constexpr Law::Material material{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};

/// Particles in an open box with a square floor of `width` [m], the last of its walls.
template <class Shape, class... Policies>
auto bed(silt::Particles<Shape> particles, double width, int threads, Policies... policies) {
  const Law::Material& m = material;
  silt::Simulation sim{std::move(particles), silt::Contacts<Law>{m}, std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step;
  sim.threads = threads;
  sim.guard.max_overlap = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, m);
  sim.add_wall(silt::Plane{{width, 0, 0}, {-1, 0, 0}}, m);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, m);
  sim.add_wall(silt::Plane{{0, width, 0}, {0, -1, 0}}, m);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m);
  return sim;
}

template <class Precision>
auto bed(silt::Particles<silt::Sphere> spheres, int threads, Precision precision) {
  const double width = width_for(spheres.size());
  return bed(std::move(spheres), width, threads, precision);
}

template <class Sim>
double kinetic_energy(const Sim& sim) {
  double e = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    e += 0.5 * sim.mass(k) * silt::dot(sim.velocity(k), sim.velocity(k));
  return e;
}

inline silt::Particles<silt::Sphere> lattice(std::size_t n) {
  silt::Random random(1);
  const double r_max = 2.35e-3, spacing = 2 * r_max * 1.02, width = width_for(n);
  const int side = static_cast<int>(width / spacing);
  silt::Particles<silt::Sphere> spheres;
  for (std::size_t k = 0; k < n; ++k) {
    const auto layer = static_cast<double>(k / static_cast<std::size_t>(side * side));
    const int place = static_cast<int>(k % static_cast<std::size_t>(side * side));
    const auto jitter = [&] { return random.uniform(-3e-5, 3e-5); };
    spheres.add(
        {.position = {(place % side + 0.5) * width / side + jitter(),
                      (place / side + 0.5) * width / side + jitter(), (layer + 0.5) * spacing},
         .radius = random.uniform(1.95e-3, 2.35e-3),
         .density = 2500});
  }
  return spheres;
}

}  // namespace bench
