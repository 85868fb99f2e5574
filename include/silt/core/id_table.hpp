// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A place for each id, in pages that are allocated only for ids in use: high ids cost no more
/// memory than low ones. Both calls take constant time.
class IdTable {
 public:
  std::uint32_t& at(ParticleId id) {
    const std::size_t p = id / page;
    if (p >= pages_.size()) pages_.resize(p + 1);
    if (pages_[p].empty()) pages_[p].assign(page, no_place);
    return pages_[p][id % page];
  }
  std::uint32_t find(ParticleId id) const {
    const std::size_t p = id / page;
    return p < pages_.size() && !pages_[p].empty() ? pages_[p][id % page] : no_place;
  }
  void clear() { pages_.clear(); }
  std::size_t bytes() const {
    std::size_t sum = pages_.capacity() * sizeof(pages_[0]);
    for (const auto& p : pages_) sum += p.capacity() * sizeof(std::uint32_t);
    return sum;
  }

 private:
  static constexpr std::size_t page = 1 << 12;
  DynArray<DynArray<std::uint32_t>> pages_;
};

/// The same for a sparse set of ids, as those of the particles of one of many ranks: 16 to 32 bytes
/// each for any ids, 24 to 48 while it grows. Open addressing.
class IdHash {
 public:
  std::uint32_t& at(ParticleId id) {
    if (4 * (count_ + 1) > 3 * ids_.size()) grow();
    const std::size_t k = slot_of(id);
    if (ids_[k] != id) ids_[k] = id, places_[k] = no_place, ++count_;
    return places_[k];
  }
  std::uint32_t find(ParticleId id) const {
    if (count_ == 0) return no_place;
    const std::size_t k = slot_of(id);
    return ids_[k] == id ? places_[k] : no_place;
  }
  /// Keeps its memory, unless it had much more than needed.
  void clear() {
    if (ids_.size() > 8 * least && 8 * count_ < ids_.size()) ids_ = {}, places_ = {};
    std::fill(ids_.begin(), ids_.end(), no_particle);
    count_ = 0;
  }
  std::size_t bytes() const {
    return ids_.capacity() * sizeof(ParticleId) + places_.capacity() * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::size_t least = 16;

  /// Slot of the id, or the free slot for it.
  std::size_t slot_of(ParticleId id) const {
    const std::size_t last = ids_.size() - 1;
    std::size_t k = (id * 0x9E3779B97F4A7C15u) >> (64 - std::bit_width(last));
    while (ids_[k] != id && ids_[k] != no_particle) k = (k + 1) & last;
    return k;
  }
  void grow() {
    DynArray<ParticleId> ids(std::max(least, 2 * ids_.size()), no_particle);
    DynArray<std::uint32_t> places(ids.size());
    ids.swap(ids_), places.swap(places_);
    for (std::size_t k = 0; k < ids.size(); ++k)
      if (ids[k] != no_particle) {
        const std::size_t to = slot_of(ids[k]);
        ids_[to] = ids[k], places_[to] = places[k];
      }
  }

  DynArray<ParticleId> ids_;  // size: a power of two; no_particle: free
  DynArray<std::uint32_t> places_;
  std::size_t count_ = 0;
};

}  // namespace silt::detail
