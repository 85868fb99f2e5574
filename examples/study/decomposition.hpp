// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>
#include <silt/parallel/decomposition/slabs.hpp>
#include <silt/parallel/thread_comm.hpp>

/// Work of the ranks of a run, counted in a run of one process: at each neighbour search a
/// decomposition gets the positions of all particles and the work of each, as from the ranks' own
/// search (engine/ranks/rank_change.hpp).
namespace decomposition_study {

/// The particles at a search, and the pairs that it found.
struct Search {
  double time = 0;                  // [s] after opening
  std::int64_t steps = 0;           // [-] since the search before
  std::vector<std::size_t> number;  // of each row its particle's, which stays
  std::vector<silt::Vec3d> place;   // [m]
  std::vector<double> work;         // [-] one, and half of each listed pair
  std::vector<double> grown;        // [m] radius and how far the list reaches
  struct Pair {
    std::uint32_t a, b;
    bool touches;
  };
  std::vector<Pair> pairs;  // that are computed at each step
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      nearby;  // that may be before the next search

  template <class Sim>
  Search(const Sim& sim, double opening, std::int64_t since)
      : time(std::round(1e9 * (sim.time() - opening)) / 1e9), steps(since) {
    const auto& e = sim.engine();
    const auto& list = e.lists.pairs;
    for (std::size_t k = 0; k < e.particles.size(); ++k) {
      number.push_back(static_cast<std::size_t>(e.particles.id[k]));
      place.push_back(e.lists.reference[k]);
      grown.push_back(e.particles.position[k].r + e.lists.upkeep.outer[k]);
    }
    work.assign(place.size(), 1);
    list.for_each([&](std::size_t k) {
      const std::uint32_t a = list.first()[k], b = list.second()[k];
      work[a] += 0.5, work[b] += 0.5;
      const double reach = e.particles.position[a].r + e.particles.position[b].r;
      const auto d = e.particles.position[a].centre() - e.particles.position[b].centre();
      pairs.push_back({a, b, dot(d, d) < reach * reach});
    });
    list.for_each_outer(silt::Team(1),
                        [&](std::uint32_t a, std::uint32_t b) { nearby.emplace_back(a, b); });
  }
};

/// Work of a rank between two searches.
struct RankCount {
  double particles = 0, contacts = 0, work = 0;
  double pairs = 0;         // computed here: its own, and each with a ghost, on both ranks
  double least_ghosts = 0;  // others' particles that have a listed pair with an own one
  double ghosts = 0;        // those that it gets by the engine's criterion of boxes
  double sent = 0;          // rows sent at each step
  double messages = 0;      // sent at each step
};

/// One decomposition on one number of ranks, with its memory from search to search.
class Division {
  using Parts = std::variant<silt::StaticSlabs, silt::MovingSlabs, silt::Bisection>;

 public:
  static constexpr int most_ranks = 64;  // bits of a mask

  std::string name;
  int ranks;
  std::vector<RankCount> now;                     // after the last search
  double imbalance = 1;                           // [-] largest over mean work, likewise
  double partitions = 0, migrated = 0;            // since the start
  double worst_start = 1;                         // [-] imbalance right after a decomposition
  double worst_end = 1;                           // [-] imbalance at the end of a decomposition
  double missing_ghosts = 0, lost_particles = 0;  // none, if all is right
  double partition_cost = 0;                      // in units of work, by what Rebalance supposes

  template <class How>
  Division(std::string what, int of_ranks, const How& parts)
      : name(std::move(what)),
        ranks(of_ranks),
        stays_(std::is_same_v<How, silt::StaticSlabs>),
        parts_(static_cast<std::size_t>(of_ranks), Parts(parts)) {
    silt::require(ranks <= most_ranks, "a division between ", ranks, " ranks: at most ",
                  most_ranks);
  }

  /// Decides as the ranks would at this search, and counts their work afterwards.
  void look(const Search& s) {
    const std::size_t n = s.place.size();
    const double mean_points = static_cast<double>(n) / ranks;
    const bool first = owner_.empty();
    std::vector<int> before(n);
    if (first)
      for (std::size_t k = 0; k < n; ++k) before[k] = static_cast<int>(k * parts_.size() / n);
    else
      for (std::size_t k = 0; k < n; ++k) before[k] = owner_[s.number[k]];
    const silt::Load load = load_by(before, s);
    if (!first) {
      const double steps = static_cast<double>(s.steps);
      average_ += steps * (imbalance + load.imbalance()) / 2, steps_ += steps;
    }
    const bool parts_anew = first || (!stays_ && when_.due(load, s.steps, mean_points));
    std::vector<int> after(n);
    if (parts_anew) {
      after = partition(s, before);
      std::vector<double> sent(parts_.size(), 0);
      for (std::size_t k = 0; k < n; ++k)
        sent[static_cast<std::size_t>(before[k])] += after[k] != before[k];
      const double most = *std::max_element(sent.begin(), sent.end());
      when_.parted(static_cast<std::int64_t>(first ? mean_points / 10 : most));
      if (!first) {
        worst_end = std::max(worst_end, load.imbalance());
        partition_cost += when_.each * mean_points + when_.per_moved * most, ++partitions;
      }
    } else {
      for (std::size_t k = 0; k < n; ++k)
        after[k] = std::visit([&](const auto& of) { return of.rank_of(s.place[k]); }, parts_[0]);
    }
    if (!first)
      for (std::size_t k = 0; k < n; ++k) migrated += after[k] != before[k];
    owner_.resize(n);
    for (std::size_t k = 0; k < n; ++k) owner_[s.number[k]] = after[k];
    imbalance = load_by(after, s).imbalance();
    if (parts_anew && !stays_) worst_start = std::max(worst_start, imbalance);
    count(s, after);
  }
  /// [-] time average: between two searches the mean of the value after the first and the value
  /// before the second.
  double mean_imbalance() const { return steps_ > 0 ? average_ / steps_ : 1; }

