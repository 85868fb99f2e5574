// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Map of places that may have liquid within its reach [m]: complete, and too large by at most one
/// cell of half a spacing. One bit per cell: cells with liquid are dilated by a sphere, all by the
/// same one, and the few fast particles that reach farther each by its own.
/// Tests: tests/sph/cluster_lists.cpp, against all pairs.
class NearLiquid {
 public:
  /// Takes the rows of kind Liquid that are inside the periodic box; reach_of(row) is `reach` for
  /// most of them, or less.
  template <class ReachOf>
  void find(const SphColumns& of, const Repeats& repeats, double reach, const ReachOf& reach_of,
            double spacing, bool plane, const Team& team) {
    std::size_t count = 0;
    double farthest = reach;
    far_.clear();
    for_liquid(of, [&](std::size_t k) {
      ++count;
      if (const double own = reach_of(k); own > reach)
        far_.push_back(k), farthest = std::max(farthest, own);
    });
    if (far_.size() > count / 16) reach = farthest, far_.clear();
    lay(of, repeats, farthest, spacing, plane);
    wet_.assign(columns() * words_, 0), filled_.assign(columns(), 0);
    for_liquid(of, [&](std::size_t k) {
      for_cells(of.rows[k], repeats, plane, [&](int i, int j, int z) {
        const std::size_t c = column(i, j);
        wet_[c * words_ + static_cast<std::size_t>(z) / 64] |= std::uint64_t{1} << (z % 64);
        filled_[c] = 1;
      });
    });
    spread(reach, plane, team);
    for (const std::size_t k : far_)
      for_cells(of.rows[k], repeats, plane,
                [&](int i, int j, int z) { add_ball(i, j, z, reach_of(k), plane); });
  }
  bool operator()(const Vec3d& x) const {
    const double i = (x.x - low_[0]) / cell_, j = cells_[1] == 1 ? 0 : (x.y - low_[1]) / cell_,
                 k = (x.z - low_[2]) / cell_;
    if (!(i >= 0 && j >= 0 && k >= 0 && i < cells_[0] && j < cells_[1] && k < cells_[2]))
      return false;
    const auto z = static_cast<std::size_t>(k);
    return (near_[column(static_cast<int>(i), static_cast<int>(j)) * words_ + z / 64] >> (z % 64) &
            1) != 0;
  }

