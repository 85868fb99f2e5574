// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <ctime>
#include <functional>
#include <string>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// What a study measures its costs with.
struct StudyClock {
  std::string name;             // as the table calls it
  std::function<double()> now;  // [s] since some moment
};

namespace detail {

inline double seconds_of(clockid_t which) {
  timespec t{};
  ::clock_gettime(which, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace detail

/// Processor time of all threads of this program: other programs on the machine cost it no more
/// than their share of caches and memory. What is computed on several threads costs their sum.
inline StudyClock processor_time() {
  return {"processor time", [] { return detail::seconds_of(CLOCK_PROCESS_CPUTIME_ID); }};
}

/// Time that passes: for studies of threads, on a machine with nothing else to do.
inline StudyClock wall_time() {
  return {"wall time", [] { return detail::seconds_of(CLOCK_MONOTONIC); }};
}

}  // namespace silt
