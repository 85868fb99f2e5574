// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>

#include <silt/parallel/decomposition/concept.hpp>

namespace silt::inline SILT_TARGET {

/// When a new decomposition pays: the work that ranks have lost by waiting for the one that has
/// most of it, summed over the steps since the last decomposition, has reached what a decomposition
/// costs. All numbers are counted ones that every rank knows, so that all ranks decide the same,
/// every time.
///
///   lost = sum over steps of (largest - mean)
///   cost = each * mean points of a rank + per_moved * largest number of points that a rank sends
///
/// For an imbalance that grows linearly this is the cheapest moment, and a flat optimum. Where the
/// imbalance exceeds what is allowed by more than 60 %, and 1.08 (both the same by default), a
/// quarter of the cost is enough.
///
/// The default costs were held against benchmarks/rank_costs.cpp: Bisection takes 4 to 6 units a
/// point for each doubling of the ranks, a point that is sent some 26 to 41 (docs/ranks.md).
///
/// How many points move is not known before: it is taken to be as at the last decomposition, at
/// first a tenth of them.
///
/// Units:  work in units of the weights, of one step.
/// Errors: InputError for above < 1 or costs that are negative.
/// Tests:  tests/parallel/rebalance.cpp.
/// Source: silt's own.
/// Valid:  every decomposition that can be made anew.
struct Rebalance {
  double above = 1.05;    // [-] largest over mean work up to which nothing is done
  double each = 20;       // cost of a decomposition for each point of a rank
  double per_moved = 50;  // cost of each point that is sent to another rank
  double lost = 0;        // since the last decomposition
  double moved = -1;      // points that a rank sent then, the largest number; -1: none yet

  /// Counts `steps` steps of such a load; `points`: the mean number of a rank's points. Whether to
  /// partition now; parted() is to be called after that.
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

  /// Work that a decomposition is taken to cost.
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
