// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/box_images.hpp>
#include <silt/engine/lists/flow_since.hpp>
#include <silt/engine/lists/list_upkeep.hpp>
#include <silt/engine/lists/newcomers.hpp>
#include <silt/engine/lists/occupied_region.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/engine/ranks/no_ranks.hpp>
#include <silt/engine/state/composition.hpp>
#include <silt/engine/state/particle_state.hpp>
#include <silt/search/verlet_list.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The lists of spheres and walls that may touch soon, and their renewal: the reach of each sphere
/// (ListUpkeep), the search, the order of particles in memory, and pruning. Loops over particles
/// and pairs are shared between threads; results do not depend on the number of threads.
template <class Composition, class Pairs, class Walls, class Mover>
class NearLists {
  using State = ParticleState<Composition>;
  using Search = typename Composition::Search;
  using Domain = typename Composition::Domain;

 public:
  /// The input of the lists.
  struct Scene {
    State& particles;
    std::span<const Wall> walls;
    const Domain& domain;
    const Team& team;
    double time_step;  // [s]
    double range;      // [m] gap up to which the law acts; 0 for laws that act in contact only
    RankStage<typename State::Ranks>& ranks;
    Mover& mover;
  };

  Pairs pairs;
  Walls walls;
  ListUpkeep upkeep;
  AlignedVector<Vec3d> reference;          // [m] positions at the last search
  WallMarks searched_walls, pruned_walls;  // poses at the last search and pruning
  static constexpr bool flows = deforms<Domain>;
  [[no_unique_address]] std::conditional_t<flows, FlowSince, NoFlow> flow;

  bool hold(std::span<const Wall> now) const {
    if constexpr (flows)
      if (!(upkeep.used + flow.used() < 1)) return false;
    return keeps_list && upkeep.pruned_at >= 0 && upkeep.inner_holds(pruned_walls.travel(now));
  }
  /// [kg m] For a ledger: mass times displacement of the spheres that were wrapped into a periodic
  /// box (of bodies: BodyMotion::wrapped).
  Vec3d wrapped{0, 0, 0};

  /// Forces a search in the next step.
  void forget() { upkeep.searched_at = upkeep.pruned_at = -1; }
  /// True once after every pruning: data derived from the lists must then be updated.
  bool take_renewed() { return std::exchange(renewed_, false); }

  /// Prunes or searches if the lists are no longer valid.
  void renew(const Scene& scene, Search& search, std::int64_t step) {
    walls.range = scene.range, walls.planes_apart = !State::of_bodies;
    set_period(scene.domain);
    if (hold(scene.walls)) return;
    const double wall_speed = fastest_wall(scene);
    anticipate_speeds(scene);
    if (upkeep.searched_at < 0 || !choose_inner(scene, wall_speed)) {
      find_pairs(scene, search, wall_speed, step);
      upkeep.searched_at = step;
      anticipate_speeds(scene);  // using the new neighbours
      choose_inner(scene, wall_speed);
    }
    if constexpr (State::of_ranks) scene.ranks.share(upkeep.inner);
    prune(scene);
    upkeep.pruned_at = step;
  }

  /// Adds the new rows, from `first` on. A few are added to the present lists; if many have come
  /// since the search, or one has a larger reach than all before, the next step searches.
  void join(const Scene& scene, std::size_t first) {
    if constexpr (flows || State::of_ranks) return forget();
    const std::size_t n = scene.particles.size();
    if (!hold_pairs() || scene.range > walls.range || n > most_with_newcomers(pairs.grouped()))
      return forget();
    upkeep.outer.resize(n), upkeep.inner.resize(n), upkeep.per_inner2.resize(n);
    reference.resize(n), speeds_.resize(n);
    Box region;
    for (std::size_t k = first; k < n; ++k) {
      speeds_[k] = norm(scene.particles.motion[k].velocity());
      upkeep.outer[k] = upkeep.outer_reach(speeds_[k]);
      reference[k] = scene.particles.position[k].centre();
      const double most = scene.particles.position[k].r + upkeep.outer[k] + upkeep.outer_wall;
      region.include(Box{reference[k], reference[k]}.grown(most + scene.range));
    }
    upkeep.set_inner(first, n, speeds_, [](std::size_t) { return 0.0; });
    searched_walls.include(region), pruned_walls.include(region);
    const Newcomers<State, Domain> newcomers(
        {scene.particles, upkeep, reference.data(), scene.domain, scene.range}, first);
    pairs.join(newcomers.pairs(scene.team), n);
    join_walls(scene, first);
    renewed_ = true;
  }

