// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>

#include <silt/parallel/decomposition/concept.hpp>

namespace silt::inline SILT_TARGET {

/// When a new decomposition pays off: when the work lost by ranks that wait for the one with the
/// largest load, summed over the steps since the last decomposition, has reached the cost of a
/// decomposition. All numbers are counts that every rank knows, so that all ranks take the same
/// decision, reproducibly.
///
///   lost = sum over steps of (largest - mean)
///   cost = each * mean points of a rank + per_moved * largest number of points that a rank sends
///
/// For an imbalance that grows linearly this is the cheapest moment, and the optimum is flat. If
/// the imbalance exceeds the allowed one by more than 60 %, and 1.08 (both the same by default), a
/// quarter of the cost is enough.
///
/// The default costs were compared with benchmarks/rank_costs.cpp: Bisection takes 4 to 6 units per
/// point for each doubling of the ranks, a point that is sent some 26 to 41 (docs/ranks.md).
///
/// How many points will move is not known in advance: the number of the last decomposition is used,
/// and a tenth of the points the first time.
///
/// Units:  work in units of the weights, of one step.
/// Errors: InputError for above < 1 or negative costs.
/// Tests:  tests/parallel/rebalance.cpp.
/// Source: silt's own.
/// Valid:  every decomposition that can be renewed.
struct Rebalance {
  double above = 1.05;    // [-] largest over mean work up to which nothing is done
  double each = 20;       // cost of a decomposition per point of a rank
  double per_moved = 50;  // cost per point that is sent to another rank
  double lost = 0;        // since the last decomposition
  double moved = -1;      // largest number of points that a rank sent then; -1: none yet

  /// Counts `steps` steps of this load; `points`: the mean number of points per rank. Returns
  /// whether to partition now; parted() must be called after that.
  bool due(const Load& load, std::int64_t steps, double points) {
    require(std::isfinite(above) && above >= 1, "Rebalance.above = ", above,
            " [-] must be finite and at least 1");
    require_not_negative("Rebalance.each", each, "-");
    require_not_negative("Rebalance.per_moved", per_moved, "-");
    lost += (load.largest - load.mean) * static_cast<double>(steps);
    const double now = load.imbalance();
    const bool urgent = now - 1 > std::max(1.6 * (above - 1), 0.08);
    return now > above && lost >= cost(points) * (urgent ? 0.25 : 1.0);
  }

  /// Estimated cost of a decomposition, in work.
  double cost(double points) const {
    return each * points + per_moved * (moved < 0 ? 0.1 * points : moved);
  }

  /// After a partition: the largest number of points that a rank has sent to others.
  void parted(std::int64_t largest_sent) {
    moved = static_cast<double>(largest_sent);
    lost = 0;
  }
};

}  // namespace silt
