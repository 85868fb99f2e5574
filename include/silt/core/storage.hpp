// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// [B] Different page offsets of arrays: with equal offsets they would compete for the same cache
/// sets.
inline std::size_t next_shift() {
  static std::atomic<std::size_t> count{0};
  return 320 * (count.fetch_add(1, std::memory_order_relaxed) % 12);
}

}  // namespace detail

namespace detail {

/// Memory aligned to cache lines: rows and packs of lanes never straddle two lines. Large blocks
/// are requested in huge pages (Linux, if /sys/kernel/mm/transparent_hugepage/enabled is "madvise"
/// or "always"). Particles are accessed all over their arrays, and with pages of 4 KiB most of
/// these accesses would wait for the page tables too.
class LineMemory {
 public:
  static void* get(std::size_t bytes, std::align_val_t) {
    if (bytes < large) return ::operator new(bytes, line);
    const std::size_t shift = next_shift();
    const auto base =
        static_cast<std::byte*>(::operator new (bytes + shift, std::align_val_t{page}));
#if defined(MADV_HUGEPAGE)
    // A hint: if it is refused, pages are small.
    static_cast<void>(madvise(base, (bytes + shift) / page * page, MADV_HUGEPAGE));
#endif
    return base + shift;
  }
  static void drop(void* elements, std::size_t bytes, std::align_val_t) {
    if (bytes < large) return ::operator delete(elements, line);
    const auto address = reinterpret_cast<std::uintptr_t>(elements);
    ::operator delete (static_cast<std::byte*>(elements) - address % page, std::align_val_t{page});
  }

 private:
  static constexpr std::align_val_t line{64};
  static constexpr std::size_t page = 2 << 20, large = 4 << 20;  // [B]
};

}  // namespace detail

/// A vector whose memory begins at a cache line, with the members of std::vector.
template <class T>
using AlignedVector = DynArray<T, detail::LineMemory>;

namespace detail {

/// Resizes a vector to n undefined values. If it must grow, it first frees its memory and then
/// allocates an eighth more than needed; old and new memory do not coexist.
template <class V>
void make_room(V& values, std::size_t n) {
  if (n > values.capacity()) {
    values = V();
    values.reserve(n + n / 8);
  }
  values.resize(n);
}

}  // namespace detail

}  // namespace silt