  /// Adds pairs that were excluded because of bonds which have just broken. Their histories are
  /// kept even if the next step searches.
  void join_pairs(const Scene& scene, std::span<const IndexPair> broken,
                  const typename Pairs::Memory& start) {
    DynArray<NewPair> more;
    for (const IndexPair& p : broken) more.push_back({p, true});
    pairs.join(more, scene.particles.size(), start);
    renewed_ = true;
  }
  /// Removes rows that have just left.
  void leave(const Scene& scene, std::span<const std::uint32_t> rows) {
    if (!hold_pairs()) return;
    pairs.leave(rows, scene.particles.size());
    const auto is_gone = [&](const WallCandidate& c) {
      return std::find(rows.begin(), rows.end(), c.particle) != rows.end();
    };
    if (std::any_of(walls.candidates().begin(), walls.candidates().end(), is_gone))
      prune_walls_again(scene);
    renewed_ = true;
  }

  /// Must be called after row k has grown (ListUpkeep::charge()). If too little of its reaches is
  /// left, the next step prunes or searches.
  void follow_growth(const Scene& scene, std::size_t k, double radius, double reach) {
    if (!hold_pairs() || k >= upkeep.outer.size()) return;
    if (scene.range > walls.range || flows) return forget();
    if (!upkeep.charge(k, radius, reach)) {
      if (!(upkeep.outer[k] > 0)) return forget();
      upkeep.inner[k] = upkeep.per_inner2[k] = 0, upkeep.used = 1;
    }
  }
  /// Must be called after other properties of rows have changed.
  void follow_change() { renewed_ = upkeep.pruned_at >= 0; }

  /// Sets the period of walls that repeat with the box.
  void set_period([[maybe_unused]] const Domain& box) {
    if constexpr (Walls::repeats)
      walls.period = searched_walls.period = pruned_walls.period = period_of(box);
  }

  /// Completes lists that a checkpoint restored.
  void restored() { first_pruning_ = false, renewed_ = upkeep.pruned_at >= 0; }

  std::size_t bytes() const {
    return reference.capacity() * sizeof(Vec3d) + pairs.bytes() +
           (upkeep.outer.capacity() + upkeep.inner.capacity() + upkeep.per_inner2.capacity() +
            speeds_.capacity() + anticipated_.capacity()) *
               sizeof(double) +
           grown_.capacity() * sizeof(PositionRow) + found_.capacity() * sizeof(IndexPair);
  }

 private:
  static constexpr bool keeps_list = requires(Search & s) { s.finder; };

  // --- newcomers ----------------------------------------------------------------------------

  bool hold_pairs() const { return keeps_list && upkeep.pruned_at >= 0; }
  /// Up to this number of rows a search is not needed for newcomers; their pairs are in the groups
  /// of the last rows, which one thread computes.
  static std::size_t most_with_newcomers(std::size_t before) { return before + before / 64 + 8; }

  void join_walls(const Scene& scene, std::size_t first) {
    const std::size_t n = scene.particles.size();
    grown_.resize(n);
    for (std::size_t k = first; k < n; ++k) {
      grown_[k] = scene.particles.position[k];
      grown_[k].r += upkeep.outer[k] + scene.range / 2;
    }
    // As in Newcomers: walls may move back by as much as they have moved since the search.
    const double travel = searched_walls.travel(scene.walls);
    walls.join(scene.walls, {grown_.data(), n}, first, upkeep.outer_wall + travel + scene.range / 2,
               scene.domain);
    prune_walls_again(scene);
  }
  void prune_walls(const Scene& scene, double travelled) {
    walls.prune(scene.walls, scene.particles.position.data(), upkeep.inner.data(),
                upkeep.inner_wall + travelled + scene.range, scene.team);
  }
  /// The same between two prunings. A wall's displacement since the last pruning counts twice: it
  /// may return, and move as far to the other side.
  void prune_walls_again(const Scene& scene) {
    prune_walls(scene, pruned_walls.travel(scene.walls));
  }

  // --- reaches of the lists -----------------------------------------------------------------

