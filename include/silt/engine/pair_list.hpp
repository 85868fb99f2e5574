// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>

namespace silt::detail {

/// Particle index that means "was not there before".
inline constexpr std::uint32_t no_particle = std::numeric_limits<std::uint32_t>::max();

/// The pairs of a simulation in two stages, with H Reals of contact history for each pair.
///
/// Outer list: all pairs nearer than the skin at the last search. Inner list: those of them nearer
/// than the inner skin at the last pruning; only these are computed. Pruning keeps the order of the
/// outer list, so that history is carried along by a merge of two ascending sequences, in one
/// linear pass. In a pair, `a` is the particle with the lower id, so that history never changes its
/// sign. The inner list is padded to whole packs with pairs of two spheres of no radius (indices n,
/// n+1).
template <std::size_t H>
class PairList {
 public:
  static constexpr std::size_t padding = 8;  // the widest pack of lanes

  std::size_t outer_size() const { return outer_.size(); }
  std::size_t size() const { return size_; }
  std::size_t padded_size() const { return first_.size(); }
  const std::uint32_t* first() const { return first_.data(); }
  const std::uint32_t* second() const { return second_.data(); }
  double* history(std::size_t component) { return history_[component].data(); }
  const double* history(std::size_t component) const { return history_[component].data(); }

  /// Takes over newly found pairs; those of two fixed particles are left out. `previous[k]` is the
  /// place that particle k had when the old list was current.
  template <class Motion>
  void set_outer(std::vector<IndexPair>& found, std::span<const std::uint32_t> ids,
                 const Motion* motion, std::span<const std::uint32_t> previous) {
    archive(previous);
    outer_.clear();
    for (const auto [a, b] : found) {
      if (motion[a].inv_m == 0 && motion[b].inv_m == 0) continue;
      outer_.push_back(ids[a] < ids[b] ? IndexPair{a, b} : IndexPair{b, a});
    }
    first_.clear(), second_.clear(), origin_.clear();
    size_ = 0;
    for (auto& h : history_) h.clear();
  }

  /// Makes the inner list of all outer pairs nearer than `reach` [m]. `previous` as in set_outer if
  /// this is the first pruning after it, else empty.
  template <class Domain>
  void prune(const PositionRow* rows, std::size_t particles, double reach, const Domain& domain,
             std::span<const std::uint32_t> previous, const Team& team) {
    const std::size_t chunks = pieces(outer_.size(), chunk);
    kept_.resize(outer_.size());
    begin_.assign(chunks + 1, 0);
    team.for_parts(chunks,
                   [&](std::size_t c) { begin_[c + 1] = keep_near(c, rows, reach, domain); });
    for (std::size_t c = 0; c < chunks; ++c) begin_[c + 1] += begin_[c];

    old_first_.swap(first_), old_second_.swap(second_), old_origin_.swap(origin_);
    old_history_.swap(history_);
    const std::size_t old_size = size_;
    resize(begin_[chunks], particles);
    team.for_parts(chunks, [&](std::size_t c) { fill(c, old_size, previous); });
  }

  /// Calls visit(a, b, history values) for every pair in the inner list.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t k = 0; k < size_; ++k) visit(first_[k], second_[k], values(k));
  }

  /// Restores the lists from a checkpoint.
  void restore(std::vector<IndexPair> outer, std::vector<std::uint32_t> origin,
               const std::array<std::vector<double>, H>& history, std::size_t particles) {
    outer_ = std::move(outer);
    resize(origin.size(), particles);
    for (std::size_t k = 0; k < origin.size(); ++k) {
      origin_[k] = origin[k];
      first_[k] = outer_[origin[k]].a, second_[k] = outer_[origin[k]].b;
      for (std::size_t c = 0; c < H; ++c) history_[c][k] = history[c][k];
    }
  }
  std::span<const IndexPair> outer() const { return outer_; }
  std::span<const std::uint32_t> origin() const { return {origin_.data(), size_}; }

  std::size_t bytes() const {
    return outer_.capacity() * sizeof(IndexPair) + kept_.capacity() * 4 +
           (first_.capacity() + old_first_.capacity()) * (3 * 4 + H * sizeof(double));
  }

 private:
  static constexpr std::size_t chunk = 4096;  // outer pairs that one thread prunes at a time

  std::array<double, H> values(std::size_t k) const {
    std::array<double, H> v{};
    for (std::size_t c = 0; c < H; ++c) v[c] = history_[c][k];
    return v;
  }

