// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdlib>

namespace pairs {

/// How many pairs a test compares: `usual`, or what the environment variable SILT_TEST_PAIRS says
/// if that is more.
inline int count(int usual) {
  const char* more = std::getenv("SILT_TEST_PAIRS");
  return more ? std::max(usual, std::atoi(more)) : usual;
}

}  // namespace pairs
