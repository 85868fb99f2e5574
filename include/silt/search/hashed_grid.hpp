// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>
#include <silt/search/key_sort.hpp>
#include <silt/search/levels.hpp>
#include <silt/search/pair_scan.hpp>
#include <silt/search/space_order.hpp>

namespace silt {

/// Grids of occupied cells alone: time and memory follow the number of spheres, however large and
/// empty the domain is. Spheres of different sizes lie in several grids, each with cells that fit
/// them (see Levels).
///
///   silt::HashedGrid{}                        levels chosen from the sizes
///   silt::HashedGrid{silt::sub_grid(0.2)}     a sub-grid for fines
///   silt::HashedGrid{silt::one_level}         one grid for all
///
/// A sphere's key is its level and its cell; spheres are sorted by their keys, so that a row of
/// cells along x is one range of spheres. Within a level, each row is looked at together with the
/// four rows that follow it among the eight around, in windows that move along x (half stencil).
/// Across levels, each row looks, in blocks of a few spheres, at the rows of every coarser level
/// that are near: coarse spheres that reach a block's box meet its spheres. A row is found by
/// moving along the sorted list from the one asked for last, which is faster than a hash table.
/// Valid:  at most 2^32 - 1 spheres. Keys have 64 bits, the sphere's number included; cells grow
///         where they do not suffice (1e6 spheres: from 1e13 cells on).
/// Shapes: none. Units: SI. Errors: InputError for levels that cannot be, and for a sphere without
///         a finite place or size.
/// Tests:  tests/search/searches.cpp (pair sets identical to BruteForce), tests/search/levels.cpp.
class HashedGrid {
 public:
  HashedGrid() = default;
  HashedGrid(const Levels& levels) : choice_(levels) { levels.check(); }  // NOLINT: converts

  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    detail::space_order(spheres, reach, domain, team, order);
  }

