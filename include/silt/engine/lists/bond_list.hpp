// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/members.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/pair_groups.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// A bond between the particles i and j, i < j.
template <class Model>
struct Bond {
  ParticleId i, j;
  BondRest<double> rest;
  typename Model::template Numbers<double> numbers;
  std::uint64_t number;  // [-] how many bonds were made before it
};

/// Aggregates of doubles for many bonds, stored pack by pack, so that SIMD lanes load contiguous
/// values; the storage type is `Stored`.
template <template <class> class Aggregate, class Stored, std::size_t W>
class BondColumns {
  static constexpr std::size_t count = sizeof(Aggregate<double>) / sizeof(double);

 public:
  /// Sets all values to 0.
  void clear(std::size_t packs) { packs_.assign(packs * count * W, Stored(0)); }
  void set(std::size_t k, const Aggregate<double>& values) {
    const auto numbers = std::bit_cast<std::array<double, count>>(values);
    for (std::size_t c = 0; c < count; ++c) packs_[at(k, c)] = static_cast<Stored>(numbers[c]);
  }
  Aggregate<double> get(std::size_t k) const {
    std::array<double, count> numbers;
    for (std::size_t c = 0; c < count; ++c) numbers[c] = packs_[at(k, c)];
    return std::bit_cast<Aggregate<double>>(numbers);
  }
  /// The values of the pack that begins at place k.
  template <class Real>
  SILT_INLINE Aggregate<Real> load(std::size_t k) const {
    return members_of<Aggregate<Real>, Real>(
        [from = packs_.data() + k * count](auto c) { return load_wide<Real>(from + c * W); });
  }
  /// Prefetches the pack that begins at place k.
  SILT_INLINE void fetch(std::size_t k) const {
    const auto* const from = reinterpret_cast<const std::byte*>(packs_.data() + k * count);
    for (std::size_t at = 0; at < count * W * sizeof(Stored); at += 64)
      __builtin_prefetch(from + at);
  }
  std::size_t bytes() const { return packs_.capacity() * sizeof(Stored); }

 private:
  static std::size_t at(std::size_t k, std::size_t c) { return (k / W * count + c) * W + k % W; }
  AlignedVector<Stored> packs_;
};

/// The values of a bond that are stored in single precision, the precision of its stiffness and
/// strength.
template <class Real>
struct BondShape {
  Real share, per_length;  // of BondRest
};

/// Stored data of bonds by place: their rest configuration and the numbers of their model. Rest
/// rotations of ends bonded at a different orientation take memory only if there are any; spheres
/// bonded as they were created have none.
template <class Model, std::size_t W>
class BondColumnsOf {
 public:
  using Numbers = typename Model::template Numbers<double>;

  void clear(std::size_t packs, bool turned) {
    apart_.clear(packs), shape_.clear(packs), numbers_.clear(packs);
    turned_ = turned, turn_.clear(turned ? packs : 0);
  }
  void set(std::size_t k, const BondRest<double>& rest, const Numbers& numbers) {
    apart_.set(k, rest.apart), shape_.set(k, {rest.share, rest.per_length});
    numbers_.set(k, numbers);
    if (turned_) turn_.set(k, rest.turn);
  }
  BondRest<double> rest(std::size_t k) const {
    const auto [share, per_length] = shape_.get(k);
    return {apart_.get(k), share, turned_ ? turn_.get(k) : Quaternion{}, per_length};
  }
  Numbers numbers(std::size_t k) const { return numbers_.get(k); }
  /// The strain of the pack that begins at place k.
  template <class Real>
  SILT_INLINE BondStrain<Real> strain(std::size_t k, const BondedEnds<Real>& ends) const {
    const auto [share, per_length] = shape_.template load<Real>(k);
    const BondRest<Real> rest{apart_.template load<Real>(k), share, {}, per_length};
    BasicQuaternion<Real> like_i = ends.orientation_i;
    if (turned_) like_i = like_i * conjugate(turn_.template load<Real>(k));
    return strain_of(rest, ends, like_i);
  }
  template <class Real>
  SILT_INLINE auto load_numbers(std::size_t k) const {
    return numbers_.template load<Real>(k);
  }
  SILT_INLINE void fetch(std::size_t k) const {
    apart_.fetch(k), shape_.fetch(k), numbers_.fetch(k);
    if (turned_) turn_.fetch(k);
  }
  std::size_t bytes() const {
    return apart_.bytes() + shape_.bytes() + numbers_.bytes() + turn_.bytes();
  }

