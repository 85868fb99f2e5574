// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/core/random.hpp>
#include <silt/search/verlet_list.hpp>
#include <silt/simulation.hpp>

/// Many-sphere scenes used by several studies: a poured bed and a granular gas.
namespace studies {

inline constexpr double mean_radius = 1e-3;  // [m] 0.9 to 1.1 mm
inline constexpr silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};

/// `count` spheres above the floor of a box, falling at 1 m/s. They are at rest after 0.15 s.
template <class Precision>
auto poured_bed(std::size_t count, Precision precision, const silt::VerletList<>& list = {}) {
  const double width = 2 * mean_radius * std::ceil(std::cbrt(static_cast<double>(count)) * 0.8);
  silt::Particles<silt::Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, 6 * width}},
               {.radius = silt::uniform(0.9 * mean_radius, 1.1 * mean_radius),
                .density = 2500,
                .count = count,
                .velocity = {0.3, -0.2, -1}});
  silt::Simulation sim{std::move(spheres), silt::Contacts<silt::HertzMindlin>{glass}, precision,
                       list};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;
  sim.threads = 1;
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 10 * width}), glass);
  return sim;
}

/// A tenth of a periodic box is filled with spheres that move at about 1 m/s, e = 0.9; mean time
/// between collisions 2.4 ms. All speeds are multiplied by `faster`.
template <class Precision>
auto gas(std::size_t count, Precision precision, double faster = 1,
         const silt::VerletList<>& list = {}) {
  auto material = glass;
  material.restitution = 0.9;
  const double width = mean_radius * std::cbrt(4.0 / 3.0 * M_PI * static_cast<double>(count) / 0.1);
  silt::Particles<silt::Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, width}},
               {.radius = silt::uniform(0.9 * mean_radius, 1.1 * mean_radius),
                .density = 2500,
                .count = count,
                .arrangement = silt::Arrangement::Random});
  silt::Random random(2);
  for (std::size_t k = 0; k < spheres.size(); ++k)
    spheres[k].velocity = {random.uniform(-faster, faster), random.uniform(-faster, faster),
                           random.uniform(-faster, faster)};
  silt::Simulation sim{std::move(spheres), silt::Contacts<silt::HertzMindlin>{material},
                       silt::PeriodicBox{{{0, 0, 0}, {width, width, width}}, {true, true, true}},
                       precision, list};
  sim.time_step = 5e-6;
  sim.threads = 1;
  return sim;
}

/// Velocities [m/s] in the order of the ids, independent of the order in memory.
template <class Sim>
std::vector<double> velocities(const Sim& sim) {
  std::vector<double> out(3 * sim.rows(), 0);
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const silt::Vec3d v = sim.velocity(k);
    double* const to = &out[3 * std::size_t{sim.id(k)}];
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
  }
  return out;
}

template <class Sim>
double kinetic_energy(const Sim& sim) {  // [J] of translation
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sum += 0.5 * sim.mass(k) * dot(sim.velocity(k), sim.velocity(k));
  return sum;
}

template <class Sim>
double mean_height(const Sim& sim) {  // [m] of the centre of mass
  double sum = 0, mass = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sum += sim.mass(k) * sim.position(k).z, mass += sim.mass(k);
  return sum / mass;
}

}  // namespace studies
