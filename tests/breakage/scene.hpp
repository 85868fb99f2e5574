// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/equivalence.hpp>
#include <silt/breakage/fatigue.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/break_observers.hpp>
#include <silt/simulation.hpp>

// What the tests of breakage share. All numbers are synthetic.
namespace breakage_scene {

using silt::Vec3d;
inline const silt::HertzMindlin::Material salt{
    .youngs_modulus = 2e9, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.3};
inline const silt::LogLogisticStrength strong{
    .median = 8, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3};

using Policy = silt::Breakage<silt::LogLogisticStrength, silt::HertzEquivalence,
                              silt::GaudinSchuhmann, silt::PowerFatigue>;
inline Policy policy(silt::BreakageRules rules = {.dust_below = 0.3e-3},
                     const silt::LogLogisticStrength& strength = strong) {
  return {strength, silt::HertzEquivalence{}, silt::GaudinSchuhmann{1, 0.8},
          silt::PowerFatigue{.kappa = 0.1, .psi = 3}, std::move(rules)};
}

/// Into one or two large fragments; of some seeds the second is all that is left: no dust.
inline Policy halving(silt::BreakageRules rules) {
  Policy of = policy(std::move(rules));
  of.sizes = {40, 0.95};
  return of;
}

/// Without gravity, with the books.
inline auto simulation(silt::Particles<silt::Sphere> grains, Policy of = policy()) {
  return silt::Simulation{std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
                          silt::EnergyLedger{}, std::move(of)};
}
using Sim = decltype(simulation({}));

/// Grains of 0.8 to 1 mm radius that fly at the corner of three planes, 6 to 10 m/s.
inline Sim shower(std::size_t count, Policy of = policy()) {
  silt::Particles<silt::Sphere> feed;
  silt::Random random(3);
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<double>(k % 6), j = static_cast<double>(k / 6 % 6),
               l = static_cast<double>(k / 36);
    feed.add({.position = {0.003 + 0.0025 * i, 0.003 + 0.0025 * j, 0.003 + 0.0025 * l},
              .radius = random.uniform(0.8e-3, 1e-3),
              .density = 2165,
              .velocity = {-random.uniform(0, 4), random.uniform(-2, 2), -random.uniform(6, 10)},
              .angular_velocity = {random.uniform(-500, 500), 0, 300}});
  }
  Sim sim = simulation(std::move(feed), std::move(of));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, salt);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, salt);
  return sim;
}

/// Adds the motion and the strength of each particle, by id.
inline void add_particles(const Sim& sim, std::vector<double>& all) {
  for (silt::ParticleId id = 0; id < 10000; ++id) {
    const std::size_t k = sim.find(id);
    if (k == sim.rows()) continue;
    const Vec3d x = sim.position(k), v = sim.velocity(k), w = sim.angular_velocity(k);
    all.insert(all.end(), {x.x, x.y, x.z, v.x, v.y, v.z, w.x, w.y, w.z,
                           sim.template field<Policy>(k).strength});
  }
}

struct Sums {
  double mass = 0, kinetic = 0;
  Vec3d momentum{0, 0, 0}, angular{0, 0, 0};  // about the origin
};
template <class S>
Sums sums_of(const S& sim) {
  Sums all;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    const double m = sim.mass(k), r = sim.radius(k);
    const Vec3d v = sim.velocity(k), w = sim.angular_velocity(k);
    all.mass += m, all.momentum += m * v;
    all.angular += m * cross(sim.position(k), v) + (0.4 * m * r * r) * w;
    all.kinetic += 0.5 * m * dot(v, v) + 0.2 * m * r * r * dot(w, w);
  }
  return all;
}

}  // namespace breakage_scene
