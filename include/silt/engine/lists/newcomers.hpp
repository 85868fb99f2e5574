// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/list_upkeep.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A pair with at least one particle that was added since the search.
struct NewPair {
  IndexPair pair;
  bool near;  // belongs to the inner list too
};

/// The pairs of the rows from `first` on, which were added since the search, among themselves and
/// with all others.
///
/// Let t be now and D_i the displacement of particle i since the search (other symbols:
/// ListUpkeep). For a newcomer b, D_b is counted from now on. A pair (i, b) is listed unless its
/// gap is at least s_i + s_b + D_i(t). From t to a later t', particle i moves by no more than
/// D_i(t) + D_i(t'), so a pair that is not listed then has a gap of at least s_i - D_i(t') + s_b -
/// D_b(t'): (1) holds for it at every pruning. The pair is in the inner list unless its gap is at
/// least q_i + q_b. The share of the reaches used before t stays charged to all, so that (2) holds.
///
/// One pass over the positions, sorted by x; pairs that are close in x are tested exactly.
template <class State, class Domain>
class Newcomers {
 public:
  struct Input {
    const State& particles;
    const ListUpkeep& upkeep;
    const Vec3d* reference;  // [m] positions at the search; for newcomers the present ones
    const Domain& domain;
    double range;  // [m]
  };

  Newcomers(const Input& in, std::size_t first) : in_(in), first_(first) {
    const std::size_t n = in.particles.size();
    double widest = 0;
    for (std::size_t k = first; k < n; ++k) {
      by_x_.push_back({wrapped_x(k), static_cast<std::uint32_t>(k)});
      widest = std::max(widest, reach(k));
    }
    std::sort(by_x_.begin(), by_x_.end());
    const double most = *std::max_element(in.upkeep.outer.begin(), in.upkeep.outer.end());
    window_ = widest + in.particles.largest_radius + 2 * most + in.range / 2;
  }

  /// In the order of the lower row, for any number of threads.
  DynArray<NewPair> pairs(const Team& team) const {
    std::array<DynArray<NewPair>, Team::most_ranges> found;
    team.for_ranges(in_.particles.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
        if (in_.particles.position[i].r > 0)
          for_near_in_x(i,
                        [&](std::uint32_t k) { look(static_cast<std::uint32_t>(i), k, found[r]); });
    });
    DynArray<NewPair> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  double wrapped_x(std::size_t k) const {
    const Vec3d p = in_.particles.position[k].centre();
    if constexpr (Domain::periodic)
      return in_.domain.wrapped(p).x;
    else
      return p.x;
  }
  /// [m] radius plus the reach of a particle relative to a newcomer.
  double reach(std::size_t k) const {
    const auto& row = in_.particles.position[k];
    return row.r + in_.upkeep.outer[k] + norm(row.centre() - in_.reference[k]) + in_.range / 2;
  }
  double inner_reach(std::size_t k) const {
    return in_.particles.position[k].r + in_.upkeep.inner[k] + in_.range / 2;
  }

  template <class Visit>
  void for_near_in_x(std::size_t i, const Visit& visit) const {
    const double x = wrapped_x(i);
    const auto within = [&](double from, double to) {
      for (auto b = std::lower_bound(by_x_.begin(), by_x_.end(), std::pair{from, 0u});
           b != by_x_.end() && b->first <= to; ++b)
        visit(b->second);
    };
    within(x - window_, x + window_);
    if constexpr (Domain::periodic) {
      if (!in_.domain.repeats(0)) return;
      const double length = in_.domain.length(0);  // each pair in one window only
      within(std::max(x - window_ + length, std::nextafter(x + window_, 2 * length)),
             x + window_ + length);
      within(x - window_ - length,
             std::min(x + window_ - length, std::nextafter(x - window_, -2 * length)));
    }
  }

  void look(std::uint32_t i, std::uint32_t k, DynArray<NewPair>& found) const {
    if (k <= i && i >= first_) return;  // each pair once; no particle with itself
    const State& p = in_.particles;
    if constexpr (State::of_bodies)
      if (p.part[i].body == p.part[k].body) return;
    if constexpr (State::bonded)
      if (p.bonds.holds(p.id[i], p.id[k])) return;
    if (p.some_fixed && p.motion[i].inv_m == 0 && p.motion[k].inv_m == 0) return;
    Vec3d d = p.position[i].centre() - p.position[k].centre();
    if constexpr (Domain::periodic) d = in_.domain.shortest(d);
    const double distance2 = dot(d, d), far = reach(i) + reach(k);
    if (!(distance2 < far * far)) return;
    const double near = inner_reach(i) + inner_reach(k);
    const IndexPair pair = p.id[i] < p.id[k] ? IndexPair{i, k} : IndexPair{k, i};
    found.push_back({pair, distance2 < near * near});
  }

  Input in_;
  std::size_t first_;
  DynArray<std::pair<double, std::uint32_t>> by_x_;  // [m], row
  double window_ = 0;                                // [m]
};

}  // namespace silt::detail
