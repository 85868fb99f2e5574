// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/core/position_row.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/lists/wall_look.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Starts the contacts with walls that were excluded by bonds until now. Their present overlap is
/// excluded from the contact, stored in the history value `offset`.
template <class EngineType>
void begin_freed_at_walls(EngineType& e, std::size_t offset) {
  auto& walls = e.lists.walls;
  for (const auto& [id, wall] : e.particles.bonds.freed_at_walls)
    for (const auto& c : walls.candidates()) {
      if (c.particle != e.find(id) || c.wall != wall) continue;
      std::size_t slot = c.slot;
      for_each_contact_with(e, c, 0, [&](const auto&, const SurfacePoint& p) {
        const std::size_t end = c.slot + walls.slots_of(e.walls[c.wall].surfaces[c.surface]);
        while (slot < end && walls.slot(slot).touching) ++slot;  // images share them
        if (slot == end) return;
        walls.slot(slot) = {p.normal, true};
        walls.history(offset)[slot] = static_cast<typename EngineType::Scalar>(
            std::max(e.particles.position[c.particle].r - p.distance, 0.0));
      });
    }
  e.particles.bonds.freed_at_walls.clear();
}

/// Excludes the present overlap from the contacts of rows with ids from `first` on, which were just
/// added. The lists have just been renewed.
template <class EngineType>
void leave_out_overlaps(EngineType& e, ParticleId first) {
  constexpr std::size_t offset = EngineType::Contacts::offset_from;
  const auto whole = static_cast<typename EngineType::Scalar>(whole_overlap);
  const auto is_new = [&](std::uint32_t row) { return e.particles.id[row] >= first; };
  auto& pairs = e.lists.pairs;
  auto* const of_pairs = pairs.history(offset);
  pairs.for_each([&, a = pairs.first(), b = pairs.second()](std::size_t k) {
    if (is_new(a[k]) || is_new(b[k])) of_pairs[k] = whole;
  });
  auto& walls = e.lists.walls;
  for (const auto& c : walls.candidates())
    if (is_new(c.particle))
      std::fill_n(walls.history(offset) + c.slot,
                  walls.slots_of(e.walls[c.wall].surfaces[c.surface]), whole);
}

}  // namespace silt::detail