  void resize(std::size_t size, std::size_t particles) {
    size_ = size;
    const std::size_t padded = pieces(size, padding) * padding;
    first_.resize(padded), second_.resize(padded), origin_.resize(padded);
    for (auto& h : history_) h.resize(padded);
    for (std::size_t k = size; k < padded; ++k) {
      first_[k] = static_cast<std::uint32_t>(particles);
      second_[k] = static_cast<std::uint32_t>(particles + 1);
      for (auto& h : history_) h[k] = 0;
    }
  }

  /// Writes the outer pairs of chunk c that are near into kept_; returns how many.
  template <class Domain>
  std::size_t keep_near(std::size_t c, const PositionRow* rows, double reach,
                        const Domain& domain) {
    const std::size_t from = c * chunk, to = std::min(outer_.size(), from + chunk);
    std::size_t kept = 0;
    for (std::size_t k = from; k < to; ++k) {
      kept_[from + kept] = static_cast<std::uint32_t>(k);
      kept += within_reach(rows[outer_[k].a], rows[outer_[k].b], reach, domain);
    }
    return kept;
  }

  /// Fills the part of the inner list that comes from outer chunk c, history included.
  void fill(std::size_t c, std::size_t old_size, std::span<const std::uint32_t> previous) {
    std::size_t old = static_cast<std::size_t>(
        std::lower_bound(old_origin_.begin(),
                         old_origin_.begin() + static_cast<std::ptrdiff_t>(old_size), c * chunk) -
        old_origin_.begin());
    for (std::size_t k = begin_[c], from = c * chunk; k < begin_[c + 1]; ++k, ++from) {
      const std::uint32_t outer = kept_[from];
      origin_[k] = outer;
      first_[k] = outer_[outer].a, second_[k] = outer_[outer].b;
      if constexpr (H > 0) {
        if (!previous.empty()) {
          recall(k, previous[first_[k]], previous[second_[k]]);
          continue;
        }
        while (old < old_size && old_origin_[old] < outer) ++old;
        const bool carried = old < old_size && old_origin_[old] == outer;
        for (std::size_t h = 0; h < H; ++h) history_[h][k] = carried ? old_history_[h][old] : 0.0;
      }
    }
  }

  struct Archived {
    std::uint32_t partner;
    std::array<double, H> history;
  };

  /// Sets aside the history of all touching pairs, in rows by the old place of the first particle.
  void archive(std::span<const std::uint32_t> previous) {
    if constexpr (H > 0) {
      std::size_t rows = 0;
      for (std::size_t k = 0; k < size_; ++k)
        rows = std::max<std::size_t>(rows, std::size_t{first_[k]} + 1);
      for (const auto p : previous)
        if (p != no_particle) rows = std::max<std::size_t>(rows, std::size_t{p} + 1);
      archive_begin_.assign(rows + 1, 0);
      for (std::size_t k = 0; k < size_; ++k)
        if (remembers(k)) ++archive_begin_[first_[k] + 1];
      for (std::size_t r = 0; r < rows; ++r) archive_begin_[r + 1] += archive_begin_[r];
      archive_.resize(archive_begin_[rows]);
      std::vector<std::uint32_t> next(archive_begin_.begin(), archive_begin_.end() - 1);
      for (std::size_t k = 0; k < size_; ++k)
        if (remembers(k)) archive_[next[first_[k]]++] = {second_[k], values(k)};
    }
  }
  bool remembers(std::size_t k) const {
    for (const auto& h : history_)
      if (h[k] != 0) return true;
    return false;
  }
  void recall(std::size_t k, std::uint32_t a, std::uint32_t b) {
    for (auto& h : history_) h[k] = 0;
    if (a == no_particle || b == no_particle) return;
    for (std::uint32_t s = archive_begin_[a]; s < archive_begin_[a + 1]; ++s)
      if (archive_[s].partner == b)
        for (std::size_t h = 0; h < H; ++h) history_[h][k] = archive_[s].history[h];
  }

  std::vector<IndexPair> outer_;
  std::vector<std::uint32_t> kept_;
  std::vector<std::size_t> begin_;  // inner pairs before each chunk
  std::size_t size_ = 0;
  AlignedVector<std::uint32_t> first_, second_, old_first_, old_second_;
  std::vector<std::uint32_t> origin_, old_origin_;  // place in the outer list
  std::array<AlignedVector<double>, H> history_, old_history_;
  std::vector<std::uint32_t> archive_begin_;
  std::vector<Archived> archive_;
};

}  // namespace silt::detail