 private:
  std::vector<int> partition(const Search& s, const std::vector<int>& before) {
    std::vector<std::vector<std::size_t>> rows(parts_.size());
    for (std::size_t k = 0; k < before.size(); ++k)
      rows[static_cast<std::size_t>(before[k])].push_back(k);
    std::vector<int> after(before.size());
    const auto on_rank = [&](const silt::ThreadComm& comm) {
      const auto r = static_cast<std::size_t>(comm.rank());
      std::vector<silt::Vec3d> points;
      std::vector<double> work;
      for (const std::size_t k : rows[r]) points.push_back(s.place[k]), work.push_back(s.work[k]);
      const auto to =
          std::visit([&](auto& of) { return of.partition(comm, points, work); }, parts_[r]);
      for (std::size_t k = 0; k < to.size(); ++k) after[rows[r][k]] = to[k];
    };
    silt::run_on_ranks(ranks, on_rank, 600);
    return after;
  }

  silt::Load load_by(const std::vector<int>& owner, const Search& s) const {
    std::vector<double> work(parts_.size(), 0);
    for (std::size_t k = 0; k < owner.size(); ++k)
      work[static_cast<std::size_t>(owner[k])] += s.work[k];
    silt::Load load;
    for (const double w : work) load.largest = std::max(load.largest, w), load.mean += w / ranks;
    return load;
  }

  void count(const Search& s, const std::vector<int>& owner) {
    const auto n = owner.size(), all = parts_.size();
    const auto rank_of = [&](std::size_t k) { return static_cast<std::size_t>(owner[k]); };
    now.assign(all, {});
    struct Part {
      silt::Box box;
      double largest = 0;  // [m]
    };
    std::vector<Part> part(all);
    for (std::size_t k = 0; k < n; ++k) {
      auto& of = now[rank_of(k)];
      ++of.particles, of.work += s.work[k];
      auto& p = part[rank_of(k)];
      p.box.include(s.place[k]), p.largest = std::max(p.largest, s.grown[k]);
    }
    for (const auto& pair : s.pairs) {
      const auto a = rank_of(pair.a), b = rank_of(pair.b);
      ++now[a].pairs;
      if (a != b) ++now[b].pairs;
      now[a].contacts += pair.touches;
    }
    std::vector<std::uint64_t> needed(n, 0), given(n, 0);  // by which ranks, a bit each
    for (const auto& [a, b] : s.nearby)
      if (rank_of(a) != rank_of(b))
        needed[a] |= std::uint64_t{1} << owner[b], needed[b] |= std::uint64_t{1} << owner[a];
    for (std::size_t r = 0; r < all; ++r) {
      if (now[r].particles == 0) continue;
      const silt::Vec3d centre = 0.5 * (part[r].box.min + part[r].box.max);
      const silt::Vec3d half = 0.5 * part[r].box.extent();
      for (std::size_t k = 0; k < n; ++k) {
        if (rank_of(k) == r) continue;
        const silt::Vec3d d = s.place[k] - centre;
        const double reach = s.grown[k] + part[r].largest;
        const double z = std::abs(d.z) - half.z;
        if (z > reach) continue;
        const silt::Vec3d out{std::max(std::abs(d.x) - half.x, 0.0),
                              std::max(std::abs(d.y) - half.y, 0.0), std::max(z, 0.0)};
        if (dot(out, out) < (1 + 1e-12) * reach * reach) given[k] |= std::uint64_t{1} << r;
      }
    }
    std::vector<std::uint64_t> to(all, 0);
    for (std::size_t k = 0; k < n; ++k) {
      missing_ghosts += std::popcount(needed[k] & ~given[k]);
      now[rank_of(k)].sent += std::popcount(given[k]);
      to[rank_of(k)] |= given[k];
      for (auto left = needed[k]; left != 0; left &= left - 1)
        ++now[static_cast<std::size_t>(std::countr_zero(left))].least_ghosts;
      for (auto left = given[k]; left != 0; left &= left - 1)
        ++now[static_cast<std::size_t>(std::countr_zero(left))].ghosts;
    }
    double particles = 0;
    for (std::size_t r = 0; r < all; ++r)
      now[r].messages = std::popcount(to[r]), particles += now[r].particles;
    lost_particles += std::abs(particles - static_cast<double>(n));
  }

  bool stays_;                // a partition changes nothing
  std::vector<Parts> parts_;  // of each rank; all say the same
  silt::Rebalance when_{};
  std::vector<int> owner_;  // by the number of the particle
  double average_ = 0, steps_ = 0;
};

/// The time of a step in the run of one process, and the work in it.
struct Timed {
  double seconds;  // [s] processor time
  double pairs, owners;
  double steps;  // from one search to the next
};

/// Counts of a run, search by search.
struct Recorded {
  std::vector<double> times;  // [s] after opening
  std::vector<Timed> timed;
  std::vector<Timed> filling;                              // before opening: few pairs at first
  std::vector<Division> divisions;                         // as they are at the end
  std::vector<std::vector<std::vector<RankCount>>> ranks;  // of each search and division
  std::vector<std::vector<double>> imbalance;              // likewise
  std::vector<double> moments;                             // [s] of the paper's pictures
  double particles = 0, layer = 0;    // [-]; ghosts around a part, in mean distances of particles
  double ghost = 0, ghost_bytes = 0;  // [s], [bytes] of one at each step
};

}  // namespace decomposition_study
