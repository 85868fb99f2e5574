// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/ranks/near_reach.hpp>
#include <silt/engine/ranks/no_ranks.hpp>
#include <silt/engine/ranks/packed.hpp>
#include <silt/engine/ranks/passed_rows.hpp>
#include <silt/engine/ranks/rank_bodies.hpp>
#include <silt/engine/ranks/rank_wall_loads.hpp>
#include <silt/parallel/agree.hpp>
#include <silt/parallel/rank_load.hpp>
#include <silt/parallel/ranks.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Counters since the start, for this rank.
struct RankCounts {
  std::uint64_t searches = 0, partitions = 0;
  std::uint64_t migrated = 0;             // rows received from other ranks
  std::uint64_t messages = 0, bytes = 0;  // sent in steps and at searches
  Load load;                              // of all ranks, before the last search
};

/// Adds the time from its construction to its destruction.
class AddsSeconds {
 public:
  explicit AddsSeconds(double& seconds) : seconds_(seconds) {}
  AddsSeconds(const AddsSeconds&) = delete;
  AddsSeconds& operator=(const AddsSeconds&) = delete;
  ~AddsSeconds() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The part of bonds in a search; RankChange calls it without knowing bond models (RankBonds).
class BondsAtSearch {
 public:
  virtual ~BondsAtSearch() = default;
  /// Before particles migrate: owned row k goes to rank to[k]; -1: it has left.
  virtual void leave(std::span<const int> to) = 0;
  /// After that: sends their bonds. Returns for each rank the owned rows that it needs as ghosts
  /// (collective).
  virtual DynArray<DynArray<std::uint32_t>> pass() = 0;
};

/// The engine's part in a run on several ranks: which rank owns which particle, which ghosts it
/// needs, and what all ranks must agree on. Functions marked as collective must be called by all
/// ranks at the same point of the program.
///
/// A rank owns the particles in its part of space, which the decomposition assigns at each search.
/// Behind its owned rows it has ghosts: copies of all particles of other ranks that its own
/// particles may touch before the next search. A pair of an owned particle and a ghost is computed
/// on both ranks, from the same numbers and in the same orientation (by ids), so both store the
/// same history.
template <class Policy>
class RankStage {
 public:
  static constexpr bool active = true;
  DynArray<RankNeighbour> neighbours;  // sorted by rank
  RankCounts counts;
  mutable RankSeconds seconds;                // since this process began
  DynArray<std::array<double, 2>> of_servos;  // of walls [N/m], [N s/m]: look_at_servos()
  BondsAtSearch* bonds = nullptr;             // while lists are renewed, if there are bonds
  NearReach reach;                            // of modules that act in pairs, since the last search
  DynArray<double> near_work;                 // of them, for each owner, in units of a contact

  void set(Policy policy) { policy_ = std::move(policy); }
  const auto& comm() const { return policy_->comm; }
  /// Calls work() on each rank; if it throws on one rank, all ranks throw that error (collective).
  template <class Work>
  void together(const char* call, const Work& work) const {
    silt::together(policy_->comm, call, [&] { throw_late(), work(); });
  }
  /// Calls work() without waiting for the other ranks; an error is thrown at the next collective
  /// call, or in the next step.
  template <class Work>
  void until_later(const Work& work) const {
    if (size() == 1) return work();
    try {
      work();
    } catch (...) {
      if (!late_) late_ = std::current_exception();
    }
  }
  void throw_late() const {
    if (late_) std::rethrow_exception(std::exchange(late_, nullptr));
  }
  /// The same; then replaces the numbers that most() returns by their maxima over all ranks.
  template <class Work, class Most>
  auto together(const char* call, const Work& work, const Most& most) const {
    is_agreed() = false;
    std::exception_ptr error;
    try {
      throw_late(), work();
    } catch (...) {
      error = std::current_exception();
    }
    auto all = most();
    silt::agree(policy_->comm, call, error, all);
    return all;
  }
  /// Called before a message between ranks: if one has failed, all throw its error (collective).
  void meet(const char* call) const {
    silt::agree(policy_->comm, call, std::exchange(late_, nullptr));
  }
  /// The same with an error of this rank, or none; numbers become their maxima over all ranks.
  void agree(const char* call, const std::exception_ptr& error, std::span<double> most) const {
    const AddsSeconds timed(seconds.agreement);
    const std::exception_ptr before = std::exchange(late_, nullptr);
    silt::agree(policy_->comm, call, before ? before : error, most);
  }
  int rank() const { return policy_->comm.rank(); }
  int size() const { return policy_->comm.size(); }
  /// This rank's share of `all` things without an owner: first and end index.
  std::pair<std::size_t, std::size_t> share_of(std::size_t all) const {
    const auto r = static_cast<std::size_t>(rank()), n = static_cast<std::size_t>(size());
    return {all * r / n, all * (r + 1) / n};
  }

