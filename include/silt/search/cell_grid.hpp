// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <numeric>
#include <utility>

#include <silt/core/box.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Writes {a, b[lane]} for every lane whose bit is set; returns where the next one goes. There must
/// be room for `Width` pairs, and as many b, whatever the bits.
template <std::size_t Width>
SILT_INLINE IndexPair* put_pairs(std::uint32_t a, const std::uint32_t* b, std::uint64_t bits,
                                 IndexPair* out) {
#if defined(__AVX512F__)
  if constexpr (Width == 8) {  // without a branch on the bits, which nothing could predict
    const __m512i second = _mm512_slli_epi64(
        _mm512_cvtepu32_epi64(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(b))), 32);
    const __m512i pairs = _mm512_or_si512(second, _mm512_set1_epi64(a));
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi64(static_cast<__mmask8>(bits), pairs));
    return out + std::popcount(bits);
  }
#endif
  for (; bits != 0; bits &= bits - 1)
    *out++ = {a, b[static_cast<std::size_t>(std::countr_zero(bits))]};
  return out;
}

/// Pairs found, in room that grows before it is written to.
class PairBuffer {
 public:
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  const IndexPair* data() const { return room_.data(); }
  /// Gives the room back if it is large: a search is rare, its memory would lie idle.
  void give_back() {
    if (room_.size() > 100000) room_ = {}, size_ = 0;
  }
  /// Where `more` pairs can be written.
  IndexPair* room_for(std::size_t more) {
    if (size_ + more > room_.size()) room_.resize(2 * (size_ + more));
    return room_.data() + size_;
  }
  void take_up_to(const IndexPair* end) { size_ = static_cast<std::size_t>(end - room_.data()); }

 private:
  std::vector<IndexPair> room_;
  std::size_t size_ = 0;
};

}  // namespace detail