  /// The speeds [m/s] that particles may soon reach: their own, or most of the speed of the fastest
  /// neighbour, which may hit them.
  void anticipate_speeds(const Scene& scene) {
    constexpr double passed_on = 0.75;
    const std::size_t n = scene.particles.size();
    speeds_.resize(n), anticipated_.resize(n);
    [[maybe_unused]] double squeeze = 0;  // [1/s]
    if constexpr (flows) squeeze = scene.domain.squeeze_rate();
    scene.team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        Vec3d v = scene.particles.motion[k].velocity();
        if constexpr (flows) v -= scene.domain.flow_at(scene.particles.position[k].centre());
        anticipated_[k] = speeds_[k] = std::sqrt(dot(v, v));
        if constexpr (flows)
          anticipated_[k] = speeds_[k] += squeeze * (scene.particles.position[k].r + scene.range);
      }
    });
    pairs.for_each_outer(scene.team, [&](std::uint32_t a, std::uint32_t b) {
      anticipated_[a] = std::max(anticipated_[a], passed_on * speeds_[b]);
      anticipated_[b] = std::max(anticipated_[b], passed_on * speeds_[a]);
    });
  }

  /// [m/s] over the last step; -1 if no wall moves.
  double fastest_wall(const Scene& scene) const {
    if (std::none_of(scene.walls.begin(), scene.walls.end(),
                     [](const Wall& w) { return w.moves(); }))
      return -1;
    const Box region = occupied_region(scene);
    return longest_way(scene.walls, region, searched_walls.period) / scene.time_step;
  }

  void choose_skins(const Scene& scene, const Search& search, double wall_speed) {
    if constexpr (keeps_list) {
      if (search.skin) return upkeep.set_skin(*search.skin);
      std::array<double, Team::most_ranges> sum{}, most{};
      scene.team.for_ranges(
          anticipated_.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
            for (std::size_t k = from; k < to; ++k)
              sum[r] += anticipated_[k], most[r] = std::max(most[r], anticipated_[k]);
          });
      double fastest = *std::max_element(most.begin(), most.end());
      std::array<double, 2> all{std::accumulate(sum.begin(), sum.end(), 0.0),
                                static_cast<double>(anticipated_.size())};
      if constexpr (State::of_ranks) fastest = scene.ranks.max_of(fastest), scene.ranks.sum_of(all);
      upkeep.choose_skins(scene.particles.mean_diameter, all[0] / std::max(all[1], 1.0),
                          std::max(wall_speed, fastest), scene.time_step);
    }
  }

  /// Grows spheres by their outer reaches and half the law's range. The outer list contains the
  /// pairs that overlap then.
  void reach_out(const Scene& scene, double wall_speed) {
    const std::size_t n = scene.particles.size();
    upkeep.outer.resize(n), grown_.resize(n);
    std::array<double, Team::most_ranges> largest{};
    scene.team.for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        upkeep.outer[k] = keeps_list ? upkeep.outer_reach(anticipated_[k]) : last_way(scene, k);
        grown_[k] = scene.particles.position[k];
        grown_[k].r += upkeep.outer[k] + scene.range / 2;
        largest[r] = std::max(largest[r], grown_[k].r);
      }
    });
    largest_grown_ = *std::max_element(largest.begin(), largest.end());
    if constexpr (keeps_list)
      upkeep.set_outer_wall(wall_speed);
    else
      upkeep.outer_wall = std::max(wall_speed, 0.0) * scene.time_step;
  }
  /// [m] Bounds how far row k has moved in the last step. By this much reaches a search without a
  /// list, so that it still finds contacts that have just ended: their end is told and booked.
  static double last_way(const Scene& scene, std::size_t k);

  /// Chooses the inner reaches; false if the outer list is not valid for them.
  bool choose_inner(const Scene& scene, double wall_speed) {
    const State& particles = scene.particles;
    const std::size_t n = particles.size();
    upkeep.inner.resize(n), upkeep.per_inner2.resize(n);
    if constexpr (!keeps_list) {
      std::fill_n(upkeep.per_inner2.begin(), n, 0.0);
      if (upkeep.outer.size() == n) upkeep.inner = upkeep.outer;
      upkeep.inner_wall = upkeep.outer_wall;
      return false;
    }
    std::array<bool, Team::most_ranges> too_little{};
    scene.team.for_ranges(particles.owned(), [&](std::size_t r, std::size_t from, std::size_t to) {
      too_little[r] = !upkeep.set_inner(from, to, anticipated_, [&](std::size_t k) {
        if constexpr (flows)
          if (!particles.is_parked(k))
            return flow.spent(upkeep.outer[k], particles.position[k].r + scene.range / 2,
                              reference[k], particles.position[k].centre(), scene.domain.centre());
        return particles.is_parked(k) ? 0.0 : norm(particles.position[k].centre() - reference[k]);
      });
    });
    const bool fit = upkeep.set_inner_wall(wall_speed, searched_walls.travel(scene.walls)) &&
                     std::none_of(too_little.begin(), too_little.end(), [](bool is) { return is; });
    if constexpr (State::of_ranks) return scene.ranks.all(fit);
    return fit;
  }

  // --- search -------------------------------------------------------------------------------

  /// Whether this search sorts the particles by cells. Sorting at every step would cost more time
  /// than it saves.
  static bool is_to_sort([[maybe_unused]] const Search& search, std::int64_t step) {
    if constexpr (keeps_list)
      return search.sort;
    else
      return step % 1000 == 0;
  }

  void find_pairs(const Scene& scene, Search& search, double wall_speed, std::int64_t step);
  /// Records the present order of rows. Then removes particles that have left and wraps the others
  /// into a periodic box; with several ranks, sends them to the ranks that own their positions.
  void take_stock(const Scene& scene, std::int64_t step);
  /// The spheres, grown by their reaches.
  SphereSet grown() const {
    return {std::span<const PositionRow>(grown_.data(), grown_.size()), largest_grown_};
  }
  /// Sorts the rows by cells if this search does so. Returns whether the pairs were found as well.
  bool sort_rows(const Scene& scene, Search& search, std::int64_t step);
  void find_near(const Scene& scene, Search& search);
  /// Finds spheres near walls, except those bonded to the wall.
  void find_walls(const Scene& scene, double reach);
  /// Records the positions of particles and walls, from which displacements are measured.
  void mark_places(const Scene& scene, double of_walls);

  void wrap(const Scene& scene);

  Box occupied_region(const Scene& scene) const {
    const Box region = detail::occupied_region(scene.particles, scene.team);
    if constexpr (State::of_ranks) return scene.ranks.union_of(region);
    return region;
  }

  auto rows_of(const Scene& scene) {
    return typename Change::Rows{scene.particles, scene.mover, previous_, anticipated_, scene.team};
  }
  void change_ranks(const Scene& scene, std::int64_t step);
  void add_ghosts(const Scene& scene);
  DynArray<PositionRow> grown_by_modules(const Scene& scene) const;

  void drop_parked(const Scene& scene);

  void apply_order(const Scene& scene);

  // --- pruning ------------------------------------------------------------------------------

  void prune(const Scene& scene) {
    const std::size_t n = scene.particles.size();
    const auto* const rows = scene.particles.position.data();
    grown_.resize(n);
    scene.team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        grown_[k] = rows[k], grown_[k].r += upkeep.inner[k] + scene.range / 2;
    });
    const std::span<const std::uint32_t> none, before(previous_);
    pairs.template prune<typename Composition::Arch>({grown_.data(), n}, scene.domain,
                                                     first_pruning_ ? before : none, scene.team);
    prune_walls(scene, 0);
    pruned_walls.set(scene.walls, searched_walls.region());
    upkeep.used = 0;
    if constexpr (flows) flow.prune(tightest(scene));
    first_pruning_ = false, renewed_ = true;
  }

  /// FlowSince::tightest
  double tightest(const Scene& scene) const {
    double most = 0;
    for (std::size_t k = 0; k < scene.particles.size(); ++k)
      if (!scene.particles.is_parked(k) && upkeep.inner[k] > 0)
        most = std::max(most, (scene.particles.position[k].r + scene.range / 2) / upkeep.inner[k]);
    return most;
  }

  using Change = RankChange<State, Mover, Pairs, Walls>;
  struct NoChange {};
  [[no_unique_address]] std::conditional_t<State::of_ranks, Change, NoChange> change_;
  [[no_unique_address]] std::conditional_t<flows, BoxImages, NoFlow> images_;
  std::vector<IndexPair> found_;
  std::vector<std::uint32_t> order_;
  DynArray<std::uint32_t> previous_;
  DynArray<double> speeds_, anticipated_;  // [m/s]
  AlignedVector<PositionRow> grown_;       // positions, with radii grown by outer or inner reach
  double largest_grown_ = 0;               // [m]
  bool first_pruning_ = true, renewed_ = false;
};

}  // namespace silt::detail

#include <silt/engine/lists/find_pairs.hpp>
