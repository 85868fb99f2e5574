// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/contact/rolling/epsd.hpp>

namespace engine_test {

/// Stiffer and more slippery than rubber.
inline constexpr HertzMindlin::Material resin{
    .youngs_modulus = 4e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.2};

using MixedContacts = silt::Contacts<HertzMindlin, silt::RollingEpsd, silt::SeveralMaterials>;

inline MixedContacts mixed_contacts() {
  MixedContacts contacts({rubber, resin}, {.rolling_friction = 0.05});
  contacts.set_pair(rubber, resin, {.restitution = 0.6, .friction = 0.3});
  return contacts;
}

/// A scene with some of everything: two materials, rolling resistance, a direction that repeats,
/// walls that shake, sink and turn (a mesh), spheres that come in and go out, all of them
/// colliding.
template <class Precision = silt::Double>
auto mixed_scene(int threads = 1, const silt::VerletList<>& search = {}, Precision precision = {}) {
  silt::Particles<Sphere> p;
  p.fill({{0, 1e-3, 7e-3}, {16e-3, 15e-3, 15e-3}}, {.radius = silt::uniform(0.4e-3, 0.9e-3),
                                                    .density = 2500,
                                                    .count = 150,
                                                    .arrangement = silt::Arrangement::Random});
  for (std::size_t k = 0; k < p.size(); ++k) {
    p[k].material = k % 3 == 0;
    p[k].velocity = {0, 0, k % 2 ? 0.4 : -0.8};
  }
  silt::Simulation sim{std::move(p), mixed_contacts(), search,
                       silt::PeriodicBox{{{0, 0, 0}, {16e-3, 1, 1}}, {true, false, false}},
                       precision};
  sim.gravity = {0, 3, -9.81};
  sim.threads = threads;
  sim.time_step = 4e-6;
  sim.add_wall(silt::Plane{{0, 0, 0.5e-3}, {0, 0, 1}}, rubber,
               silt::vibration({0, 0, 0.5e-3}, 120));
  sim.add_wall(silt::Plane{{0, 0, 15.2e-3}, {0, 0, -1}}, resin, silt::translation({0, 0, -0.03}));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, resin);
  sim.add_wall(
      silt::TriangleMesh(boundary_test::box_soup({4e-3, 7.6e-3, 1e-3}, {12e-3, 8.4e-3, 6e-3})),
      rubber, silt::rotation({8e-3, 8e-3, 8e-3}, {0, 0, 1}, 150));
  sim.add_inlet(Box{{0, 1e-3, 10e-3}, {16e-3, 15e-3, 14e-3}},
                {.radius = silt::uniform(0.3e-3, 0.5e-3),
                 .density = 2500,
                 .rate = 5000,
                 .velocity = {0, 0.3, -0.5},
                 .material = 1});
  sim.add_outlet({{-1, 16e-3, -1}, {1, 1, 1}});
  return sim;
}

/// 10 000 spheres that fall into a box: so many that pairs are cut into eight shares. Unsorted,
/// every share meets every other.
template <class Precision = silt::Double>
auto many_spheres(int threads, bool sort, Precision precision = {}) {
  constexpr double width = 0.04;  // [m]
  silt::Particles<Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, 0.12}},
               {.radius = silt::uniform(0.9e-3, 1.1e-3),
                .density = 2500,
                .count = 10000,
                .velocity = {0.3, -0.2, -1}});
  const HertzMindlin::Material glass{1e7, 0.3, 0.5, 0.4};
  silt::Simulation sim{std::move(spheres), silt::Contacts<HertzMindlin>{glass},
                       silt::VerletList<>{.sort = sort}, precision};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;
  sim.threads = threads;
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 1}), glass);
  return sim;
}

}  // namespace engine_test
