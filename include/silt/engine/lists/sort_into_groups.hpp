// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/pair_groups.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pairs sorted into groups.
struct GroupedPairs {
  std::vector<IndexPair>& pairs;
  DynArray<std::size_t>& begin;    // first pair of each group, and the end
  DynArray<std::uint16_t>& group;  // of each pair in the order of the search
};

/// Sorts pairs by group (stable), the particle with the lower id first. Pairs of two fixed
/// particles, of one body, or joined by a bond, are left out.
template <class State>
void sort_into_groups(std::span<const IndexPair> found, const State& particles,
                      const PairGroups& groups, const GroupedPairs& out, const Team& team) {
  const auto group_of = [&](const IndexPair& p) {
    if constexpr (State::of_bodies)
      if (particles.part[p.a].body == particles.part[p.b].body) return groups.count();
    if constexpr (State::of_ranks)
      if (std::min(p.a, p.b) >= particles.owned()) return groups.count();
    if constexpr (State::bonded)
      if (particles.bonds.holds(particles.id[p.a], particles.id[p.b])) return groups.count();
    if (particles.some_fixed && particles.motion[p.a].inv_m == 0 &&
        particles.motion[p.b].inv_m == 0)
      return groups.count();
    return groups.of(p.a, p.b);
  };
  const std::size_t count = groups.count() + 1;  // one more for the pairs left out
  make_room(out.group, found.size());
  DynArray<std::size_t> next(Team::most_ranges * count, 0);  // per range and group
  team.for_ranges(found.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      ++next[r * count + (out.group[k] = static_cast<std::uint16_t>(group_of(found[k])))];
  });
  out.begin.resize(count);
  std::size_t place = 0;
  for (std::size_t g = 0; g < count; ++g) {
    out.begin[g] = place;
    for (std::size_t r = 0; r < Team::most_ranges; ++r)
      place += std::exchange(next[r * count + g], place);
  }
  make_room(out.pairs, out.begin.back());
  team.for_ranges(found.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      if (out.group[k] == groups.count()) continue;
      const auto [a, b] = found[k];
      out.pairs[next[r * count + out.group[k]]++] =
          particles.id[a] < particles.id[b] ? IndexPair{a, b} : IndexPair{b, a};
    }
  });
}

}  // namespace silt::detail
