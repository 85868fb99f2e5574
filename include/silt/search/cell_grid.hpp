// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>
#include <silt/search/pair_scan.hpp>

namespace silt::inline SILT_TARGET {

/// Uniform grid over the bounding box of the spheres. Neighbours are searched in a sphere's own
/// cell and in half of the 26 cells around it (half stencil).
///
/// The cell edge is the largest cutoff, 2 r_max + reach, increased where needed to at most 8 cells
/// per sphere. Time and memory are O(N) for spheres of similar size. For wide size distributions
/// and nearly empty domains the results are right, but the search is slow.
///
/// Source: M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, 2nd ed., section 5.3.
/// Shapes: none. Units: SI. Errors: InputError for a sphere without a finite position or size.
/// Tests:  tests/search/searches.cpp (pair sets identical to BruteForce).
/// Valid:  spheres of any sizes; fast for similar sizes in a domain that is not nearly empty.
class CellGrid {
 public:
  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    build(spheres, reach, domain, team);
    order.assign(spheres_.name.begin(), spheres_.name.end() - detail::SphereColumns::padding);
  }

  template <class Arch = DefaultArch, class Domain>
  void find_ordered(double reach, const Domain& domain, const Team& team,
                    std::vector<IndexPair>& pairs) {
    std::iota(spheres_.name.begin(), spheres_.name.end(), 0u);
    scan_all<Arch>(reach, domain, team, pairs);
  }

  template <class Arch = DefaultArch, class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    build(spheres, reach, domain, team);
    scan_all<Arch>(reach, domain, team, pairs);
  }

  /// First half of find(): sorts spheres into cells.
  template <class Domain>
  void build(const SphereSet& spheres, double reach, const Domain& domain, const Team& team) {
    const auto rows = spheres.rows;
    const std::size_t n = rows.size();
    const Box bounds = detail::bounds_of(spheres, domain, team);
    const double most = 8.0 * static_cast<double>(n) + 64;
    frame_ = detail::finest_frame(bounds, 2 * spheres.largest_radius + reach, domain,
                                  [most](const auto& frame) { return frame.cells() <= most; });
    for (int d = 0; d < 2; ++d) cut_into_columns(frame_.count[d], columns_[d]);

    // Counting sort: each part counts its spheres in every cell, then places them after those of
    // the preceding parts. The sort is stable; the order does not depend on the number of parts.
    const std::size_t parts = static_cast<std::size_t>(std::min(team.threads(), 8)), c = cells();
    cell_.resize(n), next_.assign(parts * c, 0), start_.resize(c + 1), spheres_.resize(n);
    team.for_parts(parts, [&](std::size_t part) {
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k)
        ++next_[part * c + (cell_[k] = number(cell_of(rows[k].centre())))];
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
        spheres_.name[next_[part * c + cell_[k]]++] = static_cast<std::uint32_t>(k);
    });
    spheres_.take(rows, team);
  }

 private:
  using Range = detail::SphereRange;

  template <class Arch, class Domain>
  void scan_all(double reach, const Domain& domain, const Team& team,
                std::vector<IndexPair>& pairs) {
    const std::size_t n = spheres_.size();
    found_(team, pairs, [&](std::size_t part, std::size_t parts, detail::PairBuffer& found) {
      scan<Arch>(n * part / parts, n * (part + 1) / parts, reach, domain, found);
    });
  }

  std::size_t cells() const { return frame_.count[0] * frame_.count[1] * frame_.count[2]; }
  struct Cell {
    std::size_t x, y, z;
  };
  Cell cell_of(const Vec3d& p) const {
    return {frame_.along(p.x, 0), frame_.along(p.y, 1), frame_.along(p.z, 2)};
  }
  /// Number of a cell. Cells are numbered in columns of about tile x tile cells, and layer by layer
  /// within a column. Spheres of neighbouring layers are then close in memory and stay in the
  /// second-level cache from one layer to the next.
  std::uint32_t number(const Cell& c) const {
    const Span x = columns_[0][c.x], y = columns_[1][c.y];
    return static_cast<std::uint32_t>(
        frame_.count[2] * (y.from * frame_.count[0] + x.from * y.length) +
        x.length * (c.z * y.length + (c.y - y.from)) + (c.x - x.from));
  }
  struct Span {
    std::size_t from, length;
  };
  /// The columns that contain positions 0 ... n-1.
  static void cut_into_columns(std::size_t n, DynArray<Span>& of) {
    const std::size_t columns = std::max<std::size_t>((n + tile / 2) / tile, 1);
    of.clear();
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t from = c * n / columns, to = (c + 1) * n / columns;
      of.insert(of.end(), to - from, {from, to - from});
    }
  }

  /// Spheres of the following cells that a cell must test, as ranges; returns their number.
  int ranges_after(const Cell& cell, std::array<Range, 26>& out) const {
    const std::size_t c = number(cell);
    std::array<std::size_t, 3> xs, ys, zs;
    const int nx = around(cell.x, 0, xs), ny = around(cell.y, 1, ys), nz = around(cell.z, 2, zs);
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
  /// The cells before, at and after k in direction d, each once; returns their number.
  int around(std::size_t k, int d, std::array<std::size_t, 3>& out) const {
    const std::size_t n = frame_.count[d];
    int found = 0;
    for (std::size_t step = 0; step < 3; ++step) {
      const bool outside = (k == 0 && step == 0) || (k + 1 == n && step == 2);
      if (outside && !frame_.wraps[d]) continue;
      out[found++] = (k + n + step - 1) % n;
    }
    return found;
  }

  template <class Arch, class Domain>
  void scan(std::size_t from, std::size_t to, double reach, const Domain& domain,
            detail::PairBuffer& found) const {
    using Scan = detail::PartnerScan<Arch, Domain>;
    std::array<Range, 26> ranges{};
    int count = 0;
    std::size_t own_end = 0, further = 0;
    for (std::size_t p = from; p < to; ++p) {
      if (p >= own_end) {  // the first sphere of a cell
        const Cell cell = cell_of({spheres_.x[p], spheres_.y[p], spheres_.z[p]});
        own_end = start_[number(cell) + 1];
        count = ranges_after(cell, ranges);
        further = Scan::width;
        for (int k = 0; k < count; ++k) further += ranges[k].end - ranges[k].begin;
      }
      const Scan scan_of(spheres_, p, reach, domain);
      IndexPair* next = found.room_for(own_end - p + further);
      next = scan_of({p + 1, own_end}, next);
      for (int k = 0; k < count; ++k) next = scan_of(ranges[k], next);
      found.take_up_to(next);
    }
  }

  static constexpr std::size_t tile = 12;  // cells

  detail::GridFrame frame_;
  std::array<DynArray<Span>, 2> columns_;  // of each x and y
  DynArray<std::uint32_t> cell_, next_;
  DynArray<std::uint32_t> start_;  // first sphere of each cell, in spheres_
  detail::SphereColumns spheres_;
  detail::FoundInParts found_;
};

static_assert(NeighbourSearch<CellGrid>);

}  // namespace silt