  // --- agreement of all ranks (collective) --------------------------------------------------

  /// The maximum of each number over all ranks.
  void max_of(std::span<double> values) const { policy_->comm.max_of(values); }
  double max_of(double value) const {
    max_of({&value, 1});
    return value;
  }
  bool any(bool is) const { return max_of(is ? 1.0 : 0.0) > 0; }
  bool all(bool is) const { return !any(!is); }
  /// The sum of each number, added in the order of ranks.
  void sum_of(std::span<double> values) const {
    if (size() == 1) return;
    const auto all = gather(policy_->comm, std::span<const double>(values));
    std::fill(values.begin(), values.end(), 0.0);
    for (int r = 0; r < all.ranks(); ++r)
      for (std::size_t k = 0; k < values.size(); ++k) values[k] += all[r][k];
  }
  /// The largest and lightest particles of all ranks.
  template <class Meetings>
  Meetings union_of_meetings(Meetings own) {
    using Spheres = typename decltype(own.spheres)::value_type;
    const auto all = gather(policy_->comm, std::span<const Spheres>(own.spheres));
    for (auto& of : own.spheres) of = {};
    for (int r = 0; r < all.ranks(); ++r)
      for (std::size_t m = 0; m < own.spheres.size(); ++m) own.spheres[m].include_all(all[r][m]);
    return own;
  }
  Box union_of(const Box& box) const {
    std::array<double, 6> ends{-box.min.x, -box.min.y, -box.min.z, box.max.x, box.max.y, box.max.z};
    max_of(ends);
    return {{-ends[0], -ends[1], -ends[2]}, {ends[3], ends[4], ends[5]}};
  }
  /// The size statistics of all particles, on each rank.
  template <class State>
  void measure(State& particles) {
    std::array<double, 3> most{particles.largest_radius, -particles.smallest_radius,
                               particles.some_fixed ? 1.0 : 0.0};
    if (particles.owned() == 0) most = {0, -std::numeric_limits<double>::infinity(), 0};
    const auto rows = static_cast<double>(particles.owned() - particles.parked);
    std::array<double, 3> sums{particles.mean_diameter * rows, rows,
                               static_cast<double>(present_in(particles))};
    max_of(most), sum_of(sums);
    particles.largest_radius = most[0], particles.smallest_radius = std::min(-most[1], most[0]);
    particles.some_fixed = most[2] > 0;
    particles.mean_diameter = sums[1] > 0 ? sums[0] / sums[1] : 0;
    present_ = static_cast<std::size_t>(sums[2]);
  }
  /// Number of particles on all ranks, at the last measurement.
  std::size_t present() const { return present_; }
  void count(std::size_t more) { present_ += more; }
  void discount(std::size_t fewer) { present_ -= fewer; }

  // --- in each step (collective) ------------------------------------------------------------

  /// Copies positions and motion of ghosts from their owning ranks: the first call sends, the
  /// second receives.
  template <class State, class Mover>
  void begin_refresh(State& particles, Mover& mover) {
    with_refreshed(particles, mover, [this](const auto&... passed) { this->begin(passed...); });
  }
  template <class State, class Mover>
  void finish_refresh(State& particles, Mover& mover) {
    if (under_way_)
      with_refreshed(particles, mover, [this](const auto&... passed) { this->finish(passed...); });
  }
  /// The same for the values of a column.
  template <class Column>
  void share(Column& column) {
    const auto passed =
        pass_rows<double>([&](std::uint32_t k) { return column[k]; },
                          [&](std::uint32_t k, double value) { column[k] = value; });
    begin(passed);
    if (under_way_) finish(passed);
  }

