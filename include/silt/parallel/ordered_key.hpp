// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Maps doubles to integers in the same order: a < b if key(a) < key(b), with -0 before +0 and NaN
/// behind all others. The maximum of keys does not depend on the order of comparison, to the bit;
/// that of doubles does.
inline std::int64_t ordered_key(double x) {
  if (x != x) x = std::numeric_limits<double>::quiet_NaN();
  const auto bits = std::bit_cast<std::int64_t>(x);
  return bits < 0 ? bits ^ std::numeric_limits<std::int64_t>::max() : bits;
}

inline double value_of_key(std::int64_t key) {
  return std::bit_cast<double>(key < 0 ? key ^ std::numeric_limits<std::int64_t>::max() : key);
}

}  // namespace silt::inline SILT_TARGET::detail
