// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Carries the H history values of pairs from one list to the next, which a search creates anew.
/// They are stored in rows by the place of the pair's first particle.
template <std::size_t H, class Scalar>
class PairArchive {
 public:
  /// Stores the history of all touching pairs of a list with this number of particles.
  template <class List, class History>
  void keep(const List& list, const History& history, std::size_t particles, const Team& team) {
    if constexpr (H > 0) {
      end_.assign(particles, 0);
      list.for_each_inner(team,
                          [&](std::size_t k) { end_[list.first()[k]] += history.remembers(k); });
      std::uint32_t place = 0;
      for (auto& row : end_) place += std::exchange(row, place);
      make_room(kept_, place);
      list.for_each_inner(team, [&](std::size_t k) {
        if (history.remembers(k))
          kept_[end_[list.first()[k]]++] = {list.second()[k], history.values(k)};
      });
    }
  }
  /// History of a pair that was not in a list on this rank, by the previous places of its
  /// particles.
  struct Brought {
    std::uint32_t a, b;
    std::array<Scalar, H> history;
  };
  void add(std::span<const Brought> more) {
    if constexpr (H > 0) {
      if (more.empty()) return;
      DynArray<std::uint32_t> begin(end_.size() + 1, 0);
      for (std::size_t a = 0; a < end_.size(); ++a)
        begin[a + 1] = end_[a] - (a == 0 ? 0 : end_[a - 1]);
      for (const Brought& m : more) ++begin[m.a + 1];
      std::partial_sum(begin.begin(), begin.end(), begin.begin());
      DynArray<Kept> all(begin.back());
      for (std::size_t a = 0; a < end_.size(); ++a)
        for (std::uint32_t s = a == 0 ? 0 : end_[a - 1]; s < end_[a]; ++s)
          all[begin[a]++] = kept_[s];
      for (const Brought& m : more) all[begin[m.a]++] = {m.b, m.history};
      kept_.swap(all);
      end_.assign(begin.begin(), begin.end() - 1);
    }
  }
  /// Gives place k of a new list the history of the particles at places a and b of the old one.
  template <class History>
  void recall(History& history, std::size_t k, std::uint32_t a, std::uint32_t b) const {
    history.clear(k);
    for (std::uint32_t s = a == 0 ? 0 : end_[a - 1]; s < end_[a]; ++s)
      if (kept_[s].partner == b) history.set(k, kept_[s].history);
  }

 private:
  struct Kept {
    std::uint32_t partner;
    std::array<Scalar, H> history;
  };
  DynArray<std::uint32_t> end_;  // of each row
  DynArray<Kept> kept_;
};

}  // namespace silt::detail