/// Spheres sorted into the cells of a regular grid over their bounding box; neighbours are looked
/// for in a sphere's own cell and those that follow it among the 26 around (half stencil).
///
/// The cell edge is the largest cutoff, 2 r_max + reach, grown so that there are at most 8 cells a
/// sphere: O(N) in time and memory for spheres of similar size; for wide size distributions and
/// nearly empty domains it stays right but slows down.
/// Source: M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, 2nd ed., section 5.3.
/// Shapes: none. Units: SI. Errors: none (the simulation checks positions).
/// Tests: tests/search/cell_grid.cpp (pair sets identical to BruteForce).
class CellGrid {
 public:
  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    sort_into_cells(spheres, reach, domain, team);
    order.assign(order_.begin(), order_.end() - most_lanes);
  }

  template <class Arch = DefaultArch, class Domain>
  void find_ordered(double reach, const Domain& domain, const Team& team,
                    std::vector<IndexPair>& pairs) {
    std::iota(order_.begin(), order_.end(), 0u);
    scan_all<Arch>(reach, domain, team, pairs);
  }

  template <class Arch = DefaultArch, class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    sort_into_cells(spheres, reach, domain, team);
    scan_all<Arch>(reach, domain, team, pairs);
  }

 private:
  template <class Arch, class Domain>
  void scan_all(double reach, const Domain& domain, const Team& team,
                std::vector<IndexPair>& pairs) {
    const std::size_t n = order_.size() - most_lanes;
    const std::size_t parts = team.threads() > 1 ? 8 * static_cast<std::size_t>(team.threads()) : 1;
    found_.resize(parts);
    team.for_parts(parts, [&](std::size_t part) {
      found_[part].clear();
      scan<Arch>(n * part / parts, n * (part + 1) / parts, reach, domain, found_[part]);
    });
    std::vector<std::size_t> begin(parts + 1, 0);
    for (std::size_t p = 0; p < parts; ++p) begin[p + 1] = begin[p] + found_[p].size();
    pairs.resize(begin[parts]);
    team.for_parts(parts, [&](std::size_t part) {
      std::copy_n(found_[part].data(), found_[part].size(), pairs.data() + begin[part]);
      found_[part].give_back();
    });
  }

  template <class Domain>
  void sort_into_cells(const SphereSet& spheres, double reach, const Domain& domain,
                       const Team& team) {
    const auto rows = spheres.rows;
    const std::size_t n = rows.size();
    std::array<Box, Team::most_ranges> bounds_of;
    team.for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
      Box b;
      for (std::size_t k = from; k < to; ++k) b.include(rows[k].centre());
      bounds_of[r] = b;
    });
    Box bounds;
    for (const auto& b : bounds_of) bounds.include(b);
    if constexpr (Domain::periodic) {
      double* const low[3] = {&bounds.min.x, &bounds.min.y, &bounds.min.z};
      double* const high[3] = {&bounds.max.x, &bounds.max.y, &bounds.max.z};
      const double from[3] = {domain.box().min.x, domain.box().min.y, domain.box().min.z};
      for (int d = 0; d < 3; ++d)
        if (domain.repeats(d)) *low[d] = from[d], *high[d] = from[d] + domain.length(d);
    }
    choose_cells(bounds, 2 * spheres.largest_radius + reach, n);
    for (int d = 0; d < 2; ++d) cut_into_columns(count_[d], columns_[d]);

    // Counting sort: every part counts its spheres in every cell, then places them behind those of
    // the parts before it. It is stable, so the order does not depend on the number of parts.
    const std::size_t parts = static_cast<std::size_t>(std::min(team.threads(), 8)), c = cells();
    cell_.resize(n), next_.assign(parts * c, 0), start_.resize(c + 1),
        order_.resize(n + most_lanes);
    team.for_parts(parts, [&](std::size_t part) {
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k)
        ++next_[part * c + (cell_[k] = number(cell_of(rows[k])))];
    });
    std::uint32_t place = 0;
    for (std::size_t k = 0; k < c; ++k) {
      start_[k] = place;
      for (std::size_t part = 0; part < parts; ++part)
        place += std::exchange(next_[part * c + k], place);
    }
    start_[c] = place;
    team.for_parts(parts, [&](std::size_t part) {
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k)
        order_[next_[part * c + cell_[k]]++] = static_cast<std::uint32_t>(k);
    });
    for (auto* component : {&x_, &y_, &z_, &r_}) component->resize(n + most_lanes, 0.0);
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const PositionRow& row = rows[order_[k]];
        x_[k] = row.x, y_[k] = row.y, z_[k] = row.z, r_[k] = row.r;
      }
    });
  }

  void choose_cells(const Box& bounds, double cutoff, std::size_t spheres) {
    low_ = bounds.min;
    count_ = {1, 1, 1}, per_length_ = {0, 0, 0};
    if (spheres == 0) return;  // there may be no cutoff either
    const Vec3d e = bounds.extent();
    const double length[3] = {e.x, e.y, e.z};
    const double most = 8.0 * static_cast<double>(spheres) + 64;
    // Wider by more than the rounding of a centre's place in the grid, so that no two spheres
    // within the cutoff are two cells apart.
    for (double edge = cutoff * (1 + 1e-9);; edge *= 1.26) {
      double total = 1;
      for (int d = 0; d < 3; ++d) total *= std::max(1.0, std::floor(length[d] / edge));
      if (!(total <= most)) continue;
      for (int d = 0; d < 3; ++d) {
        count_[d] = static_cast<std::size_t>(std::max(1.0, std::floor(length[d] / edge)));
        per_length_[d] = length[d] > 0 ? static_cast<double>(count_[d]) / length[d] : 0;
      }
      return;
    }
  }

  std::size_t cells() const { return count_[0] * count_[1] * count_[2]; }
  std::size_t along(double x, double low, int d) const {
    const double c = (x - low) * per_length_[d];
    return c <= 0 ? 0 : std::min(count_[d] - 1, static_cast<std::size_t>(c));
  }
  struct Cell {
    std::size_t x, y, z;
  };
  Cell cell_of(const PositionRow& p) const {
    return {along(p.x, low_.x, 0), along(p.y, low_.y, 1), along(p.z, low_.z, 2)};
  }
  /// The number of a cell: columns of about tile x tile cells one after the other, in a column
  /// layer by layer. Spheres of neighbouring layers are then so near in memory that they stay in
  /// the second-level cache from one layer to the next.
  std::uint32_t number(const Cell& c) const {
    const Span x = columns_[0][c.x], y = columns_[1][c.y];
    return static_cast<std::uint32_t>(count_[2] * (y.from * count_[0] + x.from * y.length) +
                                      x.length * (c.z * y.length + (c.y - y.from)) +
                                      (c.x - x.from));
  }
  struct Span {
    std::size_t from, length;
  };
  /// The columns that hold the places 0 ... n-1.
  static void cut_into_columns(std::size_t n, std::vector<Span>& of) {
    const std::size_t columns = std::max<std::size_t>((n + tile / 2) / tile, 1);
    of.clear();
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t from = c * n / columns, to = (c + 1) * n / columns;
      of.insert(of.end(), to - from, {from, to - from});
    }
  }

  struct Range {
    std::size_t begin, end;
  };

  /// The parts of `order_` after a cell that its spheres must look at; returns how many.
  template <class Domain>
  int ranges_after(const Cell& cell, const Domain& domain, std::array<Range, 26>& out) const {
    const std::size_t c = number(cell);
    std::array<std::size_t, 3> xs, ys, zs;
    const int nx = around(cell.x, 0, domain, xs), ny = around(cell.y, 1, domain, ys),
              nz = around(cell.z, 2, domain, zs);
    int found = 0;
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const std::size_t other = number({xs[i], ys[j], zs[k]});
          if (other <= c || start_[other] == start_[other + 1]) continue;
          if (found > 0 && out[found - 1].end == start_[other])
            out[found - 1].end = start_[other + 1];
          else
            out[found++] = {start_[other], start_[other + 1]};
        }
    return found;
  }
  /// The cells before, at and after k in direction d, each once; returns how many.
  template <class Domain>
  int around(std::size_t k, int d, const Domain& domain, std::array<std::size_t, 3>& out) const {
    const std::size_t n = count_[d];
    bool wraps = false;
    if constexpr (Domain::periodic) wraps = domain.repeats(d);
    int found = 0;
    for (std::size_t step = 0; step < 3; ++step) {
      const bool outside = (k == 0 && step == 0) || (k + 1 == n && step == 2);
      if (outside && (!wraps || n < 3)) continue;
      out[found++] = (k + n + step - 1) % n;
    }
    return found;
  }

  template <class Arch, class Domain>
  void scan(std::size_t from, std::size_t to, double reach, const Domain& domain,
            detail::PairBuffer& found) const {
    std::array<Range, 26> ranges{};
    int count = 0;
    std::size_t own_end = 0;
    for (std::size_t p = from; p < to; ++p) {
      if (p >= own_end) {  // the first sphere of a cell, or the first at all
        const Cell cell = cell_of({x_[p], y_[p], z_[p], r_[p]});
        own_end = start_[number(cell) + 1];
        count = ranges_after(cell, domain, ranges);
      }
      scan_range<Arch>(p, {p + 1, own_end}, reach, domain, found);
      for (int k = 0; k < count; ++k) scan_range<Arch>(p, ranges[k], reach, domain, found);
    }
  }
  /// Looks at as many spheres at a time as there are lanes.
  template <class Arch, class Domain>
  void scan_range(std::size_t p, Range range, double reach, const Domain& domain,
                  detail::PairBuffer& found) const {
    using Real = typename Lanes<Arch>::Real;
    constexpr std::size_t W = Lanes<Arch>::width;
    const double *const xs = x_.data(), *const ys = y_.data(), *const zs = z_.data(),
                        *const rs = r_.data();
    const std::uint32_t* const names = order_.data();
    const std::uint32_t name = names[p];
    const Real x(xs[p]), y(ys[p]), z(zs[p]), own(rs[p]), further(reach);
    IndexPair* next = found.room_for(range.end - range.begin + W);
    for (std::size_t q = range.begin; q < range.end; q += W) {
      Vec3<Real> d{x - load_any<Real>(xs + q), y - load_any<Real>(ys + q),
                   z - load_any<Real>(zs + q)};
      if constexpr (Domain::periodic) d = domain.shortest(d);
      const Real cutoff = own + load_any<Real>(rs + q) + further;
      const std::uint64_t inside = ~std::uint64_t{0} >> (64 - std::min(W, range.end - q));
      next = detail::put_pairs<W>(name, names + q, lane_bits(dot(d, d) < cutoff * cutoff) & inside,
                                  next);
    }
    found.take_up_to(next);
  }

  static constexpr std::size_t tile = 12;       // cells
  static constexpr std::size_t most_lanes = 8;  // the arrays of spheres go on by as many

  Vec3d low_{};                                // [m]
  std::array<std::size_t, 3> count_{1, 1, 1};  // cells in each direction
  std::array<double, 3> per_length_{};         // [1/m]
  std::array<std::vector<Span>, 2> columns_;   // of each x and y
  std::vector<std::uint32_t> cell_, order_, next_;
  std::vector<std::uint32_t> start_;       // first sphere of each cell, in `order_`
  std::vector<double> x_, y_, z_, r_;      // [m] of the spheres in `order_`
  std::vector<detail::PairBuffer> found_;  // by part
};

static_assert(NeighbourSearch<CellGrid>);

}  // namespace silt