 private:
  static std::size_t at_(int d) { return static_cast<std::size_t>(d); }
  template <class Use>
  static void for_liquid(const SphColumns& of, const Use& use) {
    for (std::size_t k = 0; k < of.size(); ++k)
      if (of.kind[k] == ClusterLists::Liquid && of.label[k] != ClusterLists::none) use(k);
  }
  /// Cells of a row and its periodic images.
  template <class Use>
  void for_cells(const SphRow& r, const Repeats& repeats, bool plane, const Use& use) const {
    const auto of_images = [&](double x, int d, int(&out)[3]) {
      int n = 0;
      for (const int image : {0, -1, 1}) {
        if (image != 0 && !(repeats.along(d) > 0)) break;
        const double at = (x + image * repeats.along(d) - low_[at_(d)]) / cell_;
        if (at >= 0 && at < cells_[at_(d)]) out[n++] = static_cast<int>(at);
      }
      return n;
    };
    int i[3], j[3]{}, z[3];
    const int ni = of_images(r.x, 0, i), nj = plane ? 1 : of_images(r.y, 1, j),
              nz = of_images(r.z, 2, z);
    for (int a = 0; a < ni; ++a)
      for (int b = 0; b < nj; ++b)
        for (int c = 0; c < nz; ++c) use(i[a], j[b], z[c]);
  }
  std::size_t column(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(cells_[1]) +
           static_cast<std::size_t>(j);
  }
  std::size_t columns() const {
    return static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]);
  }
  void lay(const SphColumns& of, const Repeats& repeats, double reach, double spacing, bool plane) {
    Box all;
    std::size_t n = 0;
    for_liquid(of, [&](std::size_t k) { all.include(of.rows[k].position()), ++n; });
    if (n == 0) all = {{0, 0, 0}, {0, 0, 0}};
    const double from[3] = {all.min.x, all.min.y, all.min.z},
                 to[3] = {all.max.x, all.max.y, all.max.z};
    const double most = 64 * static_cast<double>(n) + 1e6;
    // Coarser if little liquid is spread over a large space.
    for (cell_ = 0.5 * spacing;; cell_ *= 2) {
      double cells = 1;
      for (int d = 0; d < 3; ++d) {
        const bool round = repeats.along(d) > 0;
        low_[at_(d)] = (round ? repeats.from(d) : from[d]) - reach;
        const double end = (round ? repeats.from(d) + repeats.along(d) : to[d]) + reach;
        const double count = plane && d == 1 ? 1 : std::floor((end - low_[at_(d)]) / cell_) + 1;
        cells *= count, cells_[at_(d)] = static_cast<int>(std::min(count, 1e9));
      }
      if (cells < most) break;
    }
    words_ = (static_cast<std::size_t>(cells_[2]) + 63) / 64;
  }
  /// use(column, cells up and down) for columns around (i, j) whose nearest points are within
  /// reach.
  template <class Use>
  void for_columns(int i, int j, double reach, bool plane, const Use& use) const {
    const auto apart = [](int k) { return static_cast<double>(std::max(std::abs(k) - 1, 0)); };
    const int most = static_cast<int>(reach / cell_) + 1, across = plane ? 0 : most;
    for (int a = std::max(i - most, 0); a <= std::min(i + most, cells_[0] - 1); ++a)
      for (int b = std::max(j - across, 0); b <= std::min(j + across, cells_[1] - 1); ++b) {
        const double x = cell_ * apart(a - i), y = cell_ * apart(b - j),
                     left = reach * reach - x * x - y * y;
        if (left >= 0) use(column(a, b), static_cast<int>(std::sqrt(left) / cell_) + 1);
      }
  }
  void add_ball(int i, int j, int z, double reach, bool plane) {
    for_columns(i, j, reach, plane, [&](std::size_t c, int up) {
      for (int at = std::max(z - up, 0); at <= std::min(z + up, cells_[2] - 1); ++at)
        near_[c * words_ + static_cast<std::size_t>(at) / 64] |= std::uint64_t{1} << (at % 64);
    });
  }
  void spread(double reach, bool plane, const Team& team) {
    const auto up = static_cast<std::size_t>(reach / cell_) + 2, all = columns() * words_;
    tall_.assign(up * all, 0);  // dilated along z by 0, 1, ... cells
    near_.assign(all, 0);
    team.for_ranges(columns(), 16, [&](std::size_t, std::size_t first, std::size_t last) {
      for (std::size_t c = first * words_; c < last * words_; ++c) tall_[c] = wet_[c];
      for (std::size_t k = 1; k < up; ++k)
        for (std::size_t c = first; c < last; ++c)
          for (std::size_t w = 0; w < words_; ++w) {
            const std::uint64_t* const of = &tall_[(k - 1) * all + c * words_];
            const std::uint64_t below = w > 0 ? of[w - 1] >> 63 : 0,
                                above = w + 1 < words_ ? of[w + 1] << 63 : 0;
            tall_[k * all + c * words_ + w] = of[w] | of[w] << 1 | below | of[w] >> 1 | above;
          }
    });
    team.for_ranges(columns(), 16, [&](std::size_t, std::size_t first, std::size_t last) {
      for (std::size_t c = first; c < last; ++c)
        for_columns(
            static_cast<int>(c / static_cast<std::size_t>(cells_[1])),
            static_cast<int>(c % static_cast<std::size_t>(cells_[1])), reach, plane,
            [&](std::size_t other, int k) {
              if (filled_[other] == 0) return;
              const std::uint64_t* const from =
                  &tall_[std::min(static_cast<std::size_t>(k), up - 1) * all + other * words_];
              for (std::size_t w = 0; w < words_; ++w) near_[c * words_ + w] |= from[w];
            });
    });
  }

  std::array<double, 3> low_{};
  std::array<int, 3> cells_{1, 1, 1};
  double cell_ = 1;
  std::size_t words_ = 1;
  DynArray<std::uint64_t> wet_, tall_, near_{0};
  DynArray<char> filled_;      // whether a column has a wet cell
  DynArray<std::size_t> far_;  // rows that reach farther than others
};

}  // namespace silt::detail
