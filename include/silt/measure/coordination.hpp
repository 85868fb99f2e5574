// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/core/symmetric3.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Options of coordination().
struct CoordinationOptions {
  bool walls = true;               // walls in contact count as partners, one per surface
  std::size_t least = 2;           // partners that hold a particle; with fewer it is a rattler
  std::optional<Box> region = {};  // averages over particles with their centre in it; left out: all
};

/// Number of partners of the particles.
struct Coordination {
  std::vector<std::uint32_t> of;            // by place; 0 for rows that have left
  double mean = 0;                          // [-]
  double without_rattlers = 0;              // [-] of the others, from contacts with each other
  std::size_t particles = 0, rattlers = 0;  // in the region
};

/// Coordination number: partners of each particle. Two bodies that touch at several points count
/// once. Rattlers, which have fewer than `least` partners, are removed repeatedly until none is
/// left. 2 removes particles that cannot be held even with friction; 4 is the minimum that holds a
/// sphere without friction. Fixed particles are not rattlers.
/// Tests: tests/measure/measures.cpp.
template <class Sim>
Coordination coordination(const Sim& sim, const CoordinationOptions& options = {}) {
  struct Pair {
    std::size_t a, b;
  };
  detail::need_one_process<Sim>();
  const std::size_t n = sim.rows();
  std::vector<Pair> pairs;
  Coordination out;
  out.of.assign(n, 0);
  ParticleId a = no_particle, b = no_particle;
  std::size_t wall = no_wall, surface = 0;
  sim.for_each_contact([&](const ContactSeen& c) {  // those of a pair are adjacent
    const bool again = c.a == a && c.b == b && c.wall == wall && c.surface == surface;
    a = c.a, b = c.b, wall = c.wall, surface = c.surface;
    if (again || !(c.overlap > 0)) return;
    if (c.wall != no_wall && !options.walls) return;
    pairs.push_back({c.place_a, c.place_b});
    ++out.of[c.place_a];
    if (c.wall == no_wall) ++out.of[c.place_b];
  });
  std::vector<std::uint32_t> held = out.of;
  std::vector<char> rattles(n, 0);
  for (bool found = true; found;) {
    found = false;
    for (std::size_t k = 0; k < n; ++k)
      if (!rattles[k] && held[k] < options.least && sim.is_present(k) && std::isfinite(sim.mass(k)))
        rattles[k] = found = true;
    held.assign(n, 0);
    for (const auto& [p, q] : pairs) {
      if (rattles[p] || (q < n && rattles[q])) continue;
      ++held[p];
      if (q < n) ++held[q];
    }
  }
  double all = 0, of_held = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (!sim.is_present(k) || (options.region && !options.region->contains(sim.position(k))))
      continue;
    ++out.particles, out.rattlers += rattles[k] != 0;
    all += out.of[k];
    if (!rattles[k]) of_held += held[k];
  }
  const std::size_t others = out.particles - out.rattlers;
  if (out.particles > 0) out.mean = all / static_cast<double>(out.particles);
  if (others > 0) out.without_rattlers = of_held / static_cast<double>(others);
  return out;
}

/// Fabric tensor of the contacts between particles: the mean of n n^T over their normals [-], with
/// trace 1; 1/3 of the unit tensor if isotropic. `region`: only contacts with their point in it. On
/// many ranks collective (RankAccess).
template <class Sim>
Symmetric3 fabric(const Sim& sim, const std::optional<Box>& region = {}) {
  Symmetric3 sum;
  double count = 0;
  sim.for_each_contact([&](const ContactSeen& c) {
    if (c.wall != no_wall || (region && !region->contains(c.point))) return;
    sum += outer(c.normal), ++count;
  });
  std::array<double, 7> all{sum.xx, sum.yy, sum.zz, sum.xy, sum.yz, sum.zx, count};
  sim.sum_over_ranks(std::span<double>(all));
  sum = {all[0], all[1], all[2], all[3], all[4], all[5]}, count = all[6];
  return count > 0 ? (1 / count) * sum : sum;
}

}  // namespace silt