 private:
  BondColumns<Vec3, double, W> apart_;
  BondColumns<BondShape, float, W> shape_;
  BondColumns<Model::template Numbers, float, W> numbers_;
  BondColumns<BasicQuaternion, double, W> turn_;
  bool turned_ = false;
};

/// The bonds of a simulation in the order in which their stage processes them: by the groups that
/// threads work on (PairGroups), and within a group by the rows of their ends. Groups begin at
/// whole packs; gaps are filled with inert bonds between two dummy particles, all numbers 0.
template <class Model, std::size_t W>
class BondList {
 public:
  using Bond = detail::Bond<Model>;
  static constexpr std::size_t ahead = 64;  // places behind the last one, for loops that prefetch
  struct Group {
    std::size_t from = 0, to = 0;  // places
    std::size_t size() const { return to - from; }
  };

  std::size_t size() const { return size_; }
  /// A bond in storage precision, without its place.
  static Bond as_kept(Bond b) {
    const auto single = [](const auto& values) {
      using Numbers = std::remove_cvref_t<decltype(values)>;
      auto numbers = std::bit_cast<std::array<double, sizeof(Numbers) / sizeof(double)>>(values);
      for (double& x : numbers) x = static_cast<double>(static_cast<float>(x));
      return std::bit_cast<Numbers>(numbers);
    };
    b.numbers = single(b.numbers);
    b.rest.share = static_cast<double>(static_cast<float>(b.rest.share));
    b.rest.per_length = static_cast<double>(static_cast<float>(b.rest.per_length));
    return b;
  }
  void add(const Bond& bond) {
    waiting_.push_back(bond), ++size_;
    any_turned_ = any_turned_ || bond.rest.turn != Quaternion{};
  }
  /// Removes the bond at a place.
  void remove(std::size_t place) { ids_[place] = nobody, --size_, is_stale_ = true; }
  /// Removes the bonds for which goes(bond) is true.
  template <class Goes>
  void remove_if(const Goes& goes) {
    for_each([&](std::size_t k) {
      if (goes(bond(k))) remove(k);
    });
    size_ -= erase_if(waiting_, goes);
  }

