// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

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

}  // namespace silt::detail
