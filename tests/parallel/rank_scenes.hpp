// silt - BSD-3-Clause, see LICENSE
#pragma once

// Scenes that run on any number of ranks, each a thread of the test, and what is left of them.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/parallel/thread_comm.hpp>
#include <silt/ranks.hpp>
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

inline constexpr silt::HertzMindlin::Material glass{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};

/// Slabs of the trough below, whose planes move at each search.
using WanderingRanks = silt::Ranks<silt::ThreadComm, WanderingSlabs>;
inline WanderingRanks wandering(const silt::ThreadComm& comm) {
  return WanderingRanks{comm, {0, 0.11}, {.above = 1, .each = 0, .per_moved = 0}};
}
/// Spheres that fall into a trough and roll to one side.
template <class... Policies>
auto trough(silt::Particles<silt::Sphere> beads, Policies... policies) {
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       std::move(policies)...};
  sim.gravity = {1, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0.04, 0}, {0, -1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass);
  sim.add_wall(silt::Plane{{0.11, 0, 0}, {-1, 0, 0}}, glass);
  return sim;
}

/// Slabs of the bed below that stay, whatever is in them.
inline auto bed_slabs(const silt::ThreadComm& comm) {
  return silt::Ranks{comm, WanderingSlabs{0, 0.055, false}};
}

struct BedOptions {
  int particles = 6;  // along x; 9 for each of these
  double floor = 0;   // [m]
};

/// Calls use(simulation) with a bed that falls, touches walls and rubs, on this rank.
template <class Use, class... More>
void with_bed(const BedOptions& how, const Use& use, More... more) {
  silt::Random random(1);
  silt::Particles<silt::Sphere> beads;
  for (int i = 0; i < how.particles; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const auto near = [&](int n) { return 0.0045 + 0.0085 * n + 0.001 * random.uniform(); };
        silt::Particles<silt::Sphere>::Particle p;
        p.position = {near(i), near(j), near(k)};
        p.radius = 0.003 + 0.0008 * random.uniform(), p.density = 2500;
        p.velocity = {0.5 * (random.uniform() - 0.5), 0.3 * (random.uniform() - 0.5), -0.3};
        beads.add(p);
      }
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}, more...};
  sim.gravity = {2, 0, -9.81}, sim.threads = 1, sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, how.floor}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass);
  sim.add_wall(silt::Plane{{0.055, 0, 0}, {-1, 0, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0.027, 0}, {0, -1, 0}}, glass);
  use(sim);
}

/// Divides the space anew at every search.
inline auto eager(const silt::ThreadComm& comm) {
  return silt::Ranks{comm, silt::Bisection{},
                     silt::Rebalance{.above = 1, .each = 0, .per_moved = 0}};
}
/// On so many ranks; 0: without Ranks.
template <class Use>
void on(int ranks, const BedOptions& how, const Use& use) {
  if (ranks == 0) return with_bed(how, use);
  silt::run_on_ranks(
      ranks, [&](const silt::ThreadComm& comm) { with_bed(how, use, eager(comm)); }, 30);
}

/// A folder of the test's own, removed with all in it.
struct Folder {
  std::string path = (std::filesystem::temp_directory_path() / "silt_ranks_XXXXXX").string();
  Folder() { silt::require(::mkdtemp(path.data()) != nullptr, "no folder for the test"); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

}  // namespace silt_test
