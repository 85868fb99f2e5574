// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Cost and error of one way to compute something.
struct CostAndError {
  double cost;   // > 0, in any unit
  double error;  // >= 0, in any unit
};

/// Pareto front: the numbers of those that no other beats in both, by increasing cost. For each of
/// the others there is one that is cheaper and not worse, or better and not more expensive. Of
/// equal ones the first is taken.
/// Errors: InputError for a cost that is not positive or an error that is negative or not finite.
/// Tests:  tests/study/pareto.cpp.
inline std::vector<std::size_t> pareto_front(std::span<const CostAndError> all) {
  std::vector<std::size_t> order(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    require_positive("pareto_front: cost", all[k].cost, "-");
    require_not_negative("pareto_front: error", all[k].error, "-");
    order[k] = k;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return all[a].cost != all[b].cost ? all[a].cost < all[b].cost : all[a].error < all[b].error;
  });
  std::vector<std::size_t> front;
  for (const std::size_t k : order)
    if (front.empty() || all[k].error < all[front.back()].error) front.push_back(k);
  return front;
}

/// Knee of a Pareto front, beyond which cost reduces the error less. In logarithms of cost and
/// error, scaled such that the cheapest is at (0, 1) and the most expensive at (1, 0), it is the
/// point farthest below the straight line x + y = 1. Returns its index in the front; empty if the
/// front has fewer than three points or no point is at least 0.05 below the line: a power law has
/// no knee. An error of 0 counts as a tenth of the smallest other one.
///   front: as returned by pareto_front
inline std::optional<std::size_t> knee_of(std::span<const CostAndError> front) {
  constexpr double least_depth = 0.05;  // [-]
  if (front.size() < 3) return std::nullopt;
  const auto log_error = [&](const CostAndError& p) {
    return std::log(p.error > 0 ? p.error : 0.1 * front[front.size() - 2].error);
  };
  const double x0 = std::log(front.front().cost), x1 = std::log(front.back().cost);
  const double y0 = log_error(front.front()), y1 = log_error(front.back());
  std::optional<std::size_t> knee;
  double deepest = least_depth;
  for (std::size_t k = 1; k + 1 < front.size(); ++k) {
    const double x = (std::log(front[k].cost) - x0) / (x1 - x0);
    const double y = (log_error(front[k]) - y1) / (y0 - y1);
    if (1 - x - y >= deepest) deepest = 1 - x - y, knee = k;
  }
  return knee;
}

}  // namespace silt
