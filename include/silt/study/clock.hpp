// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <ctime>
#include <functional>
#include <string>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Clock for the costs of a study.
struct StudyClock {
  std::string name;             // its name in the table
  std::function<double()> now;  // [s] since some moment
};

namespace detail {

inline double seconds_of(clockid_t which) {
  timespec t{};
  ::clock_gettime(which, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace detail

/// Processor time of all threads of this program. Other programs on the machine affect it only
/// through caches and memory. Work of several threads is summed.
inline StudyClock processor_time() {
  return {"processor time", [] { return detail::seconds_of(CLOCK_PROCESS_CPUTIME_ID); }};
}

/// Wall time: for studies of threads, on an idle machine.
inline StudyClock wall_time() {
  return {"wall time", [] { return detail::seconds_of(CLOCK_MONOTONIC); }};
}

}  // namespace silt