  /// RankWallLoads::share(); one message, or none (collective).
  template <class Walls>
  void share_loads(Walls& walls, bool all) {
    if (size() > 1)
      wall_loads_.share(walls, all, of_servos, [this](std::span<double> x) { sum_of(x); });
  }
  /// RankWallLoads::move_reference()
  void move_reference(std::size_t w, const Vec3d& back) { wall_loads_.move_reference(w, back); }

  // --- checkpoint state ---------------------------------------------------------------------

  struct State {
    RankWallLoads loads;
    std::size_t present = 0;
    std::int64_t last_step = 0;
    double lost = 0, moved = -1;  // Rebalance
    NearReach reach;
    DynArray<double> near_work;
  };
  State state(std::size_t walls) const {
    State s{wall_loads_, present_, last_step_, policy_->rebalance.lost, policy_->rebalance.moved,
            reach,       near_work};
    s.loads.resize(walls);
    return s;
  }
  void restore(State s) {
    wall_loads_ = std::move(s.loads), present_ = s.present;
    last_step_ = s.last_step, policy_->rebalance.lost = s.lost, policy_->rebalance.moved = s.moved;
    reach = s.reach, near_work = std::move(s.near_work);
  }
  using PartsType = std::remove_cvref_t<decltype(std::declval<Policy&>().parts)>;
  /// Whether the decomposition has a state to save; visits it with for_each_state(visit).
  template <class Visit>
  static constexpr bool tells_parts = std::copyable<PartsType>&& requires(PartsType& parts,
                                                                          Visit& visit) {
    parts.for_each_state(visit);
  };
  const PartsType& parts() const { return policy_->parts; }
  void set_parts(PartsType parts) { policy_->parts = std::move(parts); }
  /// Requests a new division of space at the next search.
  void part_anew() { counts.partitions = 0; }

  // --- at a search (collective) -------------------------------------------------------------

  /// The new rank of each owned row, -1 for those that have left. Bodies are not divided.
  /// `weights`: the work of each row per step.
  template <class State, class Mover>
  DynArray<int> choose_ranks(const State& particles, const Mover& mover,
                             std::span<const double> weights, std::int64_t step) {
    auto& parts = policy_->parts;
    const OwnParticles<State, Mover> own(particles, mover, weights);
    const DynArray<Vec3d>& points = own.points;
    const DynArray<double>& work = own.weights;
    counts.load = load_of(policy_->comm, std::accumulate(work.begin(), work.end(), 0.0));
    const bool first = counts.partitions == 0;
    const double mean_points = static_cast<double>(present_) / size();
    DynArray<int> chosen;
    const bool is_due =
        policy_->rebalance.due(counts.load, step - last_step_, mean_points) || first;
    if (is_due)
      chosen = parts.partition(policy_->comm, points, work);
    else if constexpr (std::remove_cvref_t<decltype(parts)>::by_place)
      for (const Vec3d& p : points) chosen.push_back(parts.rank_of(p));
    else
      chosen.assign(points.size(), rank());
    meet("a decomposition");
    if (is_due) {
      double sent = 0;
      for (const int r : chosen) sent += r != rank();
      policy_->rebalance.parted(static_cast<std::int64_t>(first ? mean_points / 10 : max_of(sent)));
      ++counts.partitions;
    }
    last_step_ = step;
    DynArray<int> to(particles.owned(), -1);
    for (std::size_t k = 0; k < to.size(); ++k)
      if (!particles.is_parked(k)) to[k] = chosen[own.place_of(k)];
    return to;
  }

