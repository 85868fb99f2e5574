// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <numeric>
#include <vector>

#include <silt/parallel/decomposition/concept.hpp>
#include <silt/parallel/ordered_key.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A position in the order along an axis. Points with the same coordinate along it are ordered by
/// the other two, so that layers of a lattice can be divided, too.
struct PlaceKey {
  std::array<std::int64_t, 3> along;

  static PlaceKey of(const Vec3d& p, int axis) {
    const std::array<double, 3> x{p.x, p.y, p.z};
    const auto at = [&](int d) { return ordered_key(x[static_cast<std::size_t>((axis + d) % 3)]); };
    return {{at(0), at(1), at(2)}};
  }
  /// Behind all points whose first coordinates are these.
  static PlaceKey end_of(std::array<std::int64_t, 3> first, std::size_t given) {
    for (std::size_t d = given; d < 3; ++d) first[d] = highest;
    return {first};
  }
  static PlaceKey before_all() { return {{lowest, lowest, lowest}}; }
  static PlaceKey behind_all() { return {{highest, highest, highest}}; }

  friend auto operator<=>(const PlaceKey&, const PlaceKey&) = default;

 private:
  static constexpr auto lowest = std::numeric_limits<std::int64_t>::min();
  static constexpr auto highest = std::numeric_limits<std::int64_t>::max();
};

/// Own points of one group in order, with cumulative sums of their weights.
struct SortedGroup {
  std::vector<PlaceKey> keys;
  std::vector<std::int64_t> before;  // one entry more than keys

  SortedGroup(std::span<const Vec3d> points, std::span<const std::int64_t> weights,
              std::span<const std::size_t> members, int axis) {
    std::vector<std::pair<PlaceKey, std::int64_t>> all;
    all.reserve(members.size());
    for (const auto k : members) all.emplace_back(PlaceKey::of(points[k], axis), weights[k]);
    std::sort(all.begin(), all.end());
    before.push_back(0);
    for (const auto& [key, weight] : all)
      keys.push_back(key), before.push_back(before.back() + weight);
  }

  /// Number of points at `key` or before.
  std::size_t up_to(const PlaceKey& key) const {
    return static_cast<std::size_t>(std::upper_bound(keys.begin(), keys.end(), key) - keys.begin());
  }
};

/// A cut of group `group`, whose points on all ranks lie in `box`, along `axis`, such that the
/// weight before the cut is as close as possible to `target`. find_cuts() sets the other members:
/// points at `cut` or before it lie on the left.
struct Cut {
  std::size_t group;
  std::int64_t target;
  int axis;
  Box box;
  PlaceKey cut = PlaceKey::before_all();
  std::int64_t left = 0;  // weight on the left, over all ranks
};

/// The state of the search for one cut: it lies behind points of weight `left`, among the points
/// whose first `depth` coordinates are `at` and whose next one is in [low, high].
struct CutSearch {
  std::array<std::int64_t, 3> at{};
  std::size_t depth = 0;
  std::int64_t low = 0, high = 0;
  bool found = false;

  /// Behind all points whose next coordinate is at most `key`.
  PlaceKey end(std::int64_t key) const {
    auto first = at;
    first[depth] = key;
    return PlaceKey::end_of(first, depth + 1);
  }
};

/// Collective: finds all cuts at once from histograms of weights between two keys, refined until a
/// bin holds one point or its end is the cut; a few messages each. Keys are integers: the search
/// ends after at most three times 64 bits, for any points, and is exact.
template <Communicator C>
void find_cuts(const C& comm, std::span<const SortedGroup> groups, std::span<Cut> cuts) {
  const std::size_t bins =
      std::clamp<std::size_t>(4096 / std::max<std::size_t>(1, cuts.size()), 16, 256);
  std::vector<CutSearch> searches;
  // From the first to the last key that exists for the next coordinate.
  const auto begin = [](const Cut& cut, CutSearch& s) {
    s.low = PlaceKey::of(cut.box.min, cut.axis).along[s.depth];
    s.high = PlaceKey::of(cut.box.max, cut.axis).along[s.depth];
  };
  for (const auto& cut : cuts) {
    begin(cut, searches.emplace_back());
    searches.back().found = searches.back().low > searches.back().high;  // there are no points
  }
  std::vector<std::int64_t> told;
  // Keys in counting form: the distance of two fits into an unsigned number.
  const auto key_at = [](std::int64_t low, std::uint64_t further) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + further);
  };
  while (!std::all_of(searches.begin(), searches.end(), [](const auto& s) { return s.found; })) {
    told.clear();
    const auto bins_of = [&](const CutSearch& s) {
      const auto span = static_cast<std::uint64_t>(s.high) - static_cast<std::uint64_t>(s.low);
      const std::uint64_t width = span / bins + 1;
      return std::pair(width, span / width + 1);
    };
    for (std::size_t c = 0; c < cuts.size(); ++c) {
      const auto& s = searches[c];
      if (s.found) continue;
      const auto& group = groups[cuts[c].group];
      const auto [width, number] = bins_of(s);
      std::size_t from = group.up_to(s.end(s.low - 1));
      for (std::uint64_t b = 0; b < number; ++b) {
        const auto end = b + 1 == number ? s.high : key_at(s.low, (b + 1) * width - 1);
        const std::size_t to = group.up_to(s.end(end));
        told.push_back(group.before[to] - group.before[from]);
        told.push_back(static_cast<std::int64_t>(to - from));
        from = to;
      }
    }
    comm.sum_of(told);
    std::size_t next = 0;
    for (std::size_t c = 0; c < cuts.size(); ++c) {
      auto& s = searches[c];
      auto& cut = cuts[c];
      if (s.found) continue;
      const auto [width, number] = bins_of(s);
      // The bin in which the target is reached.
      std::uint64_t b = 0;
      while (b + 1 < number && cut.left + told[next + 2 * b] < cut.target)
        cut.left += told[next + 2 * b++];
      const auto weight = told[next + 2 * b], count = told[next + 2 * b + 1];
      next += 2 * number;
      const auto low = key_at(s.low, b * width);
      const auto high = b + 1 == number ? s.high : key_at(low, width - 1);
      const auto all = cut.left + weight;
      const bool one_place = low == high && s.depth == 2;
      if (count <= 1 || all == cut.target || one_place) {
        // Indivisible: the bin goes to the side where the weight is closer to the target.
        const bool with = all - cut.target < cut.target - cut.left;
        cut.cut = s.end(with ? high : low - 1);
        if (with) cut.left = all;
        s.found = true;
      } else if (low == high) {
        s.at[s.depth++] = low;  // all of them lie in one plane, or on one line
        begin(cut, s);
      } else {
        s.low = low, s.high = high;
      }
    }
  }
}

}  // namespace silt::inline SILT_TARGET::detail