  template <class Arch = DefaultArch, class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    sort_into_cells(spheres, reach, domain, team);
    list_cells();
    found_(team, pairs, [&](std::size_t part, std::size_t parts, detail::PairBuffer& found) {
      Scan<Arch, Domain> scan(*this, reach, domain, found);
      for (std::size_t row = first_row(part, parts); row < first_row(part + 1, parts); ++row)
        scan(row);
    });
  }

  /// Widths of the cells of the last search [m]: what a sphere's cutoff must not exceed, the
  /// coarsest level first.
  std::vector<double> cutoffs() const {
    std::vector<double> all;
    for (const Level& l : levels_) all.push_back(l.cutoff);
    return all;
  }

 private:
  struct Level {
    double cutoff;  // [m] of its largest spheres
    detail::GridFrame frame;
  };
  /// Where the parts of a key begin, from the lowest bit: sphere, x, y, z, level.
  struct KeyBits {
    int x, y, z, level, end;
  };
  using Range = detail::SphereRange;
  static constexpr std::size_t none = ~std::size_t{0};

  // --- sorting ------------------------------------------------------------------------------

  template <class Domain>
  void choose_cells(const SphereSet& spheres, double reach, const Domain& domain,
                    const Team& team) {
    const Box bounds = detail::bounds_of(spheres, domain, team);
    const Vec3d e = bounds.extent();
    longest_ = spheres.rows.empty() ? 0 : std::max({e.x, e.y, e.z});
    const auto cutoffs = detail::choose_levels(spheres, reach, choice_, team);
    for (double grown = 1;; grown *= 1.26) {
      levels_.clear();
      std::array<std::size_t, 3> most{1, 1, 1};  // cells
      for (const double cutoff : cutoffs) {
        const double edge = std::max(cutoff, 1e-12 * longest_) * grown;
        levels_.push_back({cutoff, detail::GridFrame(bounds, edge, domain)});
        for (int d = 0; d < 3; ++d) most[d] = std::max(most[d], levels_.back().frame.count[d]);
      }
      bits_.x = detail::bits_for(spheres.rows.size());
      bits_.y = bits_.x + detail::bits_for(most[0]);
      bits_.z = bits_.y + detail::bits_for(most[1]);
      bits_.level = bits_.z + detail::bits_for(most[2]);
      bits_.end = bits_.level + detail::bits_for(levels_.size());
      if (bits_.end <= 64 && bits_.y - bits_.x <= 32) return;
    }
  }

  template <class Domain>
  void sort_into_cells(const SphereSet& spheres, double reach, const Domain& domain,
                       const Team& team) {
    choose_cells(spheres, reach, domain, team);
    const auto rows = spheres.rows;
    const std::size_t n = rows.size();
    keys_.resize(n), spheres_.resize(n);
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        std::size_t level = levels_.size() - 1;
        while (level > 0 && 2 * rows[k].r + reach > levels_[level].cutoff) --level;
        const auto& frame = levels_[level].frame;
        keys_[k] = k | frame.along(rows[k].x, 0) << bits_.x | frame.along(rows[k].y, 1) << bits_.y |
                   frame.along(rows[k].z, 2) << bits_.z | shifted(level, bits_.level);
      }
    });
    sort_(keys_, bits_.x, bits_.end, team);
    const std::uint64_t sphere = (std::uint64_t{1} << bits_.x) - 1;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        spheres_.name[k] = static_cast<std::uint32_t>(keys_[k] & sphere);
    });
    spheres_.take(rows, team);
  }
  static std::uint64_t shifted(std::uint64_t value, int by) { return by < 64 ? value << by : 0; }

  /// Lists the cells and rows that the sorted keys name.
  void list_cells() {
    cell_x_.clear(), cell_start_.clear(), row_key_.clear(), row_cells_.clear();
    const std::uint64_t in_row = (std::uint64_t{1} << (bits_.y - bits_.x)) - 1;
    std::uint64_t last = ~std::uint64_t{0};
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      const std::uint64_t cell = keys_[k] >> bits_.x;
      if (cell == last) continue;
      const std::uint64_t row = cell >> (bits_.y - bits_.x);
      if (row_key_.empty() || row_key_.back() != row) {
        row_key_.push_back(row);
        row_cells_.push_back(static_cast<std::uint32_t>(cell_x_.size()));
      }
      cell_x_.push_back(static_cast<std::uint32_t>(cell & in_row));
      cell_start_.push_back(static_cast<std::uint32_t>(k));
      last = cell;
    }
    row_cells_.push_back(static_cast<std::uint32_t>(cell_x_.size()));
    cell_start_.push_back(static_cast<std::uint32_t>(keys_.size()));
  }

  /// The row from which a part of the spheres begins.
  std::size_t first_row(std::size_t part, std::size_t parts) const {
    const std::size_t sphere = keys_.size() * part / parts;
    const auto at =
        std::partition_point(row_cells_.begin(), row_cells_.end() - 1,
                             [&](std::uint32_t cell) { return cell_start_[cell] < sphere; });
    return static_cast<std::size_t>(at - row_cells_.begin());
  }

  // --- rows ---------------------------------------------------------------------------------

  std::uint64_t row_key(std::size_t level, std::size_t y, std::size_t z) const {
    return y | z << (bits_.z - bits_.y) | shifted(level, bits_.level - bits_.y);
  }
  std::size_t level_of(std::size_t row) const {
    const int by = bits_.level - bits_.y;
    return by < 64 ? row_key_[row] >> by : 0;
  }
  std::size_t y_of(std::size_t row) const {
    return row_key_[row] & ((std::uint64_t{1} << (bits_.z - bits_.y)) - 1);
  }
  std::size_t z_of(std::size_t row) const {
    return row_key_[row] >> (bits_.z - bits_.y) &
           ((std::uint64_t{1} << (bits_.level - bits_.z)) - 1);
  }

  /// The first row from `key` on; looks near row `at` first.
  std::size_t seek(std::size_t at, std::uint64_t key) const {
    const std::size_t n = row_key_.size();
    const std::uint64_t* const keys = row_key_.data();
    std::size_t from = at, to = at, step = 1;
    if (at < n && keys[at] < key) {
      while (from + step < n && keys[from + step] < key) from += step, step *= 2;
      to = std::min(from + step, n), ++from;
    } else {
      while (from > 0 && keys[from - 1] >= key)
        to = from - 1, from -= std::min(from, step), step *= 2;
    }
    return static_cast<std::size_t>(std::lower_bound(keys + from, keys + to, key) - keys);
  }

  /// Cells of a row, first ... end-1, and a window in them that moves.
  struct Window {
    std::size_t first, end, low, high;
  };
  Window window_of(std::size_t row) const {
    return {row_cells_[row], row_cells_[row + 1], row_cells_[row], row_cells_[row]};
  }
  /// Moves a window to the cells from ... to of its row.
  SILT_INLINE Range move(Window& w, std::size_t from, std::size_t to) const {
    const std::uint32_t* const x = cell_x_.data();
    while (w.low > w.first && x[w.low - 1] >= from) --w.low;
    while (w.low < w.end && x[w.low] < from) ++w.low;
    w.high = std::max(w.high, w.low);
    while (w.high > w.low && x[w.high - 1] > to) --w.high;
    while (w.high < w.end && x[w.high] <= to) ++w.high;
    return {cell_start_[w.low], cell_start_[w.high]};
  }

  template <class Arch, class Domain>
  class Scan;

  Levels choice_;
  std::vector<Level> levels_;
  double longest_ = 0;  // [m] side of the box around all centres
  KeyBits bits_{};
  std::vector<std::uint64_t> keys_;
  detail::KeySort sort_;
  detail::SphereColumns spheres_;
  std::vector<std::uint32_t> cell_x_, cell_start_;  // of occupied cells: x, first sphere
  std::vector<std::uint64_t> row_key_;              // of rows that hold any: level, z, y
  std::vector<std::uint32_t> row_cells_;            // the first cell of each
  detail::FoundInParts found_;
};

