// silt - BSD-3-Clause, see LICENSE
#pragma once

// Scenes that run on any number of ranks, each a thread of the test, and what is left of them.

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include <silt/ranks.hpp>
#include <silt/parallel/thread_comm.hpp>
#include <silt/simulation.hpp>

namespace silt_test {

/// Slabs along x whose planes move by a third of a slab at each search, to and fro, so that pairs
/// in contact change ranks again and again.
struct WanderingSlabs {
  double from, to;  // [m]
  bool move = true;
  int searches = 0;
  static constexpr bool by_place = false;

  template <class Comm>
  std::vector<int> partition(const Comm& comm, std::span<const silt::Vec3d> points,
                             std::span<const double>) {
    const double shift = move ? (searches++ % 2) / 3.0 : 0;  // [-] of a slab
    std::vector<int> rank;
    for (const silt::Vec3d& p : points)
      rank.push_back(
          std::clamp(static_cast<int>(std::floor((p.x - from) / (to - from) * comm.size() + shift)),
                     0, comm.size() - 1));
    return rank;
  }
};

struct ParticleSeen {
  silt::Vec3d position, velocity, spin;
  bool operator==(const ParticleSeen&) const = default;
};

/// All particles by their ids, put together by the ranks.
class Seen {
 public:
  std::map<silt::ParticleId, ParticleSeen> all;
  bool doubled = false;

  template <class Sim>
  void add(const Sim& sim) {
    const std::lock_guard lock(mutex_);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) {
        ParticleSeen p{sim.position(k), sim.velocity(k), {0, 0, 0}};
        if constexpr (Sim::rotates) p.spin = sim.angular_velocity(k);
        doubled |= !all.emplace(sim.id(k), p).second;
      }
  }
  /// The largest difference of places [m], and of velocities [m/s]; not a number, if others are
  /// seen.
  std::array<double, 2> off(const Seen& other) const {
    std::array<double, 2> most{0, 0};
    if (doubled || all.size() != other.all.size()) return {NAN, NAN};
    for (const auto& [id, p] : all) {
      const auto found = other.all.find(id);
      if (found == other.all.end()) return {NAN, NAN};
      most[0] = std::max(most[0], norm(p.position - found->second.position));
      most[1] = std::max(most[1], norm(p.velocity - found->second.velocity));
    }
    return most;
  }

 private:
  std::mutex mutex_;
};

/// So many spheres in a block, jittered, with velocities at random.
inline silt::Particles<silt::Sphere> cloud(int nx, int ny, int nz, double spacing = 0.0085,
                                           std::size_t materials = 1) {
  silt::Random random(1);
  silt::Particles<silt::Sphere> beads;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        silt::Particles<silt::Sphere>::Particle p;
        const auto at = [&](int n) { return 0.005 + spacing * n + 0.001 * random.uniform(); };
        p.position = {at(i), at(j), at(k)};
        p.radius = 0.003 + 0.0008 * random.uniform(), p.density = 2500;
        p.velocity = {0.3 * (random.uniform() - 0.5), 0.3 * (random.uniform() - 0.5), -0.2};
        p.material = static_cast<std::size_t>(i + j + k) % materials;
        beads.add(p);
      }
  return beads;
}

}  // namespace silt_test
