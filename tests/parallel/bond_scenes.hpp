// silt - BSD-3-Clause, see LICENSE
#pragma once

// Bonded spheres on any number of ranks.

#include <doctest/doctest.h>

#include <algorithm>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>

#include "rank_scenes.hpp"

namespace silt_test {

inline constexpr double bonded_radius = 2e-3;  // [m]
inline const silt::ParallelBond tough{.youngs_modulus = 2e7, .damping = 0.05};
/// Breaks where spheres hit the floor.
inline const silt::ParallelBond brittle{.youngs_modulus = 2e7,
                                        .tensile_strength = 2e4,
                                        .shear_strength = 2e4,
                                        .damping = 0.05,
                                        .weibull_modulus = 6};

/// Planes that move at each search.
inline WanderingRanks bond_ranks(const silt::ThreadComm& comm) {
  return WanderingRanks{comm, {0, 0.1}, {.above = 1, .each = 0, .per_moved = 0}};
}
/// A few cubes of 3 x 3 x 3 spheres above each other in a row, bonded in each, that fall.
inline silt::BondedSpheres cubes(int count) {
  constexpr double R = bonded_radius;
  silt::BondedSpheres all;
  silt::Random random(5);
  for (int c = 0; c < count; ++c) {
    const std::size_t first = all.spheres.size();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) {
          const auto at = [&](int n) { return 2 * R * n + 1e-5 * random.uniform(); };
          silt::Particles<silt::Sphere>::Particle p;
          p.position = {0.004 + 0.0135 * c + at(i), 0.004 + at(j),
                        0.0035 + 0.0005 * (c % 3) + at(k)};
          p.radius = R, p.density = 2500, p.velocity = {0.5, 0.1, -1.5};
          all.spheres.push_back(p);
        }
    for (std::size_t a = first; a < all.spheres.size(); ++a)
      for (std::size_t b = a + 1; b < all.spheres.size(); ++b)
        if (norm(all.spheres[a].position - all.spheres[b].position) < 2.2 * R)
          all.bonds.push_back({a, b});
  }
  return all;
}

/// What breaks, put together by the ranks.
struct BrokenBonds {
  std::vector<std::tuple<std::uint64_t, silt::ParticleId, silt::ParticleId, double, double>> all;
  std::mutex mutex;
  void sort() { std::sort(all.begin(), all.end()); }
};
/// A beam of spheres along x, bonded to a wall at its root, that bends under its weight. Its bonds
/// are longer than contacts reach.
template <class... Policies>
auto beam(Policies... policies) {
  silt::Particles<silt::Sphere> spheres;
  for (int k = 0; k < 24; ++k)
    spheres.add({.position = {0.003 + 0.004 * k, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(spheres), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{tough}, silt::EnergyLedger{}, std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass, {.name = "root"});
  sim.bond_to_wall(0, "root", {0, 0, 0}, silt::WallContact::Excluded);
  CHECK(silt::bond_near(sim, 0.0021) == 23);
  return sim;
}

}  // namespace silt_test
