// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Memory on cache-line boundaries, so that rows and packs of lanes never straddle two lines.
template <class T>
struct CacheAligned {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  CacheAligned() = default;
  template <class U>
  CacheAligned(const CacheAligned<U>&) {}  // NOLINT: allocators convert
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, alignment); }
  friend bool operator==(CacheAligned, CacheAligned) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, CacheAligned<T>>;

namespace detail {

/// Gives a vector n values whose contents do not matter. Where it must grow, it lets go of what it
/// has first and takes an eighth more than it needs: not both the old and twice the room.
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
