// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/parallel/thread_comm.hpp>
#include <silt/ranks.hpp>
#include <silt/simulation.hpp>

/// A bed that falls, touches walls and rubs, for one process and for ranks.
namespace rank_scene {

/// Slabs across x of equal width, whatever is in them.
struct Slabs {
  double from = 0, to = 0.055;  // [m]
  static constexpr bool by_place = false;
  template <class Comm>
  std::vector<int> partition(const Comm& comm, std::span<const silt::Vec3d> points,
                             std::span<const double>) const {
    std::vector<int> rank;
    for (const auto& p : points)
      rank.push_back(std::clamp(static_cast<int>((p.x - from) / (to - from) * comm.size()), 0,
                                comm.size() - 1));
    return rank;
  }
};
using Ranks = silt::Ranks<silt::ThreadComm, Slabs>;

struct Options {
  int particles = 6;  // along x; 9 for each of these
  double floor = 0;   // [m]
};

/// Calls use(simulation), on this rank.
template <class Use, class... More>
void with_bed(const Options& how, const Use& use, More... more) {
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
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
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
void on(int ranks, const Options& how, const Use& use) {
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

}  // namespace rank_scene
