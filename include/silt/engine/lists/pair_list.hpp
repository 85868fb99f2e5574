// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <silt/core/compress.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/newcomers.hpp>
#include <silt/engine/lists/pair_archive.hpp>
#include <silt/engine/lists/pair_groups.hpp>
#include <silt/engine/lists/pair_history.hpp>
#include <silt/engine/lists/sort_into_groups.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The pairs of a simulation in two lists, with H Scalars of contact history for each pair, some of
/// them in rows (PairHistory).
///
/// Outer list: all pairs nearer than the skin at the last search, group by group (PairGroups).
/// Inner list: those of them nearer than the inner skin at the last pruning; only these are
/// computed. Pruning keeps the order of the outer list, so that histories are transferred by
/// merging two ascending sequences in one pass. In a pair, `a` is the particle with the lower id,
/// so that history never changes its sign. Groups of the inner list begin at whole packs; the gaps
/// between them hold pairs of two dummy spheres of radius 0 (indices n, n+1), and so do `ahead`
/// places behind the last group, for loops that prefetch.
template <std::size_t H, class Scalar, HistoryRows InRows = HistoryRows{}>
class PairList {
  using History = PairHistory<H, Scalar, InRows>;

 public:
  using Memory = std::array<Scalar, H>;  // of one pair
  using Brought = typename PairArchive<H, Scalar>::Brought;
  static constexpr std::size_t padding = 16;  // the widest pack of lanes
  static constexpr std::size_t ahead = 128;   // places

  struct Group {
    std::size_t from = 0, to = 0;  // places in the inner list
    std::size_t size() const { return to - from; }
  };

  /// Number of particles at the search.
  std::size_t grouped() const { return grouped_; }
  std::size_t outer_size() const { return outer_.size(); }
  std::size_t size() const { return size_; }
  std::size_t padded_size() const { return origin_.size(); }
  const PairGroups& groups() const { return groups_; }
  const Group& group(std::size_t g) const { return inner_group_[g]; }
  /// The part of a phase from its first to its last non-empty group.
  PairGroups::Phase busy(PairGroups::Phase phase) const {
    while (phase.from < phase.to && inner_group_[phase.from].size() == 0) ++phase.from;
    while (phase.from < phase.to && inner_group_[phase.to - 1].size() == 0) --phase.to;
    return phase;
  }
  const std::uint32_t* first() const { return first_.data(); }
  const std::uint32_t* second() const { return second_.data(); }
  Scalar* history(std::size_t component) { return history_.column(component); }
  Scalar history(std::size_t component, std::size_t place) const {
    return history_.at(component, place);
  }
  Scalar* history_row(std::size_t place) { return history_.row(place); }
  Scalar* more_history_row(std::size_t place) { return history_.more_row(place); }
  /// Sets the first `numbers` values of a history and its second row to 0.
  void forget_contact(std::size_t place, std::size_t numbers) {
    std::fill_n(history_.row(place), numbers, Scalar(0));
    if (history_.uses_more()) std::fill_n(history_.more_row(place), History::more_width, Scalar(0));
  }
  /// Whether the second rows of histories are in use.
  void use_more_history(bool yes) { history_.use_more(yes); }

  /// Makes the outer list from newly found pairs, without those of two fixed particles or of one
  /// body. `before`: number of particles in the old list.
  template <class State>
  void set_outer(std::span<const IndexPair> found, const State& particles, std::size_t before,
                 const Team& team) {
    archive_.keep(*this, history_, before, team);
    groups_ = PairGroups(particles.owned(), particles.size() - particles.owned());
    grouped_ = particles.size(), owned_ = particles.owned();
    sort_into_groups(found, particles, groups_, {outer_, outer_begin_, group_}, team);
    cut_into_chunks();
    first_.clear(), second_.clear(), origin_.clear();
    inner_group_.clear();
    size_ = 0;
    history_.clear();
  }

  /// Adds the histories of pairs whose particles arrived with the last search, by their places
  /// before it.
  void take_in(std::span<const Brought> more) { archive_.add(more); }
  bool remembers(std::size_t place) const { return history_.remembers(place); }
  Memory memory(std::size_t place) const { return history_.values(place); }

