// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The pairs of particles that are bonded, by id; bonded pairs are not contacts. A hash table with
/// open addressing, at most two thirds full, with 16 bytes per entry. Particles bonded to a wall,
/// whose contact with it is excluded, are stored with an id for the wall, counted down from the
/// largest one.
class BondedPairs {
 public:
  bool holds(ParticleId a, ParticleId b) const {
    return used_ > 0 && places_[place_of(sorted(a, b))] == sorted(a, b);
  }
  void add(ParticleId a, ParticleId b) {
    if (3 * (used_ + 1) > 2 * places_.size()) make_room();
    Pair& place = places_[place_of(sorted(a, b))];
    if (place == nobody) place = sorted(a, b), ++used_;
  }
  void remove(ParticleId a, ParticleId b) {
    if (!holds(a, b)) return;
    // Entries behind the gap that would no longer be found are moved up.
    std::size_t gap = place_of(sorted(a, b));
    for (std::size_t k = next(gap); places_[k] != nobody; k = next(k)) {
      const std::size_t home = home_of(places_[k]);
      if (gap <= k ? home <= gap || home > k : home <= gap && home > k)
        places_[gap] = places_[k], gap = k;
    }
    places_[gap] = nobody, --used_;
  }
  static ParticleId id_of_wall(std::size_t wall) { return no_particle - wall; }
  /// Particles and walls whose contacts begin now: their overlap at the next pruning is excluded.
  DynArray<std::pair<ParticleId, std::uint64_t>> freed_at_walls;

  std::size_t bytes() const { return places_.capacity() * sizeof(Pair); }

 private:
  using Pair = std::pair<ParticleId, ParticleId>;
  static constexpr Pair nobody{no_particle, no_particle};

  static Pair sorted(ParticleId a, ParticleId b) { return a < b ? Pair{a, b} : Pair{b, a}; }
  std::size_t next(std::size_t k) const { return (k + 1) & (places_.size() - 1); }
  std::size_t home_of(const Pair& p) const {
    std::uint64_t z = p.first * 0x9e3779b97f4a7c15u + p.second;
    z = (z ^ (z >> 32)) * 0xd6e8feb86659fd93u;
    return (z ^ (z >> 32)) & (places_.size() - 1);
  }
  /// The place of an entry, or where it would be inserted.
  std::size_t place_of(const Pair& p) const {
    std::size_t k = home_of(p);
    while (places_[k] != p && places_[k] != nobody) k = next(k);
    return k;
  }
  void make_room() {
    DynArray<Pair> old(std::max<std::size_t>(64, 2 * places_.size()), nobody);
    old.swap(places_);
    for (const Pair& p : old)
      if (p != nobody) places_[place_of(p)] = p;
  }

  DynArray<Pair> places_;
  std::size_t used_ = 0;
};
struct NoPairs {};

}  // namespace silt::detail
