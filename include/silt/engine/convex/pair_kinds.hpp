// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pairs of n kinds: (0, 0), (0, 1) ... (1, 1) ...
template <std::size_t n>
struct PairKinds {
  static constexpr std::size_t count = n * (n + 1) / 2;
  static constexpr std::size_t at(std::size_t a, std::size_t b) {  // a <= b
    return a * n - a * (a + 1) / 2 + b;
  }
  /// Calls `run` as a template of each pair.
  template <std::size_t A = 0, std::size_t B = 0, class Run>
  static void for_all(const Run& run) {
    run.template operator()<A, B>();
    if constexpr (B + 1 < n)
      for_all<A, B + 1>(run);
    else if constexpr (A + 1 < n)
      for_all<A + 1, A + 1>(run);
  }
};

/// A bit mask of the first `left` lanes of a pack.
template <std::size_t W>
constexpr std::uint64_t valid_lanes(std::size_t left) {
  return left >= W ? (std::uint64_t{1} << W) - 1 : (std::uint64_t{1} << left) - 1;
}

}  // namespace silt::detail