/// Looks at one row after the other.
template <class Arch, class Domain>
class HashedGrid::Scan {
 public:
  Scan(const HashedGrid& grid, double reach, const Domain& domain, detail::PairBuffer& found)
      : g_(grid), reach_(reach), domain_(domain), found_(found) {
    near_.resize(g_.levels_.size());
  }

  void operator()(std::size_t row) {
    scan_level(row);
    const std::size_t level = g_.level_of(row);
    if (level == 0) return;
    cut_into_blocks(row, level);
    for (std::size_t coarse = 0; coarse < level; ++coarse) scan_coarser(level, coarse);
  }

 private:
  using Partners = detail::PartnerScan<Arch, Domain>;
  static constexpr std::size_t width = Lanes<Arch>::width;

  // --- within a level -----------------------------------------------------------------------

  void scan_level(std::size_t row) {
    const auto& frame = g_.levels_[g_.level_of(row)].frame;
    open_neighbours(row, frame);
    const std::size_t first = g_.row_cells_[row], end = g_.row_cells_[row + 1];
    for (std::size_t c = first; c < end; ++c) {
      const std::size_t x = g_.cell_x_[c];
      const bool next_to_it = c + 1 < end && g_.cell_x_[c + 1] == x + 1;
      const std::size_t own_end = g_.cell_start_[c + (next_to_it ? 2 : 1)];
      std::array<Range, 14> ranges;
      int count = 0;
      const auto add = [&](Range r) {
        if (r.begin < r.end) ranges[count++] = r;
      };
      if (frame.wraps[0] && x + 1 == frame.count[0] && g_.cell_x_[first] == 0) add(cell(first));
      for (int k = 0; k < neighbours_; ++k) {
        Window& w = neighbour_[k];
        add(g_.move(w, x - std::min<std::size_t>(x, 1), x + 1));
        if (!frame.wraps[0]) continue;
        if (x == 0 && g_.cell_x_[w.end - 1] + 1 == frame.count[0]) add(cell(w.end - 1));
        if (x + 1 == frame.count[0] && g_.cell_x_[w.first] == 0) add(cell(w.first));
      }
      std::size_t further = width;
      for (int k = 0; k < count; ++k) further += ranges[k].end - ranges[k].begin;
      for (std::size_t p = g_.cell_start_[c]; p < g_.cell_start_[c + 1]; ++p) {
        const Partners partners_of(g_.spheres_, p, reach_, domain_);
        IndexPair* next = found_.room_for(own_end - p + further);
        next = partners_of({p + 1, own_end}, next);
        for (int k = 0; k < count; ++k) next = partners_of(ranges[k], next);
        found_.take_up_to(next);
      }
    }
  }
  Range cell(std::size_t c) const { return {g_.cell_start_[c], g_.cell_start_[c + 1]}; }