  const PairGroups& groups() const { return groups_; }
  const Group& group(std::size_t g) const { return group_[g]; }
  PairGroups::Phase busy(PairGroups::Phase phase) const {
    while (phase.from < phase.to && group_[phase.from].size() == 0) ++phase.from;
    while (phase.from < phase.to && group_[phase.to - 1].size() == 0) --phase.to;
    return phase;
  }
  const std::uint32_t* first() const { return first_.data(); }
  const std::uint32_t* second() const { return second_.data(); }
  /// Prefetches the pack that begins at place k, and the ends of bonds twice as far ahead.
  SILT_INLINE void fetch(std::size_t k) const {
    columns_.fetch(k);
    __builtin_prefetch(first_.data() + k + ahead);
    __builtin_prefetch(second_.data() + k + ahead);
  }
  const BondColumnsOf<Model, W>& columns() const { return columns_; }
  Bond bond(std::size_t k) const {
    return {ids_[k].i, ids_[k].j, columns_.rest(k), columns_.numbers(k), ids_[k].number};
  }
  /// Calls visit(place) for each bond, in the order of the list.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Group& g : group_)
      for (std::size_t k = g.from; k < g.to; ++k)
        if (ids_[k].i != no_particle) visit(k);
  }

  /// Calls visit(bond) for each bond, including those added since the last sorting, in no order.
  template <class Visit>
  void for_each_bond(const Visit& visit) const {
    for_each([&](std::size_t k) { visit(bond(k)); });
    for (const Bond& b : waiting_) visit(b);
  }
  /// Calls visit(bond) for each, in order of creation.
  template <class Visit>
  void for_each_in_order(const Visit& visit) const {
    DynArray<Bond> all;
    all.reserve(size_);
    for_each([&](std::size_t k) { all.push_back(bond(k)); });
    std::sort(all.begin(), all.end(),
              [](const Bond& a, const Bond& b) { return a.number < b.number; });
    for (const Bond& b : all) visit(b);
    for (const Bond& b : waiting_) visit(b);
  }
  /// Sorts the bonds after rows were renumbered, or bonds were added or removed. `find(id)`: the
  /// row of a particle, or a number of at least `rows` if it has left; `left`: how many particles
  /// have left since the last change of rows. Bonds of particles that left are removed; gone(bond)
  /// is called for each. Bonds between two ghosts (rows from `owned` on) are removed as well.
  template <class Find, class Gone>
  void follow(std::size_t rows, std::size_t owned, std::uint64_t changes, std::size_t left,
              const Find& find, const Gone& gone) {
    if (waiting_.empty() && !is_stale_ && changes_ == changes && rows_ == rows && left_ == left)
      return;
    groups_ = PairGroups(owned, rows - owned);
    DynArray<Place> order;
    order.reserve(size_);
    const std::size_t places = ids_.size();
    const auto take = [&](const Bond& b, std::size_t source) {
      const std::uint32_t i = find(b.i), j = find(b.j);
      if (i < rows && j < rows && std::min(i, j) < owned)
        order.push_back({static_cast<std::uint32_t>(groups_.of(i, j)), i, j,
                         static_cast<std::uint32_t>(source)});
      else
        gone(b);
    };
    for_each([&](std::size_t k) { take(bond(k), k); });
    for (std::size_t k = 0; k < waiting_.size(); ++k) take(waiting_[k], places + k);
    size_ = order.size(), is_stale_ = false, changes_ = changes, rows_ = rows, left_ = left;
    lay_out(order);
  }
  std::size_t bytes() const {
    return columns_.bytes() + ids_.capacity() * sizeof(Ids) +
           (first_.capacity() + second_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  struct Ids {
    ParticleId i, j;
    std::uint64_t number;
  };
  static constexpr Ids nobody{no_particle, no_particle, 0};

  /// Source of a bond: a place of the list or, behind those, of the waiting bonds; and the rows of
  /// its ends.
  struct Place {
    std::uint32_t group, first, second, source;
  };
  /// Lays the bonds out in the order of `order`, which is sorted here.
  void lay_out(DynArray<Place>& order) {
    std::sort(order.begin(), order.end(), [](const Place& a, const Place& b) {
      return std::tie(a.group, a.first, a.second) < std::tie(b.group, b.first, b.second);
    });
    DynArray<std::size_t> count(groups_.count(), 0);
    for (const Place& p : order) ++count[p.group];
    group_.resize(groups_.count());
    std::size_t next = 0;
    for (std::size_t g = 0; g < group_.size(); ++g) {
      group_[g] = {next, next + count[g]};
      next = pieces(group_[g].to, W) * W;
    }
    const std::size_t places = ids_.size();
    BondColumnsOf<Model, W> columns;
    DynArray<Ids> ids(next, nobody);
    columns.clear(next / W, any_turned_);
    const auto none = static_cast<std::uint32_t>(rows_);
    first_.assign(next + ahead, none), second_.assign(next + ahead, none + 1);
    std::size_t at = 0;
    for (const Group& g : group_)
      for (std::size_t k = g.from; k < g.to; ++k) {
        const Place& p = order[at++];
        const Bond b = p.source < places ? bond(p.source) : waiting_[p.source - places];
        ids[k] = {b.i, b.j, b.number}, first_[k] = p.first, second_[k] = p.second;
        columns.set(k, b.rest, b.numbers);
      }
    columns_ = std::move(columns), ids_ = std::move(ids);
    waiting_ = {};
  }

  PairGroups groups_;
  DynArray<Group> group_;
  std::deque<Bond> waiting_;  // added since the last sorting
  DynArray<Ids> ids_;
  DynArray<std::uint32_t> first_, second_;  // rows of the ends
  BondColumnsOf<Model, W> columns_;
  std::size_t size_ = 0, rows_ = 0, left_ = 0;
  std::uint64_t changes_ = 0;
  bool is_stale_ = true, any_turned_ = false;
};

}  // namespace detail
}  // namespace silt