  /// Must be called after `more` rows were inserted in front of the ghosts, which begin at `first`:
  /// pairs and their histories stay as they are until the next search. `particles`: present number
  /// of rows.
  void make_way(std::size_t first, std::size_t more, std::size_t particles);
  /// Adds pairs of particles that were added since the search, with the history `start`. They are
  /// placed at the end of their groups, where the inner list has gaps, so that usually nothing is
  /// moved. `particles`: present number of rows.
  void join(std::span<const NewPair> more, std::size_t particles,
            const std::array<Scalar, H>& start = {});

  /// Removes the pairs of these rows, whose particles have left, from the inner list. In the outer
  /// list they are never found near again. `particles`: present number of rows.
  void leave(std::span<const std::uint32_t> rows, std::size_t particles);

  /// Calls visit(a, b) for all outer pairs; concurrent calls are for pairs without a common
  /// particle.
  template <class Visit>
  void for_each_outer(const Team& team, const Visit& visit) const {
    if (outer_.empty()) return;
    for (std::size_t p = 0; p < groups_.phases(); ++p) {
      auto [from, to] = groups_.phase(p);
      while (to > from && outer_begin_[to] == outer_begin_[to - 1]) --to;
      team.for_parts(to - from, [&, first = from](std::size_t g) {
        for (std::size_t k = outer_begin_[first + g]; k < outer_begin_[first + g + 1]; ++k)
          visit(outer_[k].a, outer_[k].b);
      });
    }
  }
  /// The same for the places of all inner pairs.
  template <class Visit>
  void for_each_inner(const Team& team, const Visit& visit) const {
    if (size_ == 0) return;
    for (std::size_t p = 0; p < groups_.phases(); ++p) {
      const auto [from, to] = busy(groups_.phase(p));
      team.for_parts(to - from, [&, first = from](std::size_t g) {
        for (std::size_t k = group(first + g).from; k < group(first + g).to; ++k) visit(k);
      });
    }
  }

  /// Makes the inner list from all outer pairs that overlap if the particles are grown by their
  /// reaches (`grown`). `previous[k]`: the place of particle k before set_outer, for the first
  /// pruning after it; else empty.
  template <class Arch, class Domain>
  void prune(std::span<const PositionRow> grown, const Domain& domain,
             std::span<const std::uint32_t> previous, const Team& team) {
    make_room(kept_, outer_.size());
    team.for_parts(chunks_.size(), [&](std::size_t c) {
      chunks_[c].kept = keep_near<Arch>(chunks_[c], grown.data(), domain);
    });
    old_origin_.swap(origin_), std::swap(old_history_, history_);
    history_.use_more(old_history_.uses_more());
    lay_out();
    team.for_parts(chunks_.size(), [&](std::size_t c) { fill(chunks_[c], previous); });
    pad(grown.size());
  }

