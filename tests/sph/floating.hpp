// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

/// What tests of bodies in an Sph share.
namespace sph_test {

inline const silt::HertzMindlin::Material plastic{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};

/// Bodies in liquid 0.1 m deep on a floor, in a space that repeats sideways after `side` [m].
template <class Bodies>
auto floating(Bodies bodies, double side, const std::string& checkpoint) {
  constexpr double g = 9.81;
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 20 * std::sqrt(g * 0.1)},
                  {.spacing = 0.0125,
                   .region = {{0, 0, 0}, {side, side, 0.25}},
                   .smoothing = 1.0,
                   .periodic = {true, true, false}},
                  silt::ArtificialViscosity{.alpha = 0.05}};
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  water.gravity = {0, 0, -g};
  water.fill([](const silt::Vec3d& x) { return x.z < 0.1; });
  silt::Simulation sim{std::move(bodies), silt::Contacts<silt::HertzMindlin>{plastic},
                       std::move(water),
                       silt::PeriodicBox{{{0, 0, 0}, {side, side, 1}}, {true, true, false}}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 2e-5;
  if (!checkpoint.empty()) load_checkpoint(sim, checkpoint);
  return sim;
}

/// All numbers of the liquid and of the first `bodies`, to compare their bits.
template <class Sim>
std::vector<double> state_of(const Sim& sim, std::size_t bodies) {
  std::vector<double> all;
  sim.fluid().for_each(
      [&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d& v, double rho, double) {
        all.insert(all.end(), {x.x, x.y, x.z, v.x, v.y, v.z, rho});
      });
  for (std::size_t k = 0; k < bodies; ++k)
    for (const silt::Vec3d& a : {sim.position(k), sim.velocity(k), sim.angular_velocity(k)})
      all.insert(all.end(), {a.x, a.y, a.z});
  return all;
}

/// Present loads of the liquid on the first `walls` walls.
template <class Sim>
std::vector<double> loads_of(const Sim& sim, std::size_t walls = 1) {
  std::vector<double> all;
  for (std::size_t w = 0; w < walls; ++w) {
    const auto [force, torque] = sim.fluid().wall_load(w, {0.01, 0.02, 0.03});
    for (const silt::Vec3d& a : {force, torque}) all.insert(all.end(), {a.x, a.y, a.z});
  }
  return all;
}

}  // namespace sph_test
