// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/core/vec3.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET {

/// What a rank has and does.
struct RankLoad {
  std::uint64_t particles = 0, ghosts = 0;  // [-] its own; others', that they may touch
  std::uint64_t contacts = 0;               // [-] pairs that touch, each on one rank
  double work = 0;             // [-] one a particle and one a listed pair; with a ghost half a one
  std::uint64_t migrated = 0;  // [-] particles that came from other ranks, since the start
  std::uint64_t messages = 0, bytes = 0;       // [-], [bytes] sent since the start
  std::uint64_t searches = 0, partitions = 0;  // [-] since the start
};

namespace detail {

/// What a scene needs to know of the ranks that it runs on; a Simulation has these functions as its
/// own. Without Ranks there is one rank, and sums are what they are given.
///
/// On many ranks the functions that say "collective" must be called by every rank, as run() is: in
/// an observer, or between runs, but not behind `if (sim.rank() == 0)`, where the others would be
/// waited for without end. Tests: tests/parallel/rank_output.cpp.
template <class Sim>
class RankAccess {
 public:
  /// The number of this rank, from 0 on: the one to print, and to write files of one's own, is 0.
  int rank() const {
    if constexpr (Sim::has_ranks)
      return sim().engine().ranks.rank();
    else
      return 0;
  }
  /// How many ranks there are.
  int ranks() const {
    if constexpr (Sim::has_ranks)
      return sim().engine().ranks.size();
    else
      return 1;
  }
  /// The sum of a number of each rank, added in the order of ranks: equal on all (collective).
  ///   double above = 0;  // [kg] of own particles: places 0 ... rows()-1 are of this rank alone
  ///   ...
  ///   above = sim.sum_over_ranks(above);
  double sum_over_ranks(double own) const {
    sum_over_ranks(std::span<double>(&own, 1));
    return own;
  }
  Vec3d sum_over_ranks(const Vec3d& own) const {
    std::array<double, 3> sums{own.x, own.y, own.z};
    sum_over_ranks(std::span<double>(sums));
    return {sums[0], sums[1], sums[2]};
  }
  /// Likewise of several numbers at once, as many on each rank.
  void sum_over_ranks([[maybe_unused]] std::span<double> own) const {
    if constexpr (Sim::has_ranks)
      sim().engine().ranks.meet("a sum over ranks"), sim().engine().ranks.sum_of(own);
  }
  /// What each rank has, by its number (collective). Work that is not even is time lost: all wait
  /// for the rank that has most.
  std::vector<RankLoad> rank_loads() const {
    RankLoad own;
    const auto& e = sim().engine();
    const std::size_t rows = e.particles.owned();
    own.particles = e.present(), own.work = static_cast<double>(rows);
    std::size_t with_ghosts = 0;
    e.lists.pairs.for_each([&](std::size_t k) {
      with_ghosts += std::max(e.lists.pairs.first()[k], e.lists.pairs.second()[k]) >= rows;
    });
    own.work += static_cast<double>(e.lists.pairs.size()) - 0.5 * static_cast<double>(with_ghosts);
    own.contacts = e.touching_pairs(sim().domain());
    if constexpr (Sim::has_ranks) {
      const auto& counts = e.ranks.counts;
      own.ghosts = e.particles.ghosts;
      own.migrated = counts.migrated, own.messages = counts.messages, own.bytes = counts.bytes;
      own.searches = counts.searches, own.partitions = counts.partitions;
      e.ranks.meet("a look at the loads");
      return gather_each(e.ranks.comm(), own);
    } else {
      return {own};
    }
  }
  /// The largest that a rank has (collective).
  double largest_over_ranks(double own) const {
    if constexpr (Sim::has_ranks) {
      sim().engine().ranks.meet("a maximum over ranks");
      return sim().engine().ranks.max_of(own);
    }
    return own;
  }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

/// Of measures that know the particles of one process alone.
template <class Sim>
constexpr void need_one_process() {
  static_assert(!Sim::has_ranks,
                "coordination(), contact_loads(), facet_loads(), ring_loads() and coarse-grained "
                "fields know the particles of one process alone: leave Ranks out, or load a "
                "checkpoint of the run into the same scene without Ranks and measure there");
}

/// Does what each rank does by itself; what one throws, all throw (collective).
template <class Sim, class Work>
void on_all_ranks([[maybe_unused]] const Sim& sim, [[maybe_unused]] const char* call,
                  const Work& work) {
  if constexpr (Sim::has_ranks)
    sim.engine().ranks.together(call, work);
  else
    work();
}

}  // namespace detail
}  // namespace silt