  /// Opens windows in the rows that follow `row` among the eight around it.
  void open_neighbours(std::size_t row, const detail::GridFrame& frame) {
    static constexpr int dy[4] = {1, -1, 0, 1}, dz[4] = {0, 1, 1, 1};
    neighbours_ = 0;
    for (int k = 0; k < 4; ++k) {
      const std::size_t y = beside(g_.y_of(row), dy[k], frame, 1),
                        z = beside(g_.z_of(row), dz[k], frame, 2);
      if (y == none || z == none) continue;
      const std::uint64_t key = g_.row_key(g_.level_of(row), y, z);
      cursor_[k] = g_.seek(cursor_[k], key);
      if (cursor_[k] < g_.row_key_.size() && g_.row_key_[cursor_[k]] == key)
        neighbour_[neighbours_++] = g_.window_of(cursor_[k]);
    }
  }
  static std::size_t beside(std::size_t k, int step, const detail::GridFrame& frame, int d) {
    const std::size_t n = frame.count[d];
    const bool outside = (k == 0 && step < 0) || (k + 1 == n && step > 0);
    if (outside && !frame.wraps[d]) return none;
    return outside ? (step < 0 ? n - 1 : 0) : k + static_cast<std::size_t>(step);
  }

  // --- across levels ------------------------------------------------------------------------

  /// A few spheres of a row that lie close together.
  struct Block {
    Range spheres;
    Box box;         // [m] around their centres
    double largest;  // [m] radius
  };

  void cut_into_blocks(std::size_t row, std::size_t level) {
    const double next_edge = g_.levels_[level - 1].frame.edge(0),
                 edge = g_.levels_[level].frame.edge(0);
    const auto span = std::isfinite(next_edge / edge)
                          ? std::max<std::size_t>(1, static_cast<std::size_t>(next_edge / edge))
                          : none;
    blocks_.clear();
    row_box_ = Box();
    const std::size_t end = g_.row_cells_[row + 1];
    for (std::size_t c = g_.row_cells_[row]; c < end;) {
      const std::size_t first = c;
      while (c < end && g_.cell_x_[c] - g_.cell_x_[first] < span &&
             (c == first || g_.cell_start_[c + 1] - g_.cell_start_[first] <= most_in_block))
        ++c;
      Block b{{g_.cell_start_[first], g_.cell_start_[c]}, Box(), 0};
      for (std::size_t p = b.spheres.begin; p < b.spheres.end; ++p) {
        b.box.include(Vec3d{g_.spheres_.x[p], g_.spheres_.y[p], g_.spheres_.z[p]});
        b.largest = std::max(b.largest, g_.spheres_.r[p]);
      }
      row_box_.include(b.box);
      blocks_.push_back(b);
    }
  }

  /// Cells from ... to of a level that the interval low ... high [m] meets; beyond the ends of a
  /// direction that repeats they go on counting.
  struct Cells {
    std::int64_t from, to;
  };
  static Cells cells_in(double low, double high, const detail::GridFrame& frame, int d) {
    const auto n = static_cast<double>(frame.count[d]);
    const double from = std::floor((low - frame.low[d]) * frame.per_length[d]),
                 to = std::floor((high - frame.low[d]) * frame.per_length[d]);
    if (!frame.wraps[d])
      return {static_cast<std::int64_t>(std::clamp(from, 0.0, n - 1)),
              static_cast<std::int64_t>(std::clamp(to, 0.0, n - 1))};
    if (to - from + 1 >= n) return {0, static_cast<std::int64_t>(n) - 1};
    return {static_cast<std::int64_t>(from), static_cast<std::int64_t>(to)};
  }

  /// Finds the pairs of all blocks with spheres of a coarser level.
  void scan_coarser(std::size_t level, std::size_t coarse) {
    const Level& fine = g_.levels_[level];
    const Level& other = g_.levels_[coarse];
    const double cutoff = 0.5 * (fine.cutoff + other.cutoff);
    margin_ = 1e-9 * cutoff + 1e-15 * g_.longest_;
    const double around = cutoff + margin_;
    open_rows(coarse, around);
    if (windows_.empty()) return;
    for (const Block& b : blocks_) {
      const Cells x = cells_in(b.box.min.x - around, b.box.max.x + around, other.frame, 0);
      const auto n = static_cast<std::int64_t>(other.frame.count[0]);
      for (Window& w : windows_)
        if (x.from < 0) {
          meet(b, g_.move(w, 0, static_cast<std::size_t>(x.to)));
          meet(b,
               g_.move(w, static_cast<std::size_t>(x.from + n), static_cast<std::size_t>(n - 1)));
        } else if (x.to >= n) {
          meet(b, g_.move(w, static_cast<std::size_t>(x.from), static_cast<std::size_t>(n - 1)));
          meet(b, g_.move(w, 0, static_cast<std::size_t>(x.to - n)));
        } else {
          meet(b, g_.move(w, static_cast<std::size_t>(x.from), static_cast<std::size_t>(x.to)));
        }
    }
  }

