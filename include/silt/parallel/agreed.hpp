// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>

#include <silt/core/target.hpp>

// Per-thread record of errors that all ranks have thrown together (parallel/agree.hpp).

namespace silt::inline SILT_TARGET::detail {

/// The message of the last error that all ranks have agreed on, on this thread; it names its rank
/// and is printed once.
inline std::string& last_agreed() {
  static thread_local std::string sentence;
  return sentence;
}

/// Whether the present error on this thread is one that all ranks have thrown together: nested
/// calls that it passes through need not report it again, as where an observer computes a sum.
inline bool& is_agreed() {
  static thread_local bool yes = false;
  return yes;
}

}  // namespace silt::detail