  /// Calls visit(place) for every pair in the inner list.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Group& g : inner_group_)
      for (std::size_t k = g.from; k < g.to; ++k) visit(k);
  }

  /// The present lists, for a checkpoint.
  struct State {
    std::uint64_t grouped;  // particles at the search, which determines the groups
    std::uint64_t owned;    // number of owned ones; the others are ghosts
    std::vector<IndexPair> outer;
    DynArray<std::uint32_t> origin;  // place of each inner pair in the outer list
    std::array<DynArray<double>, H> history;
  };
  State state() const {
    State s{grouped_, owned_, outer_, {}, {}};
    for_each([&](std::size_t k) {
      s.origin.push_back(origin_[k]);
      for (std::size_t h = 0; h < H; ++h) s.history[h].push_back(history_.at(h, k));
    });
    return s;
  }
  /// Lists of only those pairs that have a history; the next search continues from them.
  static State state_of(std::span<const Brought> pairs, std::size_t particles) {
    const PairGroups groups(particles);
    DynArray<std::uint32_t> order(pairs.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) {
      return groups.of(pairs[p].a, pairs[p].b) < groups.of(pairs[q].a, pairs[q].b);
    });
    State s{particles, particles, {}, {}, {}};
    for (const std::uint32_t k : order) {
      s.origin.push_back(static_cast<std::uint32_t>(s.outer.size()));
      s.outer.push_back({pairs[k].a, pairs[k].b});
      for (std::size_t h = 0; h < H; ++h)
        s.history[h].push_back(static_cast<double>(pairs[k].history[h]));
    }
    return s;
  }
  /// `particles`: number of particles in the lists.
  void restore(const State& s, std::size_t particles) {
    history_.use_more(true);
    outer_ = s.outer;
    groups_ = PairGroups(s.owned, s.grouped - s.owned), grouped_ = s.grouped, owned_ = s.owned;
    outer_begin_.assign(groups_.count() + 1, 0);
    for (const auto [a, b] : outer_) ++outer_begin_[groups_.of(a, b) + 1];
    std::partial_sum(outer_begin_.begin(), outer_begin_.end(), outer_begin_.begin());
    cut_into_chunks();
    std::size_t k = 0;
    for (auto& c : chunks_)
      for (c.kept = 0; k < s.origin.size() && s.origin[k] < c.to; ++k) ++c.kept;
    lay_out();
    k = 0;
    for_each([&](std::size_t place) {
      origin_[place] = s.origin[k];
      first_[place] = outer_[s.origin[k]].a, second_[place] = outer_[s.origin[k]].b;
      std::array<Scalar, H> values{};
      for (std::size_t h = 0; h < H; ++h) values[h] = static_cast<Scalar>(s.history[h][k]);
      history_.set(place, values);
      ++k;
    });
    pad(particles);
  }

  std::size_t bytes() const {
    return outer_.capacity() * sizeof(IndexPair) + kept_.capacity() * 4 + group_.capacity() * 2 +
           first_.capacity() * 2 * 4 +
           (origin_.capacity() + old_origin_.capacity()) * (4 + history_.bytes_per_place());
  }

 private:
  static constexpr std::size_t chunk = 4096;  // outer pairs pruned by one thread at a time
  struct Chunk {
    std::size_t group, from, to;      // in the outer list
    std::size_t kept = 0, begin = 0;  // in the inner list
  };

  void cut_into_chunks() {
    chunks_.clear();
    for (std::size_t g = 0; g < groups_.count(); ++g)
      for (std::size_t from = outer_begin_[g]; from < outer_begin_[g + 1]; from += chunk)
        chunks_.push_back({g, from, std::min(from + chunk, outer_begin_[g + 1])});
  }

  /// Moves an inner pair to another place.
  void move(std::size_t from, std::size_t to) {
    first_[to] = first_[from], second_[to] = second_[from], origin_[to] = origin_[from];
    history_.copy(to, &history_, from);
  }

  /// Makes room for more[g] pairs at the end of each group of the outer list; returns the places.
  DynArray<std::size_t> make_way_outer(std::span<const std::size_t> more);
  /// The same in the inner list; its origins follow the moves in the outer one.
  DynArray<std::size_t> make_way_inner(std::span<const std::size_t> more,
                                       std::span<const std::size_t> outer_more);

  /// Assigns each chunk and group its place in the inner list, from the number of pairs that each
  /// chunk keeps.
  void lay_out() {
    inner_group_.assign(groups_.count(), {});
    std::size_t next = 0, c = 0;
    size_ = 0;
    for (std::size_t g = 0; g < groups_.count(); ++g) {
      next = pieces(next, padding) * padding;
      inner_group_[g].from = next;
      for (; c < chunks_.size() && chunks_[c].group == g; ++c) {
        chunks_[c].begin = next;
        next += chunks_[c].kept;
      }
      inner_group_[g].to = next;
      size_ += inner_group_[g].size();
    }
    const std::size_t padded = pieces(next, padding) * padding;
    make_room(first_, padded + ahead), make_room(second_, padded + ahead);
    make_room(origin_, padded);
    history_.resize(padded);
  }

  /// Fills the gaps behind the groups. Their origin keeps the sequence ascending.
  void pad(std::size_t particles) {
    for (std::size_t g = 0; g < inner_group_.size(); ++g) {
      const std::size_t next =
          g + 1 < inner_group_.size() ? inner_group_[g + 1].from : origin_.size();
      for (std::size_t k = inner_group_[g].to; k < next; ++k) {
        first_[k] = static_cast<std::uint32_t>(particles);
        second_[k] = static_cast<std::uint32_t>(particles + 1);
        origin_[k] = k > 0 ? origin_[k - 1] : 0;
        history_.clear(k);
      }
    }
    std::fill(first_.end() - ahead, first_.end(), static_cast<std::uint32_t>(particles));
    std::fill(second_.end() - ahead, second_.end(), static_cast<std::uint32_t>(particles + 1));
  }

  /// Writes the near outer pairs of a chunk into kept_; returns their number.
  template <class Arch, class Domain>
  std::size_t keep_near(const Chunk& c, const PositionRow* grown, const Domain& domain) {
    using Real = typename Lanes<Arch>::Real;
    constexpr std::size_t W = Lanes<Arch>::width;
    const auto difference = Row4<Arch>::of(-1, -1, -1, 1);
    std::uint32_t *const begin = kept_.data() + c.from, *next = begin;
    std::size_t k = c.from;
    for (; k + W <= c.to; k += W) {  // the W places written to belong to this chunk
      Row4<Arch> rows[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        rows[lane] = Row4<Arch>::load(&grown[outer_[k + lane].a].x) +
                     difference * Row4<Arch>::load(&grown[outer_[k + lane].b].x);
      Real columns[4];
      rows_to_columns<Arch>(rows, columns);
      Vec3<Real> d{columns[0], columns[1], columns[2]};
      if constexpr (Domain::periodic) d = domain.shortest(d);
      next = put_places<W>(k, lane_bits(dot(d, d) < columns[3] * columns[3]), next);
    }
    for (; k < c.to; ++k) {
      *next = static_cast<std::uint32_t>(k);
      next += within_reach(grown[outer_[k].a], grown[outer_[k].b], 0, domain);
    }
    return static_cast<std::size_t>(next - begin);
  }

  /// Fills the part of the inner list that comes from one chunk, history included.
  void fill(const Chunk& c, std::span<const std::uint32_t> previous) {
    std::size_t old = static_cast<std::size_t>(
        std::lower_bound(old_origin_.begin(), old_origin_.end(), c.from) - old_origin_.begin());
    for (std::size_t n = 0; n < c.kept; ++n) {
      const std::size_t k = c.begin + n;
      const std::uint32_t outer = kept_[c.from + n];
      origin_[k] = outer;
      first_[k] = outer_[outer].a, second_[k] = outer_[outer].b;
      if constexpr (H > 0) {
        if (!previous.empty()) {
          archive_.recall(history_, k, previous[first_[k]], previous[second_[k]]);
          continue;
        }
        while (old < old_origin_.size() && old_origin_[old] < outer) ++old;
        const bool carried = old < old_origin_.size() && old_origin_[old] == outer;
        history_.copy(k, carried ? &old_history_ : nullptr, old);
      }
    }
  }

  PairGroups groups_;
  std::size_t grouped_ = 0, owned_ = 0;  // particles for which the groups were made
  std::vector<IndexPair> outer_;
  DynArray<std::size_t> outer_begin_;  // first outer pair of each group
  DynArray<Chunk> chunks_;
  DynArray<std::uint16_t> group_;  // of the pairs found last
  DynArray<std::uint32_t> kept_;
  DynArray<Group> inner_group_;
  std::size_t size_ = 0;  // number of pairs without padding
  AlignedVector<std::uint32_t> first_, second_;
  DynArray<std::uint32_t> origin_, old_origin_;  // place in the outer list
  History history_, old_history_;
  PairArchive<H, Scalar> archive_;
};

}  // namespace silt::detail

#include <silt/engine/lists/pair_list_edits.hpp>
