// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace silt {

/// How many threads OpenMP would use by default; 1 without OpenMP.
inline int default_threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

namespace detail {

/// Calls body(part) for part = 0 ... parts-1, shared by `threads`. What each part does must not
/// depend on who does it: results are then the same for every number of threads. Parts are handed
/// out one by one, so that a thread whose core is taken away holds up one part and not its share.
template <class Body>
void in_parallel(int threads, std::ptrdiff_t parts, const Body& body) {
  if (threads <= 1 || parts <= 1) {
    for (std::ptrdiff_t part = 0; part < parts; ++part) body(part);
    return;
  }
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(dynamic)
#endif
  for (std::ptrdiff_t part = 0; part < parts; ++part) body(part);
}

/// The number of pieces of `size` that cover `n`.
constexpr std::size_t pieces(std::size_t n, std::size_t size) { return (n + size - 1) / size; }

}  // namespace detail
}  // namespace silt
