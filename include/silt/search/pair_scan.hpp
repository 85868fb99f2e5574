// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/core/compress.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Buffer of pairs that is enlarged before it is written to.
class PairBuffer {
 public:
  PairBuffer() = default;
  PairBuffer(const PairBuffer&) noexcept
      : PairBuffer() {}  // a copy begins empty, with its own memory
  PairBuffer& operator=(const PairBuffer& other) {
    if (this != &other) take({});
    return *this;
  }

  void clear() { next_ = room_.data(); }
  std::size_t size() const { return static_cast<std::size_t>(next_ - room_.data()); }
  const IndexPair* data() const { return room_.data(); }
  /// Frees the memory if it is large: searches are rare.
  void give_back() {
    if (room_.size() > 100000) take({});
  }
  /// Space for `more` pairs.
  SILT_INLINE IndexPair* room_for(std::size_t more) {
    if (static_cast<std::size_t>(end_ - next_) < more) grow(more);
    return next_;
  }
  SILT_INLINE void take_up_to(IndexPair* end) { next_ = end; }
  void put(const IndexPair& pair) { *room_for(1) = pair, ++next_; }
  /// Moves the pairs to `pairs` and takes its memory in exchange.
  void hand_over(std::vector<IndexPair>& pairs) {
    room_.resize(size()), room_.swap(pairs);
    room_.resize(room_.capacity());
    next_ = room_.data(), end_ = next_ + room_.size();
  }

 private:
  void grow(std::size_t more) {
    const std::size_t has = size();
    room_.resize(2 * (has + more));
    next_ = room_.data() + has, end_ = room_.data() + room_.size();
  }
  void take(std::vector<IndexPair> room) {
    room_ = std::move(room);
    next_ = room_.data(), end_ = next_ + room_.size();
  }

  std::vector<IndexPair> room_;
  IndexPair *next_ = nullptr, *end_ = nullptr;
};

/// Spheres in the order of a grid, component by component.
struct SphereColumns {
  static constexpr std::size_t padding = 8;  // the widest pack of lanes; columns are padded by as
                                             // many

  DynArray<double> x, y, z, r;   // [m]
  DynArray<std::uint32_t> name;  // position in the rows that were given

  std::size_t size() const { return name.size() - padding; }
  void resize(std::size_t n) {
    for (auto* component : {&x, &y, &z, &r}) component->resize(n + padding, 0.0);
    name.resize(n + padding);
  }
  /// Fills the components of all spheres from the rows with their names.
  void take(std::span<const PositionRow> rows, const Team& team) {
    team.for_ranges(size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const PositionRow& row = rows[name[k]];
        x[k] = row.x, y[k] = row.y, z[k] = row.z, r[k] = row.r;
      }
    });
  }
};

/// Consecutive spheres of columns.
struct SphereRange {
  std::size_t begin, end;
};

/// Images of a sphere along x that are tested in a periodic box.
enum class Images { Any, Direct, AcrossFaces };

/// Searches for the partners of one sphere in columns, as many at a time as there are lanes.
template <class Arch, class Domain>
class PartnerScan {
  using Real = typename Lanes<Arch>::Real;

 public:
  static constexpr std::size_t width = Lanes<Arch>::width;

  SILT_INLINE PartnerScan(const SphereColumns& of, std::size_t p, double reach,
                          const Domain& domain)
      : x_(of.x.data()),
        y_(of.y.data()),
        z_(of.z.data()),
        r_(of.r.data()),
        names_(of.name.data()),
        domain_(domain),
        centre_{Real(x_[p]), Real(y_[p]), Real(z_[p])},
        radius_(r_[p]),
        reach_(reach),
        name_(names_[p]) {}

  /// Writes the pairs with spheres of `range` within the reach; returns the end of the output,
  /// which must have space for the length of the range plus `width`.
  SILT_INLINE IndexPair* operator()(SphereRange range, IndexPair* out) const {
    for (std::size_t q = range.begin; q < range.end; q += width)
      out = look(q, range.end, load_any<Real>(x_ + q), out);
    return out;
  }

  /// The same for the spheres from `low` on, whose x ascend approximately: no x may be smaller than
  /// an earlier one by more than x_begin and x_end [m] allow for. Tests all that are not before
  /// x_begin or beyond x_end, and moves `low` past those before.
  template <Images Which = Images::Any>
  SILT_INLINE void sweep(std::size_t& low, std::size_t end, double x_begin, double x_end,
                         PairBuffer& found) const {
    const Real begin(x_begin);
    bool all_before = true;  // so far
    for (std::size_t q = low; q < end; q += width) {
      const Real x = load_any<Real>(x_ + q);
      found.take_up_to(look<Which>(q, end, x, found.room_for(width)));
      if (all_before) {
        const int before = std::countr_one(lane_bits(x < begin) & inside(q, end));
        low += static_cast<std::size_t>(before);
        all_before = before == static_cast<int>(width);
      }
      if (q + width >= end || x_[q + width - 1] > x_end) return;
    }
  }

 private:
  static SILT_INLINE std::uint64_t inside(std::size_t q, std::size_t end) {
    return ~std::uint64_t{0} >> (64 - std::min(width, end - q));
  }
  template <Images Which = Images::Any>
  SILT_INLINE IndexPair* look(std::size_t q, std::size_t end, const Real& x, IndexPair* out) const {
    Vec3<Real> d{centre_.x - x, centre_.y - load_any<Real>(y_ + q),
                 centre_.z - load_any<Real>(z_ + q)};
    std::uint64_t wanted = inside(q, end);
    if constexpr (Domain::periodic) {
      const Real direct = d.x;
      d = domain_.shortest(d);
      if constexpr (Which == Images::Direct) wanted &= lane_bits(d.x == direct);
      if constexpr (Which == Images::AcrossFaces) wanted &= ~lane_bits(d.x == direct);
    }
    const Real cutoff = radius_ + load_any<Real>(r_ + q) + reach_;
    const std::uint64_t near = lane_bits(dot(d, d) < cutoff * cutoff) & wanted;
    return put_pairs<width>(name_, names_ + q, near, out);
  }

  const double *x_, *y_, *z_, *r_;
  const std::uint32_t* names_;
  const Domain& domain_;
  Vec3<Real> centre_;
  Real radius_, reach_;
  std::uint32_t name_;
};

/// Pairs found in parts, each with its own buffer, and concatenated.
class FoundInParts {
 public:
  /// Calls find(part, parts, buffer) for each part and fills `pairs` with the results. The number
  /// of parts depends on the threads; the pairs in sequence must not.
  template <class Find>
  void operator()(const Team& team, std::vector<IndexPair>& pairs, const Find& find) {
    const std::size_t parts = team.threads() > 1 ? 8 * static_cast<std::size_t>(team.threads()) : 1;
    found_.resize(parts);
    team.for_parts(parts, [&](std::size_t part) {
      found_[part].clear();
      find(part, parts, found_[part]);
    });
    if (parts == 1) return found_[0].hand_over(pairs);
    DynArray<std::size_t> begin(parts + 1, 0);
    for (std::size_t p = 0; p < parts; ++p) begin[p + 1] = begin[p] + found_[p].size();
    pairs.resize(begin[parts]);
    team.for_parts(parts, [&](std::size_t part) {
      std::copy_n(found_[part].data(), found_[part].size(), pairs.data() + begin[part]);
      found_[part].give_back();
    });
  }

 private:
  DynArray<PairBuffer> found_;
};

}  // namespace silt::detail
