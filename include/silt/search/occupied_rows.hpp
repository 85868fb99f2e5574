// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>
#include <silt/search/key_sort.hpp>
#include <silt/search/levels.hpp>
#include <silt/search/pair_scan.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Spheres sorted by level, by row of cells, and by x within a row, with a list of the occupied
/// rows. Time and memory are proportional to the number of spheres, not of cells.
///
/// A row contains all cells of a level with the same y and z. A key contains, from the highest bit,
/// level, z, y, a coarse position along x, and the sphere's number. Rows are found in the sorted
/// list of their keys, starting at the last one that was found.
class OccupiedRows {
 public:
  struct Level {
    double cutoff;  // [m] of its largest spheres
    GridFrame frame;
    std::size_t first_row = 0;
    std::size_t first_sphere = 0;
  };

  template <class Domain>
  void sort(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            const Levels& wanted) {
    choose_cells(spheres, reach, domain, team, wanted);
    const auto rows = spheres.rows;
    const std::size_t n = rows.size();
    keys_.resize(n), spheres_.resize(n);
    const double low = levels_[0].frame.low[0], per_length = places_ / std::max(length_x_, 1e-300);
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        std::size_t level = levels_.size() - 1;
        while (level > 0 && 2 * rows[k].r + reach > levels_[level].cutoff) --level;
        const GridFrame& frame = levels_[level].frame;
        const auto x = static_cast<std::uint64_t>(
            std::clamp((rows[k].x - low) * per_length, 0.0, places_ - 1));
        keys_[k] = k | x << bits_.x | frame.along(rows[k].y, 1) << bits_.y |
                   frame.along(rows[k].z, 2) << bits_.z | shifted(level, bits_.level);
      }
    });
    sort_(keys_, bits_.x, bits_.end, team);
    list_rows();
    spheres_.take(rows, team);
  }

  const DynArray<Level>& levels() const { return levels_; }
  double scale() const { return scale_; }  // [m] largest coordinate: the scale of rounding
  const SphereColumns& spheres() const { return spheres_; }
  std::size_t rows() const { return row_key_.size(); }

  SphereRange in_row(std::size_t row) const { return {row_start_[row], row_start_[row + 1]}; }
  std::size_t y_of(std::size_t row) const { return row_key_[row] & ones(bits_.z - bits_.y); }
  std::size_t z_of(std::size_t row) const {
    return row_key_[row] >> (bits_.z - bits_.y) & ones(bits_.level - bits_.z);
  }
  std::size_t level_of(std::size_t row) const {
    const int by = bits_.level - bits_.y;
    return by < 64 ? row_key_[row] >> by : 0;
  }
  std::uint64_t row_key(std::size_t level, std::size_t y, std::size_t z) const {
    return y | z << (bits_.z - bits_.y) | shifted(level, bits_.level - bits_.y);
  }

  /// First row with a key of at least `key`; tests rows near `at` first.
  std::size_t seek(std::size_t at, std::uint64_t key) const {
    const std::size_t n = row_key_.size();
    const std::uint64_t* const keys = row_key_.data();
    std::size_t from = at, to = at, step = 1;
    if (at < n && keys[at] < key) {
      for (; from + step < n && keys[from + step] < key; step *= 2) from += step;
      to = std::min(from + step, n), ++from;
    } else {
      for (; from > 0 && keys[from - 1] >= key; step *= 2)
        to = from - 1, from -= std::min(from, step);
    }
    return static_cast<std::size_t>(std::lower_bound(keys + from, keys + to, key) - keys);
  }
  bool is_before(std::size_t row, std::uint64_t end_key) const {
    return row < row_key_.size() && row_key_[row] < end_key;
  }
  /// Row of a sphere.
  std::size_t row_of(std::size_t sphere) const {
    const auto after = std::upper_bound(row_start_.begin(), row_start_.end(), sphere);
    return static_cast<std::size_t>(after - row_start_.begin()) - 1;
  }
  /// A sphere in a row may be out of order by up to this distance [m].
  double disorder() const { return disorder_; }
  /// A sphere of a row range after which all are at or beyond x.
  std::size_t first_from(SphereRange range, double x) const {
    const double* const xs = spheres_.x.data();
    std::size_t from = range.begin;
    for (std::size_t length = range.end - range.begin; length > 0;) {  // without a branch on x
      const std::size_t half = (length + 1) / 2;
      from += xs[from + half - 1] < x - disorder_ ? half : 0;
      length -= half;
    }
    return from;
  }

  /// A sphere of a row range after which all are beyond x, within rounding.
  std::size_t first_beyond(SphereRange range, double x) const {
    return first_from(range, x + 2 * disorder_);
  }

 private:
  /// First bits of the parts of a key.
  struct KeyBits {
    int x, y, z, level, end;
  };
  static std::uint64_t shifted(std::uint64_t value, int by) { return by < 64 ? value << by : 0; }
  static std::uint64_t ones(int bits) { return (std::uint64_t{1} << bits) - 1; }

  template <class Domain>
  void choose_cells(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
                    const Levels& wanted) {
    const Box bounds = bounds_of(spheres, domain, team);
    const Vec3d e = bounds.extent();
    const bool empty = spheres.rows.empty();
    const double longest = empty ? 0 : std::max({e.x, e.y, e.z});  // [m]
    length_x_ = empty ? 0 : e.x, scale_ = longest;
    for (const Vec3d& p : {bounds.min, bounds.max})
      if (!empty) scale_ = std::max({scale_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const auto cutoffs = choose_levels(spheres, reach, wanted, team);
    for (double grown = 1;; grown *= 1.26) {  // until the keys can hold all rows
      levels_.clear();
      std::array<std::size_t, 3> most{1, 1, 1};  // cells
      for (const double cutoff : cutoffs) {
        const double edge = std::max(cutoff, 1e-12 * longest) * grown;
        levels_.push_back({cutoff, GridFrame(bounds, edge, domain)});
        for (int d = 0; d < 3; ++d) most[d] = std::max(most[d], levels_.back().frame.count[d]);
      }
      // Eight positions along x for each cell, if there are enough bits.
      const int name = bits_for(spheres.rows.size()), level = bits_for(levels_.size()),
                row = bits_for(most[1]) + bits_for(most[2]);
      const int place = std::min(bits_for(most[0]) + 3, 64 - name - level - row);
      if (place < bits_for(most[0])) continue;
      places_ = std::ldexp(1.0, place);
      disorder_ = length_x_ / places_ * (1 + 1e-9) + 1e-15 * scale_;
      bits_.x = name, bits_.y = name + place;
      bits_.z = bits_.y + bits_for(most[1]), bits_.level = bits_.z + bits_for(most[2]);
      bits_.end = bits_.level + level;
      return;
    }
  }

  void list_rows() {
    row_key_.clear(), row_start_.clear();
    const std::uint64_t number = ones(bits_.x);
    std::uint64_t last = ~std::uint64_t{0};
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      spheres_.name[k] = static_cast<std::uint32_t>(keys_[k] & number);
      const std::uint64_t row = shifted_down(keys_[k], bits_.y);
      if (row == last) continue;
      row_key_.push_back(row), row_start_.push_back(static_cast<std::uint32_t>(k));
      last = row;
    }
    row_start_.push_back(static_cast<std::uint32_t>(keys_.size()));
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      levels_[l].first_row = seek(0, row_key(l, 0, 0));
      levels_[l].first_sphere = row_start_[levels_[l].first_row];
    }
  }
  static std::uint64_t shifted_down(std::uint64_t value, int by) {
    return by < 64 ? value >> by : 0;
  }

  DynArray<Level> levels_;
  double scale_ = 0, length_x_ = 0;
  double places_ = 1, disorder_ = 0;  // along x that keys distinguish; width of each [m]
  KeyBits bits_{};
  DynArray<std::uint64_t> keys_;
  KeySort<std::uint64_t> sort_;
  SphereColumns spheres_;
  DynArray<std::uint64_t> row_key_;    // level, z, y
  DynArray<std::uint32_t> row_start_;  // first sphere
};

}  // namespace silt::detail
