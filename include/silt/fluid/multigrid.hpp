// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/coarsening.hpp>
#include <silt/fluid/level.hpp>
#include <silt/fluid/level_rows.hpp>
#include <silt/fluid/plane_sweeps.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// One V-cycle of geometric multigrid as a symmetric preconditioner of conjugate gradients:
/// red-black Gauss-Seidel, `sweeps` times before (red, black) and after (black, red) the coarser
/// level, piecewise constant transfer, levels of half the cells down to one cell. All in float.
class Multigrid {
 public:
  static constexpr int sweeps = 2;  // before and after the coarser level [-]

  Multigrid(const std::array<int, 3>& cells, const std::array<bool, 3>& wraps) {
    levels_.emplace_back(cells, wraps);
  }
  Level& finest() { return levels_.front(); }
  const Level& finest() const { return levels_.front(); }
  std::size_t levels() const { return levels_.size(); }
  const Level& level(std::size_t l) const { return levels_[l]; }

  /// Sets unknowns and right-hand sides of all levels to 0.
  void forget() {
    for (Level& level : levels_) level.x.clear(), level.r.clear();
  }

  /// Makes the coarser levels from the coefficients of the finest.
  void coarsen(const Team& team) {
    for (std::size_t l = 0;; ++l) {
      const auto halved = directions_to_halve(levels_[l]);
      const bool last = !halved[0] && !halved[1] && !halved[2];
      if (last || levels_[l].halved != halved)
        levels_.erase(levels_.begin() + static_cast<std::ptrdiff_t>(l) + 1, levels_.end());
      levels_[l].halved = halved;
      if (last) break;
      if (l + 1 == levels_.size()) {
        auto n = levels_[l].n;
        for (std::size_t c = 0; c < 3; ++c)
          if (halved[c]) n[c] = (n[c] + 1) / 2;
        levels_.emplace_back(n, levels_[l].wraps);
      }
      coarsen_coefficients(team_for(l + 1, team), levels_[l], levels_[l + 1]);
    }
  }

  /// x of the finest level from its r; returns x . r.
  double cycle(const Team& team) {
    plane_dots_.assign(static_cast<std::size_t>(finest().n[2]), 0.0);
    cycle(0, team);
    double sum = 0;
    for (const double part : plane_dots_) sum += part;
    return sum;
  }

 private:
  /// Small levels run without threads.
  const Team& team_for(std::size_t l, const Team& team) const {
    const auto& n = levels_[l].n;
    return static_cast<double>(n[0]) * n[1] * n[2] < 8192 ? alone_ : team;
  }

  void cycle(std::size_t l, const Team& given) {
    Level& level = levels_[l];
    const Team& team = team_for(l, given);
    const bool last = l + 1 == levels_.size();
    const int n1 = level.n[1], n2 = level.n[2];
    const bool fused = !last && team.threads() == 1 && !level.wraps[2];
    PlaneSweeps order{n2,
                      n1,
                      2 * sweeps + fused,
                      6 * sizeof(float) * level.stride,
                      level.wraps[2],
                      level.wraps[1]};
    // If cells of one colour are coupled across a seam, the first sweep is not r / diagonal.
    const bool seam = level.has_seam();
    if (seam) level.x.clear();
    sweep_planes(team, order, [&](int s, int k, int from, int to) {
      if (s == 0 && !seam)
        relax_rows_from_zero(level, k, from, to);
      else if (s < 2 * sweeps)
        relax_rows(level, s, k, from, to, false);
      else if (!level.halved[2] || k % 2 == 1 || k + 1 == n2)
        for (int j = from; j < to; ++j)
          if (!level.halved[1] || j % 2 == 1 || j + 1 == n1)
            restrict_row(level, levels_[l + 1], level.halved[1] ? j / 2 : j,
                         level.halved[2] ? k / 2 : k);
    });
    if (!last) {
      Level& coarse = levels_[l + 1];
      if (!fused)
        team.for_parts(static_cast<std::size_t>(coarse.n[2]), [&](std::size_t k) {
          for (int j = 0; j < coarse.n[1]; ++j) restrict_row(level, coarse, j, static_cast<int>(k));
        });
      cycle(l + 1, given);
    }
    order.stages = 2 * sweeps + 1;
    order.backward = true;
    sweep_planes(team, order, [&](int s, int k, int from, int to) {
      if (s == 0) {
        if (!last) correct_rows(levels_[l + 1], level, k, from, to);
        return;
      }
      relax_rows(level, s, k, from, to, true);
      if (l == 0 && s == 2 * sweeps)
        for (int j = from; j < to; ++j)
          plane_dots_[static_cast<std::size_t>(k)] += dot_row(
              level.stride, level.x.data() + level.begin(j, k), level.r.data() + level.begin(j, k));
    });
  }

