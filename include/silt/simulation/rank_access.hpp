// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <silt/core/vec3.hpp>
#include <silt/parallel/comm.hpp>
#include <silt/parallel/rank_load.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Information about the ranks that a scene runs on; member functions of Simulation. Without Ranks
/// there is one rank, and sums return their argument.
///
/// With several ranks, functions marked "collective" must be called by every rank, as run() is: in
/// an observer, or between runs, but not inside `if (sim.rank() == 0)`, where that rank would wait
/// for the others forever. Tests: tests/parallel/rank_output.cpp.
template <class Sim>
class RankAccess {
 public:
  /// The number of this rank, from 0 on. Print, and write your own files, on rank 0.
  int rank() const {
    if constexpr (Sim::has_ranks)
      return sim().engine().ranks.rank();
    else
      return 0;
  }
  /// Number of ranks.
  int ranks() const {
    if constexpr (Sim::has_ranks)
      return sim().engine().ranks.size();
    else
      return 1;
  }
  /// The sum of one number over the ranks, added in the order of ranks; the result is the same on
  /// all ranks (collective).
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
  /// The same for several numbers at once; every rank must give the same count.
  void sum_over_ranks([[maybe_unused]] std::span<double> own) const {
    if constexpr (Sim::has_ranks)
      sim().engine().ranks.meet("a sum over ranks"), sim().engine().ranks.sum_of(own);
  }
  /// The load of each rank, in order (collective). Uneven work costs time: all ranks wait for the
  /// one with the largest load.
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
      for (const double more : e.ranks.near_work) own.work += more;
      const auto& counts = e.ranks.counts;
      own.ghosts = e.particles.ghosts;
      own.migrated = counts.migrated, own.messages = counts.messages, own.bytes = counts.bytes;
      own.searches = counts.searches, own.partitions = counts.partitions;
      own.seconds = e.ranks.seconds;
      e.ranks.meet("a look at the loads");
      return gather_each(e.ranks.comm(), own);
    } else {
      return {own};
    }
  }
  /// The maximum over the ranks (collective).
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

/// For measures that only know the particles of one process.
template <class Sim>
constexpr void need_one_process() {
  static_assert(!Sim::has_ranks,
                "coordination(), contact_loads(), facet_loads(), ring_loads() and coarse-grained "
                "fields know the particles of one process alone: leave Ranks out, or load a "
                "checkpoint of the run into the same scene without Ranks and measure there");
}

/// The sum of the size tables of all ranks (collective).
template <class Sim, class Table>
Table merged_over_ranks([[maybe_unused]] const Sim& sim, const Table& own) {
  if constexpr (Sim::has_ranks) {
    const auto numbers = own.state();
    sim.engine().ranks.meet("tables of sizes");
    const auto each = gather(sim.engine().ranks.comm(), std::span<const double>(numbers));
    Table all;
    for (int r = 0; r < each.ranks(); ++r) {
      Table one;
      one.restore(each[r]);
      if (one.classes() == 0) continue;
      if (all.classes() == 0)
        all = one;
      else
        all.merge(one);
    }
    return all;
  } else {
    return own;
  }
}

/// Runs work that each rank does by itself; if it throws on one rank, all throw (collective).
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
