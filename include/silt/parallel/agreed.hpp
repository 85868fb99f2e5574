// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>

#include <silt/core/target.hpp>

// What a thread remembers of errors that all ranks have thrown together (parallel/agree.hpp).

namespace silt::inline SILT_TARGET::detail {

/// The sentence of the last error that all ranks have agreed on, on this thread: it names its rank,
/// and is told once.
inline std::string& last_agreed() {
  static thread_local std::string sentence;
  return sentence;
}

/// Whether the error under way on this thread is one that all ranks have thrown together: it need
/// not be told again on its way out of what is nested, as where an observer takes a sum.
inline bool& is_agreed() {
  static thread_local bool yes = false;
  return yes;
}

}  // namespace silt::detail
