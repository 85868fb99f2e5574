// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of PairList: adding and removing pairs between two searches.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/pair_list.hpp>

namespace silt::inline SILT_TARGET::detail {

template <std::size_t H, class Scalar, HistoryRows InRows>
void PairList<H, Scalar, InRows>::make_way(std::size_t first, std::size_t more,
                                           std::size_t particles) {
  DynArray<Brought> known;
  const auto moved = [&](std::uint32_t row) {
    return row >= first ? row + static_cast<std::uint32_t>(more) : row;
  };
  for_each([&](std::size_t k) {
    known.push_back({moved(first_[k]), moved(second_[k]), memory(k)});
  });
  restore(state_of(known, particles), particles);
}

template <std::size_t H, class Scalar, HistoryRows InRows>
inline void PairList<H, Scalar, InRows>::join(std::span<const NewPair> more, std::size_t particles,
                                              const std::array<Scalar, H>& start) {
  DynArray<std::size_t> outer_more(groups_.count(), 0), inner_more(groups_.count(), 0);
  for (const NewPair& p : more) {
    const std::size_t g = groups_.of(p.pair.a, p.pair.b);
    ++outer_more[g], inner_more[g] += p.near;
  }
  DynArray<std::size_t> outer_end = make_way_outer(outer_more);
  DynArray<std::size_t> inner_end = make_way_inner(inner_more, outer_more);
  for (const NewPair& p : more) {
    const std::size_t g = groups_.of(p.pair.a, p.pair.b), place = outer_end[g]++;
    outer_[place] = p.pair;
    if (!p.near) continue;
    const std::size_t k = inner_end[g]++;
    first_[k] = p.pair.a, second_[k] = p.pair.b;
    origin_[k] = static_cast<std::uint32_t>(place);
    history_.set(k, start);
  }
  cut_into_chunks();
  pad(particles);
}

template <std::size_t H, class Scalar, HistoryRows InRows>
inline void PairList<H, Scalar, InRows>::leave(std::span<const std::uint32_t> rows,
                                               std::size_t particles) {
  const auto [least, most] = std::minmax_element(rows.begin(), rows.end());
  const auto is_gone = [&, least = *least, most = *most](std::uint32_t row) {
    return row >= least && row <= most && std::find(rows.begin(), rows.end(), row) != rows.end();
  };
  for (Group& g : inner_group_) {
    std::size_t to = g.from;
    for (std::size_t k = g.from; k < g.to; ++k) {
      if (is_gone(first_[k]) || is_gone(second_[k])) continue;
      if (to != k) move(k, to);
      ++to;
    }
    size_ -= g.to - to;
    g.to = to;
  }
  pad(particles);
}

template <std::size_t H, class Scalar, HistoryRows InRows>
DynArray<std::size_t> PairList<H, Scalar, InRows>::make_way_outer(
    std::span<const std::size_t> more) {
  DynArray<std::size_t> end(groups_.count());
  std::size_t shift = std::accumulate(more.begin(), more.end(), std::size_t(0));
  outer_.resize(outer_.size() + shift);
  outer_begin_.resize(groups_.count() + 1, 0);
  for (std::size_t g = groups_.count(); g-- > 0;) {
    const std::size_t from = outer_begin_[g], to = outer_begin_[g + 1];
    outer_begin_[g + 1] += shift;
    shift -= more[g];
    if (shift > 0)
      std::move_backward(outer_.begin() + static_cast<std::ptrdiff_t>(from),
                         outer_.begin() + static_cast<std::ptrdiff_t>(to),
                         outer_.begin() + static_cast<std::ptrdiff_t>(to + shift));
    end[g] = to + shift;
  }
  return end;
}

template <std::size_t H, class Scalar, HistoryRows InRows>
DynArray<std::size_t> PairList<H, Scalar, InRows>::make_way_inner(
    std::span<const std::size_t> more, std::span<const std::size_t> outer_more) {
  DynArray<Group> now(groups_.count());
  inner_group_.resize(groups_.count());
  std::size_t next = 0, outer_shift = 0;
  for (std::size_t g = 0; g < groups_.count(); ++g) {
    const std::size_t size = inner_group_[g].size();
    now[g].from = std::max(pieces(next, padding) * padding, inner_group_[g].from);
    now[g].to = now[g].from + size;
    next = now[g].to + more[g];
    if (outer_shift > 0)
      for (std::size_t k = inner_group_[g].from; k < inner_group_[g].to; ++k)
        origin_[k] += static_cast<std::uint32_t>(outer_shift);
    outer_shift += outer_more[g], size_ += more[g];
  }
  const std::size_t padded = std::max(pieces(next, padding) * padding, origin_.size());
  first_.resize(padded + ahead), second_.resize(padded + ahead);
  origin_.resize(padded), history_.extend(padded);
  DynArray<std::size_t> end(groups_.count());
  for (std::size_t g = groups_.count(); g-- > 0;) {
    const auto [from, to] = inner_group_[g];
    const std::size_t shift = now[g].from - from;
    for (std::size_t k = shift > 0 ? to : from; k-- > from;) move(k, k + shift);
    end[g] = now[g].to;
    inner_group_[g] = {now[g].from, now[g].to + more[g]};
  }
  return end;
}

}  // namespace silt::detail
