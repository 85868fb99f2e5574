// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/parallel/agree.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET {

/// Which rank owns which point. A decomposition knows nothing but points and their weights.
///
///   partition(comm, points, weights)   collective; each rank gives its own points and the work of
///                                      each; returns the new rank of each point. A point that is
///                                      not finite stays
///   by_place                           whether a position alone determines the rank. If so,
///   rank_of(place)                     returns the rank after the last partition; it is the rank
///                                      that partition has returned for a point there
///
/// A policy may have for_each_state(visit), which calls visit(value) for each number, or vector of
/// numbers, that it remembers of the previous partition. Checkpoints then save these, and a run
/// continued from one on the same number of ranks is bitwise the same. Without it space is divided
/// anew.
///
/// The result depends on points, weights and the remembered values only, not on clocks or on the
/// order of messages: results are bitwise reproducible.
template <class D, class C>
concept Decomposition = Communicator<C> && std::movable<D> &&
    requires(D& parts, const D& same, const C& comm, std::span<const Vec3d> points,
             std::span<const double> weights) {
  { parts.partition(comm, points, weights) } -> std::same_as<std::vector<int>>;
  { D::by_place } -> std::convertible_to<bool>;
  requires !D::by_place || requires {
    { same.rank_of(Vec3d{}) } -> std::same_as<int>;
  };
};

/// Work of all ranks: the largest of one rank, the mean, and the rank with the largest.
struct Load {
  double largest = 0, mean = 0;  // [-] in units of the weights
  int rank = 0;

  /// Largest over mean; 1 is ideal.
  double imbalance() const { return mean > 0 ? largest / mean : 1; }
};

/// Collective: the load if this rank has this much work.
template <Communicator C>
Load load_of(const C& comm, double own) {
  const auto each = gather_each(comm, own);
  Load load;
  double total = 0;
  for (std::size_t r = 0; r < each.size(); ++r) {
    if (each[r] > load.largest) load.largest = each[r], load.rank = static_cast<int>(r);
    total += each[r];
  }
  load.mean = total / static_cast<double>(each.size());
  return load;
}

namespace detail {

/// Weights as integers, whose sums do not depend on order and so not on the distribution of points;
/// and what all ranks know of the points together.
struct WholeWeights {
  std::vector<std::int64_t> weights;  // of finite points, else 0
  std::int64_t total = 0;             // of all ranks
  std::int64_t points = 0;            // finite ones, of all ranks
  Box box;                            // of all ranks' points

  /// Collective.
  template <Communicator C>
  WholeWeights(const C& comm, std::span<const Vec3d> all, std::span<const double> given) {
    std::exception_ptr error;
    double largest = 0;
    try {
      largest = check(all, given);
    } catch (const Error&) {
      error = std::current_exception();
    }
    for (const auto& p : all)
      if (is_finite(p)) box.include(p), ++points;
    std::array<double, 7> most{-box.min.x, -box.min.y, -box.min.z, box.max.x,
                               box.max.y,  box.max.z,  largest};
    agree(comm, "partition of points", error, most);
    largest = most[6];
    box = {{-most[0], -most[1], -most[2]}, {most[3], most[4], most[5]}};
    comm.sum_of({&points, 1});
    // The sum is below 2^60: exact, and far from the range of 64 bits.
    const int bits = 59 - static_cast<int>(std::bit_width(static_cast<std::uint64_t>(points)));
    const int shift = largest > 0 ? bits - std::ilogb(largest) - 1 : 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const bool counts = is_finite(all[k]);
      weights.push_back(!counts ? 0 : largest > 0 ? std::llround(std::ldexp(given[k], shift)) : 1);
      total += weights.back();
    }
    comm.sum_of({&total, 1});
  }

 private:
  static double check(std::span<const Vec3d> all, std::span<const double> given) {
    require(all.size() == given.size(), "partition: ", all.size(), " points and ", given.size(),
            " weights; each point has one");
    double most = 0;
    for (std::size_t k = 0; k < given.size(); ++k) {
      require(std::isfinite(given[k]) && given[k] >= 0, "partition: weight ", k, " = ", given[k],
              " [-] must be finite and not negative");
      most = std::max(most, given[k]);
    }
    return most;
  }
};

/// m/n of a whole number, rounded down, without overflow.
inline std::int64_t share_of(std::int64_t whole, int m, int n) {
  return whole / n * m + whole % n * m / n;
}

}  // namespace detail

}  // namespace silt
