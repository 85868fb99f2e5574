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

namespace silt {

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
    order = order_;
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
    const std::size_t n = order_.size();
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
      std::copy(found_[part].begin(), found_[part].end(), pairs.data() + begin[part]);
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

    // Counting sort: every part counts its spheres in every cell, then places them behind those of
    // the parts before it. It is stable, so the order does not depend on the number of parts.
    const std::size_t parts = static_cast<std::size_t>(std::min(team.threads(), 8)), c = cells();
    cell_.resize(n), next_.assign(parts * c, 0), start_.resize(c + 1), order_.resize(n);
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
    for (auto* component : {&x_, &y_, &z_, &r_}) component->resize(n + 8, 0.0);
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
    const Span x = column(c.x, count_[0]), y = column(c.y, count_[1]);
    return static_cast<std::uint32_t>(count_[2] * (y.from * count_[0] + x.from * y.length) +
                                      x.length * (c.z * y.length + (c.y - y.from)) +
                                      (c.x - x.from));
  }
  struct Span {
    std::size_t from, length;
  };
  /// The column that holds place k of n.
  static Span column(std::size_t k, std::size_t n) {
    const std::size_t columns = (n + tile / 2) / tile;
    if (columns < 2) return {0, n};
    const std::size_t c = k * columns / n;
    const std::size_t from = (c * n + columns - 1) / columns;
    return {from, ((c + 1) * n + columns - 1) / columns - from};
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
            std::vector<IndexPair>& found) const {
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
  /// Looks at as many spheres at a time as there are lanes; the arrays go on for one pack more.
  template <class Arch, class Domain>
  void scan_range(std::size_t p, Range range, double reach, const Domain& domain,
                  std::vector<IndexPair>& found) const {
    using Real = typename Lanes<Arch>::Real;
    constexpr std::size_t W = Lanes<Arch>::width;
    const Real x(x_[p]), y(y_[p]), z(z_[p]), own(r_[p]), further(reach);
    for (std::size_t q = range.begin; q < range.end; q += W) {
      Vec3<Real> d{x - load_any<Real>(&x_[q]), y - load_any<Real>(&y_[q]),
                   z - load_any<Real>(&z_[q])};
      if constexpr (Domain::periodic) d = domain.shortest(d);
      const Real cutoff = own + load_any<Real>(&r_[q]) + further;
      std::uint64_t near = lane_bits(dot(d, d) < cutoff * cutoff);
      if (range.end - q < W) near &= (std::uint64_t{1} << (range.end - q)) - 1;
      for (; near != 0; near &= near - 1)
        found.push_back({order_[p], order_[q + static_cast<std::size_t>(std::countr_zero(near))]});
    }
  }

  static constexpr std::size_t tile = 12;  // cells

  Vec3d low_{};                                // [m]
  std::array<std::size_t, 3> count_{1, 1, 1};  // cells in each direction
  std::array<double, 3> per_length_{};         // [1/m]
  std::vector<std::uint32_t> cell_, order_, next_;
  std::vector<std::uint32_t> start_;           // first sphere of each cell, in `order_`
  std::vector<double> x_, y_, z_, r_;          // [m] of the spheres in `order_`
  std::vector<std::vector<IndexPair>> found_;  // by part
};

static_assert(NeighbourSearch<CellGrid>);

}  // namespace silt
