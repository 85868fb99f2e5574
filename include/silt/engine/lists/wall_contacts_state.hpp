// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of WallContacts: its checkpoint state, and lists restored from it.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/wall_contacts.hpp>

namespace silt::inline SILT_TARGET::detail {

template <std::size_t H, class Scalar, std::size_t PlaneSlots, std::size_t OtherSlots, bool Repeats>
void WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::remember(DynArray<Kept> contacts,
                                                                        std::span<const Wall> walls,
                                                                        std::size_t particles) {
  particles_ = static_cast<std::uint32_t>(particles);
  std::stable_sort(contacts.begin(), contacts.end(), by_key);
  outer_.clear(), outer_facets_.clear(), inner_facets_.clear();
  for (const Kept& c : contacts) {
    const auto k = static_cast<std::uint32_t>(outer_.size());
    const Candidate next{WallCandidate{c.particle, c.wall, c.surface, 0, 0, 0, k}};
    if (k == 0 || !same_surface(outer_.back(), next)) outer_.push_back(next);
  }
  inner_ = outer_;
  archive_ = std::move(contacts), previous_.clear(), renewed_ = true;
  part_planes(walls), lay_out_slots(walls), lay_out_planes(walls);
  recall();
  renewed_ = false;
}

template <std::size_t H, class Scalar, std::size_t PlaneSlots, std::size_t OtherSlots, bool Repeats>
typename WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::State
WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::state() const {
  State s{outer_, inner_, outer_facets_, inner_facets_, slots_, {}, {}};
  s.pieces.assign(piece_begin_.begin(), piece_begin_.end());
  for (std::size_t h = 0; h < H; ++h) s.history[h].assign(history_[h].begin(), history_[h].end());
  return s;
}

template <std::size_t H, class Scalar, std::size_t PlaneSlots, std::size_t OtherSlots, bool Repeats>
void WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::restore(State s,
                                                                       std::span<const Wall> walls,
                                                                       std::size_t particles) {
  particles_ = static_cast<std::uint32_t>(particles);
  outer_ = std::move(s.outer), inner_ = std::move(s.inner);
  outer_facets_ = std::move(s.outer_facets), inner_facets_ = std::move(s.inner_facets);
  // Blocks by the previous slots: a wall may have lost its surfaces since.
  piece_begin_.assign(s.pieces.begin(), s.pieces.end());
  block_begin_.clear();
  for (std::size_t k = 0; k < planes_from(); ++k)
    if (inner_[k].slot / block >= block_begin_.size()) block_begin_.push_back(k);
  if (planes_from() > 0) block_begin_.push_back(planes_from());
  slots_ = std::move(s.slots);
  for (std::size_t h = 0; h < H; ++h) {
    history_[h].resize(s.history[h].size());
    for (std::size_t k = 0; k < s.history[h].size(); ++k)
      history_[h][k] = static_cast<Scalar>(s.history[h][k]);
  }
  lay_out_planes(walls);
  renewed_ = false;
}

template <std::size_t H, class Scalar, std::size_t PlaneSlots, std::size_t OtherSlots, bool Repeats>
bool WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::is_laid_out(
    const State& s, std::span<const Wall> walls) const {
  WallContacts fresh;
  fresh.planes_apart = planes_apart, fresh.inner_ = s.inner;
  std::sort(fresh.inner_.begin(), fresh.inner_.end(),
            [](const Candidate& a, const Candidate& b) { return a.origin < b.origin; });
  fresh.part_planes(walls), fresh.lay_out_slots(walls);
  const auto same = [](const Candidate& a, const Candidate& b) {
    return a.key() == b.key() && a.slot == b.slot && a.origin == b.origin;
  };
  return std::equal(s.inner.begin(), s.inner.end(), fresh.inner_.begin(), same) &&
         std::equal(s.pieces.begin(), s.pieces.end(), fresh.piece_begin_.begin(),
                    fresh.piece_begin_.end()) &&
         s.slots.size() == fresh.slots_.size();
}

template <std::size_t H, class Scalar, std::size_t PlaneSlots, std::size_t OtherSlots, bool Repeats>
bool WallContacts<H, Scalar, PlaneSlots, OtherSlots, Repeats>::has_slots(const State& s) {
  if (s.pieces.empty() || s.pieces.back() != s.inner.size() ||
      !std::is_sorted(s.pieces.begin(), s.pieces.end()) || s.slots.size() % padding != 0)
    return false;
  const std::size_t first_plane = s.pieces.front();
  for (std::size_t k = 0; k < s.inner.size(); ++k) {
    const std::size_t slot = s.inner[k].slot, last = k == 0 ? 0 : s.inner[k - 1].slot;
    const bool next_block = k > 0 && slot / block != last / block;
    if (k > 0 && slot <= last) return false;
    if (k < first_plane && (slot / block > (k > 0 ? last / block + next_block : 0) ||
                            pieces(slot + 1, block) * block > s.slots.size()))
      return false;
    if (slot >= s.slots.size()) return false;
  }
  return true;
}

}  // namespace silt::detail