  /// Whether this rank owns a new particle at this position [m]. Before the first search, or if the
  /// decomposition does not depend on position, each rank takes a share of the `of` new particles.
  bool takes(const Vec3d& place, std::size_t k, std::size_t of) const {
    using Parts = decltype(Policy::parts);
    if constexpr (Parts::by_place)
      if (counts.partitions > 0) return policy_->parts.rank_of(place) == rank();
    const auto [from, end] = share_of(of);
    return k >= from && k < end;
  }
  /// The particles of all ranks whose centre, or an image of it, is in a region (collective).
  template <class State, class Domain>
  DynArray<PositionRow> all_in(const Box& region, const State& particles,
                               const Domain& domain) const {
    DynArray<PositionRow> own;
    for (const PositionRow& p : particles.rows()) {
      bool is_in = false;
      for_images(domain, p.centre(), [&](const Vec3d& image) { is_in |= region.contains(image); });
      if (p.r > 0 && is_in) own.push_back(p);
    }
    meet("particles in a region");
    return gather(policy_->comm, std::span<const PositionRow>(own)).values;
  }
  /// Sums over all ranks what particles have added to outlets (collective).
  template <class Outlets>
  void share_left(Outlets& outlets, const Outlets& before) {
    DynArray<double> left;
    for (std::size_t k = 0; k < outlets.size(); ++k)
      left.push_back(static_cast<double>(outlets[k].count - before[k].count)),
          left.push_back(outlets[k].mass - before[k].mass);
    sum_of(left);
    for (std::size_t k = 0; k < outlets.size(); ++k) {
      const auto count = static_cast<std::uint64_t>(left[2 * k]);
      outlets[k].count = before[k].count + count;
      outlets[k].mass = before[k].mass + left[2 * k + 1];
      present_ -= count;
    }
  }
  /// Must be called after `more` rows were inserted in front of the ghosts.
  void make_way(std::size_t more) {
    for (RankNeighbour& other : neighbours)
      other.first += static_cast<std::uint32_t>(more),
          other.end += static_cast<std::uint32_t>(more);
  }

  /// Sends each rank its bytes; returns the bytes received from each (collective).
  DynArray<Arrival> pass(DynArray<Packed>& out) {
    DynArray<Outgoing> messages;
    for (std::size_t r = 0; r < out.size(); ++r)
      if (const auto bytes = out[r].bytes(); !bytes.empty()) {
        ++counts.messages, counts.bytes += bytes.size();
        messages.push_back({static_cast<int>(r), bytes});
      }
    return deliver(policy_->comm, messages);
  }

 private:
  /// Sends one message to each neighbour.
  template <class... Passed>
  void begin(const Passed&... passed) {
    if (neighbours.empty()) return;
    const AddsSeconds timed(seconds.ghosts);
    out_.resize(neighbours.size()), in_.resize(neighbours.size());
    DynArray<Outgoing> sends;
    DynArray<Incoming> receives;
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
      const RankNeighbour& other = neighbours[n];
      out_[n].resize((... + (passed.sent(other).size() * passed.bytes)));
      std::byte* to = out_[n].data();
      (passed.put(other, to), ...);
      in_[n].resize((... + ((passed.end(other) - passed.first(other)) * passed.bytes)));
      if (!out_[n].empty()) {
        sends.push_back({other.rank, out_[n]});
        ++counts.messages, counts.bytes += out_[n].size();
      }
      if (!in_[n].empty()) receives.push_back({other.rank, in_[n]});
    }
    under_way_.emplace(policy_->comm.exchange(sends, receives));
  }
  /// Receives the messages for this rank's ghosts.
  template <class... Passed>
  void finish(const Passed&... passed) {
    const AddsSeconds timed(seconds.ghosts);
    under_way_->wait();
    under_way_.reset();
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
      const std::byte* from = in_[n].data();
      (passed.take(neighbours[n], from), ...);
    }
  }

  std::optional<Policy> policy_;
  mutable std::exception_ptr late_;  // until_later()
  RankWallLoads wall_loads_;
  std::size_t present_ = 0;
  std::int64_t last_step_ = 0;  // in which ranks were last assigned
  using Exchange = decltype(std::declval<const decltype(Policy::comm)&>().exchange(
      std::span<const Outgoing>(), std::span<const Incoming>()));
  DynArray<DynArray<std::byte>> out_, in_;
  std::optional<Exchange> under_way_;  // declared after its buffers, so that it is destroyed first
};

}  // namespace silt::detail
