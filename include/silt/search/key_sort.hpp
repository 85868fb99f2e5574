// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Number of bits for the numbers 0 ... n-1.
inline int bits_for(std::size_t n) {
  return static_cast<int>(std::bit_width(n - std::min<std::size_t>(n, 1)));
}

/// Radix sort of keys by some of their bits: stable, O(n) per digit of at most 11 bits, from the
/// lowest digit. The order does not depend on the number of threads.
template <class Key>
class KeySort {
 public:
  /// By the bits from ... to-1.
  void operator()(DynArray<Key>& keys, int from, int to, const Team& team) {
    if (to <= from) return;
    const int most = keys.size() < 4096 ? 8 : 11, passes = (to - from + most - 1) / most;
    const int digit = (to - from + passes - 1) / passes;
    other_.resize(keys.size());
    for (int shift = from; shift < to; shift += digit)
      sort_digit(keys, shift, std::min(digit, to - shift), team);
  }

 private:
  void sort_digit(DynArray<Key>& keys, int shift, int bits, const Team& team) {
    const std::size_t n = keys.size(), values = std::size_t{1} << bits;
    const std::size_t parts = n < 4096 ? 1 : static_cast<std::size_t>(std::min(team.threads(), 8));
    const auto digit = [=](Key key) { return key >> shift & (values - 1); };
    next_.assign(parts * values, 0);
    team.for_parts(parts, [&](std::size_t part) {
      std::uint32_t* const count = next_.data() + part * values;
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k)
        ++count[digit(keys[k])];
    });
    std::uint32_t place = 0;
    for (std::size_t v = 0; v < values; ++v)
      for (std::size_t part = 0; part < parts; ++part)
        place += std::exchange(next_[part * values + v], place);
    team.for_parts(parts, [&](std::size_t part) {
      std::uint32_t* const next = next_.data() + part * values;
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k)
        other_[next[digit(keys[k])]++] = keys[k];
    });
    keys.swap(other_);
  }

  DynArray<Key> other_;
  DynArray<std::uint32_t> next_;
};

}  // namespace silt::detail