  /// Opens windows in the rows of a coarser level that the blocks may meet.
  void open_rows(std::size_t level, double around) {
    const auto& frame = g_.levels_[level].frame;
    const Cells y = cells_in(row_box_.min.y - around, row_box_.max.y + around, frame, 1),
                z = cells_in(row_box_.min.z - around, row_box_.max.z + around, frame, 2);
    const auto within = [](std::int64_t k, std::size_t count) {
      const auto n = static_cast<std::int64_t>(count);
      return static_cast<std::size_t>(k < 0 ? k + n : k >= n ? k - n : k);
    };
    windows_.clear();
    auto& cursors = near_[level];
    std::size_t k = 0;
    for (std::int64_t j = z.from; j <= z.to; ++j)
      for (std::int64_t i = y.from; i <= y.to; ++i, ++k) {
        if (k == cursors.size()) cursors.push_back(0);
        const std::uint64_t key =
            g_.row_key(level, within(i, frame.count[1]), within(j, frame.count[2]));
        cursors[k] = g_.seek(cursors[k], key);
        if (cursors[k] < g_.row_key_.size() && g_.row_key_[cursors[k]] == key)
          windows_.push_back(g_.window_of(cursors[k]));
      }
  }

  /// The coarse spheres of a range that reach the box of a block meet its spheres.
  void meet(const Block& b, Range coarse) {
    using Real = typename Lanes<Arch>::Real;
    const auto& s = g_.spheres_;
    const Vec3d m = b.box.centre(), h = half_width(b.box);
    const Vec3<Real> centre{Real(m.x), Real(m.y), Real(m.z)}, half{Real(h.x), Real(h.y), Real(h.z)};
    const Real zero(0), further(b.largest + reach_ + margin_);
    for (std::size_t q = coarse.begin; q < coarse.end; q += width) {
      Vec3<Real> d{centre.x - load_any<Real>(s.x.data() + q),
                   centre.y - load_any<Real>(s.y.data() + q),
                   centre.z - load_any<Real>(s.z.data() + q)};
      if constexpr (Domain::periodic) d = domain_.shortest(d);
      const Vec3<Real> out{max(abs(d.x) - half.x, zero), max(abs(d.y) - half.y, zero),
                           max(abs(d.z) - half.z, zero)};
      const Real cutoff = load_any<Real>(s.r.data() + q) + further;
      std::uint64_t bits = lane_bits(dot(out, out) < cutoff * cutoff) &
                           ~std::uint64_t{0} >> (64 - std::min(width, coarse.end - q));
      for (; bits != 0; bits &= bits - 1) {
        const Partners partners_of(s, q + static_cast<std::size_t>(std::countr_zero(bits)), reach_,
                                   domain_);
        found_.take_up_to(
            partners_of(b.spheres, found_.room_for(b.spheres.end - b.spheres.begin + width)));
      }
    }
  }
  /// Half of the box [m]; infinite where so long that another image of a sphere may be nearer to
  /// part of it than the one that is nearest to its centre.
  Vec3d half_width(const Box& box) const {
    Vec3d h = 0.5 * box.extent();
    if constexpr (Domain::periodic) {
      double* const half[3] = {&h.x, &h.y, &h.z};
      for (int d = 0; d < 3; ++d)
        if (domain_.repeats(d) && 2 * *half[d] + g_.levels_[0].cutoff > 0.49 * domain_.length(d))
          *half[d] = INFINITY;
    }
    return h;
  }

  static constexpr std::size_t most_in_block = 64;  // spheres

  const HashedGrid& g_;
  double reach_, margin_ = 0;  // [m]
  const Domain& domain_;
  detail::PairBuffer& found_;
  std::array<std::size_t, 4> cursor_{};
  std::array<Window, 4> neighbour_{};
  int neighbours_ = 0;
  std::vector<Block> blocks_;
  Box row_box_;
  std::vector<Window> windows_;
  std::vector<std::vector<std::size_t>> near_;  // by coarse level: cursors
};

static_assert(NeighbourSearch<HashedGrid>);

}  // namespace silt
