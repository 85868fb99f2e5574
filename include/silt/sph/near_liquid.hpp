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
/// cell of half a spacing. Cells with liquid are dilated by a sphere, all by the same one, and the
/// few fast particles that reach farther each by its own.
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
  using Squared = std::uint16_t;
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
  /// Cells whose nearest points are within reach of one.
  void add_ball(int i, int j, int z, double reach, bool plane) {
    const auto apart = [](int k) { return static_cast<double>(std::max(std::abs(k) - 1, 0)); };
    const int most = static_cast<int>(reach / cell_) + 1, across = plane ? 0 : most;
    for (int a = std::max(i - most, 0); a <= std::min(i + most, cells_[0] - 1); ++a)
      for (int b = std::max(j - across, 0); b <= std::min(j + across, cells_[1] - 1); ++b) {
        const double x = cell_ * apart(a - i), y = cell_ * apart(b - j),
                     left = reach * reach - x * x - y * y;
        if (!(left >= 0)) continue;
        const int up = static_cast<int>(std::sqrt(left) / cell_) + 1;
        for (int at = std::max(z - up, 0); at <= std::min(z + up, cells_[2] - 1); ++at)
          near_[column(a, b) * words_ + static_cast<std::size_t>(at) / 64] |= std::uint64_t{1}
                                                                              << (at % 64);
      }
  }
  /// ... of all: the smallest squared distance in cells, first
  /// along z, then with those of the neighbours along y, then along x.
  void spread(double reach, bool plane, const Team& team) {
    const double cells = reach / cell_;
    const int most = static_cast<int>(cells) + 1, across = plane ? 0 : most;
    const auto limit = static_cast<Squared>(std::min(cells * cells + 1e-6, 3e4)),
               beyond = Squared(limit + 1);
    const auto cost = [](int k) { return static_cast<Squared>(k > 1 ? (k - 1) * (k - 1) : 0); };
    const int ni = cells_[0], nj = cells_[1];
    const std::size_t tall = 64 * words_;
    along_y_.resize(columns() * tall), slab_.resize(columns());
    near_.assign(columns() * words_, 0);
    const auto least = [tall](Squared* to, const Squared* from, Squared more) {
      for (std::size_t z = 0; z < tall; ++z)
        to[z] = std::min(to[z], static_cast<Squared>(from[z] + more));
    };
    team.for_parts(static_cast<std::size_t>(ni), [&](std::size_t slab) {
      DynArray<Squared> along_z(static_cast<std::size_t>(nj) * tall);
      const std::size_t first = slab * static_cast<std::size_t>(nj);
      for (std::size_t j = 0; j < static_cast<std::size_t>(nj); ++j)
        if (filled_[first + j] != 0) go_along_z(first + j, cost, beyond, most, &along_z[j * tall]);
      for (int j = 0; j < nj; ++j) {
        const std::size_t c = first + static_cast<std::size_t>(j);
        Squared* const to = &along_y_[c * tall];
        std::fill_n(to, tall, beyond), slab_[c] = 0;
        for (int b = std::max(j - across, 0); b <= std::min(j + across, nj - 1); ++b)
          if (filled_[first + static_cast<std::size_t>(b)] != 0)
            least(to, &along_z[static_cast<std::size_t>(b) * tall], cost(std::abs(b - j))),
                slab_[c] = 1;
      }
    });
    team.for_parts(static_cast<std::size_t>(ni), [&](std::size_t part) {
      const int i = static_cast<int>(part);
      DynArray<Squared> of(tall);
      for (int j = 0; j < nj; ++j) {
        std::fill_n(of.data(), tall, beyond);
        for (int a = std::max(i - most, 0); a <= std::min(i + most, ni - 1); ++a)
          if (const std::size_t c = column(a, j); slab_[c] != 0)
            least(of.data(), &along_y_[c * tall], cost(std::abs(a - i)));
        std::uint64_t* const bits = &near_[column(i, j) * words_];
        for (std::size_t z = 0; z < tall; ++z)
          bits[z / 64] |= std::uint64_t{of[z] <= limit} << (z % 64);
      }
    });
  }
  /// Squared distances along z from the wet cells of a column.
  template <class Cost>
  void go_along_z(std::size_t c, const Cost& cost, Squared beyond, int most, Squared* to) const {
    const int tall = static_cast<int>(64 * words_);
    const auto is_wet = [&](int z) {
      return (wet_[c * words_ + static_cast<std::size_t>(z) / 64] >> (z % 64) & 1) != 0;
    };
    for (int z = 0, d = most + 1; z < tall; ++z)
      d = is_wet(z) ? 0 : std::min(d + 1, most + 1), to[z] = d > most ? beyond : cost(d);
    for (int z = tall - 1, d = most + 1; z >= 0; --z) {
      d = is_wet(z) ? 0 : std::min(d + 1, most + 1);
      if (d <= most) to[z] = std::min(to[z], cost(d));
    }
  }

  std::array<double, 3> low_{};
  std::array<int, 3> cells_{1, 1, 1};
  double cell_ = 1;
  std::size_t words_ = 1;
  DynArray<std::uint64_t> wet_, near_{0};
  DynArray<char> filled_, slab_;  // whether a column has a wet cell, and one of those along y
  DynArray<Squared> along_y_;     // [-] in cells
  DynArray<std::size_t> far_;     // rows that reach farther than others
};

}  // namespace silt::detail
