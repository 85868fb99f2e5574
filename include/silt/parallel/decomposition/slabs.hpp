// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/parallel/decomposition/find_cuts.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Slabs between cuts normal to an axis: rank r owns what lies behind cut r - 1, up to cut r.
struct Slabs {
  int axis = 2;
  std::vector<PlaceKey> cuts;

  int rank_of(const Vec3d& place) const {
    const auto key = PlaceKey::of(place, axis);
    return static_cast<int>(std::lower_bound(cuts.begin(), cuts.end(), key) - cuts.begin());
  }

  std::vector<int> owners(std::span<const Vec3d> points, int own) const {
    std::vector<int> owner;
    owner.reserve(points.size());
    for (const auto& p : points) owner.push_back(is_finite(p) ? rank_of(p) : own);
    return owner;
  }

  /// Positions of the cuts along the axis [m]; infinite where a slab at the end is empty.
  std::vector<double> planes() const {
    std::vector<double> x;
    for (const auto& cut : cuts)
      x.push_back(
          value_of_key(std::clamp(cut.along[0], ordered_key(-infinity), ordered_key(infinity))));
    return x;
  }

  static constexpr double infinity = std::numeric_limits<double>::infinity();
};

inline void check_axis(const char* policy, int axis) {
  require(axis >= 0 && axis <= 2, policy, ".axis = ", axis, " must be 0, 1 or 2: x, y or z");
}

}  // namespace detail

/// Slabs of equal thickness normal to an axis, which never move. Without a box they divide that of
/// the points of the first partition.
///
/// Errors: InputError for an axis other than 0, 1, 2 or a box that is not finite.
/// Tests:  tests/parallel/decompositions.cpp.
/// Source: none.
/// Valid:  material that stays in place along the axis.
/// Units:  [m].
struct StaticSlabs {
  int axis = 2;  // 0, 1 or 2: normal to x, y or z
  Box box = {};  // [m]
  detail::Slabs slabs = {};

  static constexpr bool by_place = true;

  template <Communicator C>
  std::vector<int> partition(const C& comm, std::span<const Vec3d> points,
                             std::span<const double> weights) {
    detail::check_axis("StaticSlabs", axis);
    const detail::WholeWeights whole(comm, points, weights);
    if (box.min.x > box.max.x && whole.points > 0) box = whole.box;
    const auto low = along(box.min), high = along(box.max);
    if (slabs.cuts.size() + 1 != static_cast<std::size_t>(comm.size()) && low <= high) {
      require(std::isfinite(low) && std::isfinite(high), "StaticSlabs.box from ", box.min, " to ",
              box.max, " [m] must be finite along the axis");
      slabs = {axis, {}};
      for (int r = 1; r < comm.size(); ++r) {
        const double x = low + (high - low) * r / comm.size();
        slabs.cuts.push_back(detail::PlaceKey::end_of({detail::ordered_key(x), 0, 0}, 1));
      }
    }
    return slabs.owners(points, comm.rank());
  }

  int rank_of(const Vec3d& place) const { return slabs.rank_of(place); }
  std::vector<double> planes() const { return slabs.planes(); }
  template <class Visit>
  void for_each_state(Visit& visit) {
    visit(box), visit(slabs.axis), visit(slabs.cuts);
  }

 private:
  double along(const Vec3d& p) const { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
};
static_assert(Decomposition<StaticSlabs, NoRanks>);

/// Slabs between planes that move until all ranks have the same work.
///
/// Source: Markauskas, Kaceniauskas, Maknickas, Information Technology and Control 40 (2011),
///         DOI 10.5755/j01.itc.40.4.978, section 3: parallel planes; a new decomposition when the
///         load of any subdomain has changed by a percentage that the user sets. Deviations: work
///         is counted (weights), not timed; the dividing planes are found exactly, not step by
///         step; points in the plane of a cut may be on either side. The change is that of a slab's
///         share, in percent of the mean share.
/// Errors: InputError for an axis other than 0, 1, 2 or a percentage that is negative.
/// Tests:  tests/parallel/decompositions.cpp (work within one point's weight of the mean).
/// Valid:  material whose extent along the axis is much larger than the ranks' ghost layers.
/// Units:  [m]; work in units of the weights.
struct MovingSlabs {
  int axis = 2;        // 0, 1 or 2: normal to x, y or z
  double percent = 5;  // [%] change of a slab's work that moves the planes
  detail::Slabs slabs = {};
  std::vector<double> shares = {};  // [-] of each slab's work when the planes were last moved

  static constexpr bool by_place = true;

  template <Communicator C>
  std::vector<int> partition(const C& comm, std::span<const Vec3d> points,
                             std::span<const double> weights) {
    detail::check_axis("MovingSlabs", axis);
    require_not_negative("MovingSlabs.percent", percent, "%");
    const detail::WholeWeights whole(comm, points, weights);
    const int ranks = comm.size();
    const bool there = slabs.cuts.size() + 1 == static_cast<std::size_t>(ranks) &&
                       slabs.axis == axis && shares.size() == static_cast<std::size_t>(ranks);
    if (there && change(now(comm, points, whole)) <= percent)
      return slabs.owners(points, comm.rank());
    slabs = {axis,
             std::vector(static_cast<std::size_t>(ranks) - 1, detail::PlaceKey::before_all())};
    if (whole.points > 0) {
      std::vector<std::size_t> members;
      for (std::size_t k = 0; k < points.size(); ++k)
        if (is_finite(points[k])) members.push_back(k);
      const detail::SortedGroup group(points, whole.weights, members, axis);
      std::vector<detail::Cut> cuts;
      for (int r = 1; r < ranks; ++r)
        cuts.push_back({0, detail::share_of(whole.total, r, ranks), axis, whole.box});
      detail::find_cuts(comm, {&group, 1}, cuts);
      for (std::size_t r = 0; r < cuts.size(); ++r) slabs.cuts[r] = cuts[r].cut;
    }
    shares = now(comm, points, whole);
    return slabs.owners(points, comm.rank());
  }

  int rank_of(const Vec3d& place) const { return slabs.rank_of(place); }
  std::vector<double> planes() const { return slabs.planes(); }
  template <class Visit>
  void for_each_state(Visit& visit) {
    visit(slabs.axis), visit(slabs.cuts), visit(shares);
  }

 private:
  /// Collective: each slab's share of the work.
  template <Communicator C>
  std::vector<double> now(const C& comm, std::span<const Vec3d> points,
                          const detail::WholeWeights& whole) const {
    std::vector<std::int64_t> work(static_cast<std::size_t>(comm.size()), 0);
    for (std::size_t k = 0; k < points.size(); ++k)
      if (is_finite(points[k]))
        work[static_cast<std::size_t>(slabs.rank_of(points[k]))] += whole.weights[k];
    comm.sum_of(work);
    std::vector<double> parts;
    for (const auto w : work)
      parts.push_back(whole.total > 0 ? static_cast<double>(w) / static_cast<double>(whole.total)
                                      : 0);
    return parts;
  }
  /// [%] of the mean share, the largest of all slabs.
  double change(const std::vector<double>& parts) const {
    double most = 0;
    for (std::size_t r = 0; r < parts.size(); ++r)
      most = std::max(most, std::abs(parts[r] - shares[r]));
    return 100 * most * static_cast<double>(parts.size());
  }
};
static_assert(Decomposition<MovingSlabs, NoRanks>);

}  // namespace silt