  /// Relaxes the cells of the stage's colour (even stages: i + j + k even) of rows of plane k. The
  /// last cell of an odd number, coupled with the first of the same colour, is processed after it,
  /// or before it if `after`: in parallel they would exchange their errors.
  static void relax_rows(Level& level, int stage, int k, int from, int to, bool after) {
    const bool seam = level.wraps[0] && level.n[0] % 2 == 1 && level.n[0] > 1;
    for (int row = from; row < to; ++row) {
      const int j = after ? from + to - 1 - row : row, h = (j + k + stage) & 1;
      const std::size_t at = level.begin(j, k);
      const float *const inverse = level.inverse.data() + at, *const r = level.r.data() + at;
      const FaceRows faces = level.faces(j, k);
      const NeighbourRows<float> x = level.neighbours(level.x.data(), j, k);
      relax_row(level.n[0], h, level.half, faces, inverse, r, x);
      level.wrap_row(x.at);
      if (!seam || h == 1) continue;
      relax_cell(after ? 0 : level.n[0] / 2, level.half, faces, inverse, r, x);
      level.wrap_row(x.at);
    }
  }
  static void relax_rows_from_zero(Level& level, int k, int from, int to) {
    for (int j = from; j < to; ++j) {
      const std::size_t at = level.begin(j, k);
      float* x = level.x.data() + at;
      relax_row_from_zero(level.n[0], (j + k) & 1, level.half, level.inverse.data() + at,
                          level.r.data() + at, x);
      level.wrap_row(x);
    }
  }

  static constexpr int chunk = 256;

  /// Calls what(h) for the halves of row (j, k) with cells of even i + j + k. The others need no
  /// transfer: the sweep before leaves no residual there, and the sweep after overwrites them. Not
  /// so at a seam.
  template <class What>
  static void for_halves(const Level& level, int j, int k, const What& what) {
    const int h = (j + k) & 1;
    what(h);
    if (level.has_seam()) what(1 - h);
  }

  /// r of row (j, k) of the coarser level: the sum of the fine residuals.
  static void restrict_row(const Level& fine, Level& coarse, int j, int k) {
    alignas(64) float sums[2][chunk];
    const int by_x = fine.halved[0] ? 2 : 1, by_y = fine.halved[1] ? 2 : 1,
              by_z = fine.halved[2] ? 2 : 1;
    float* r = coarse.r.data() + coarse.begin(j, k);
    const int most = cells_of_half(fine.n[0], 0), odd = cells_of_half(fine.n[0], 1);
    for (int from = 0; from < most; from += chunk) {
      const int count = std::min(chunk, most - from);
      const int packs = (count + lanes - 1) / lanes * lanes;
      for (auto& sum : sums) std::fill(sum, sum + packs, 0.0f);
      for (int fk = by_z * k; fk < std::min(fine.n[2], by_z * (k + 1)); ++fk)
        for (int fj = by_y * j; fj < std::min(fine.n[1], by_y * (j + 1)); ++fj)
          for_halves(fine, fj, fk, [&](int h) {
            float* sum = sums[by_x == 2 ? 0 : h];
            const float last = sum[count - 1];
            add_residual(from, packs, Sides(h, fine.half), fine.faces(fj, fk),
                         fine.r.data() + fine.begin(fj, fk), fine.neighbours(fine.x.data(), fj, fk),
                         sum);
            if (h == 1 && odd < from + count) sum[count - 1] = last;  // there is no such cell
          });
      if (by_x == 2) {
        split_halves(count, sums[0], r + from / 2, coarse.half);
      } else {
        std::copy(sums[0], sums[0] + count, r + from);
        std::copy(sums[1], sums[1] + std::min(count, odd - from), r + coarse.half + from);
      }
    }
  }

  /// Adds the coarser level's x to rows of plane k.
  static void correct_rows(const Level& coarse, Level& fine, int k, int first, int end) {
    alignas(64) float joined[chunk];
    const int coarse_k = fine.halved[2] ? k / 2 : k;
    const int most = cells_of_half(fine.n[0], 0);
    for (int from = 0; from < most; from += chunk) {
      const int count = std::min(chunk, most - from);
      const int packs = (count + lanes - 1) / lanes * lanes;
      int held = -1;
      for (int j = first; j < end; ++j) {
        const int coarse_j = fine.halved[1] ? j / 2 : j;
        const float* e = coarse.x.data() + coarse.begin(coarse_j, coarse_k);
        if (fine.halved[0] && coarse_j != held) {
          join_halves(count, e + from / 2, coarse.half, joined);
          std::fill(joined + count, joined + packs, 0.0f);
          held = coarse_j;
        }
        float* x = fine.x.data() + fine.begin(j, k);
        for_halves(fine, j, k, [&](int h) {
          float* own = x + Sides(h, fine.half).own + from;
          const float* add = fine.halved[0] ? joined : e + Sides(h, coarse.half).own + from;
          for (int m = 0; m < packs; m += lanes)
            store(own + m, load<Pack>(own + m) + load<Pack>(add + m));
        });
        if (from + count == most) fine.wrap_row(x);
      }
    }
  }

  DynArray<Level> levels_;
  DynArray<double> plane_dots_;
  Team alone_{1};
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
