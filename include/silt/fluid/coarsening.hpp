// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/level.hpp>
#include <silt/fluid/level_rows.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Adds d of row (j, k) to that of a coarser row, in the order of i. d represents conductances to
/// values beyond faces, at twice the distance from a coarser cell's centre. The faces are unknown,
/// but they are closed ones; each direction is weighted by its share of closed faces. Without
/// closed faces d belongs to a volume and is summed.
SILT_ONE_COPY void add_diagonal(const Level& fine, int j, int k, float* to) {
  if (!fine.row_has_d[fine.row_number(j, k)]) return;
  const FaceRows a = fine.faces(j, k);
  for (int i = 0; i < fine.n[0]; ++i) {
    const Sides side(i % 2, fine.half);
    const std::ptrdiff_t at = side.own + i / 2;
    if (!(a.diagonal[at] > 0)) continue;
    const std::array<int, 3> cell{i, j, k};
    const std::array<int, 3> closed{(a.x[at] == 0) + (a.x[side.upper + i / 2] == 0),
                                    (a.y_low[at] == 0) + (a.y_up[at] == 0),
                                    (a.z_low[at] == 0) + (a.z_up[at] == 0)};
    int all = 0, farther = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (fine.n[c] == 1) continue;
      const bool paired = fine.halved[c] && (fine.n[c] % 2 == 0 || cell[c] + 1 < fine.n[c]);
      all += closed[c];
      farther += paired ? closed[c] : 0;
    }
    const float share = all > 0 ? static_cast<float>(farther) / static_cast<float>(all) : 0.0f;
    to[fine.halved[0] ? i / 2 : i] += a.diagonal[at] * (1 - 0.5f * share);
  }
}

/// Coefficients of a coarser level from those of the finer one: the mean over the fine faces
/// covered by a coarse one, times its area over its longer distance.
inline void coarsen_coefficients(const Team& team, const Level& fine, Level& coarse) {
  const std::array<int, 3> by{fine.halved[0] ? 2 : 1, fine.halved[1] ? 2 : 1,
                              fine.halved[2] ? 2 : 1};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < coarse.width[c].size(); ++i) {
      coarse.width[c][i] = 0;
      for (std::size_t m = static_cast<std::size_t>(by[c]) * i;
           m < std::min(fine.width[c].size(), static_cast<std::size_t>(by[c]) * (i + 1)); ++m)
        coarse.width[c][i] += fine.width[c][m];
    }
  DynArray<float> ratio_x(static_cast<std::size_t>(coarse.n[0]));
  for (int i = 0; i < coarse.n[0]; ++i)
    ratio_x[static_cast<std::size_t>(i)] = fine.distance(0, by[0] * i) / coarse.distance(0, i);
  team.for_parts(static_cast<std::size_t>(coarse.n[2]), [&](std::size_t plane) {
    const int k = static_cast<int>(plane);
    const float ratio_z = fine.distance(2, by[2] * k) / coarse.distance(2, k);
    std::array<double, 3> sums{};
    const int n = coarse.n[0];
    DynArray<float> rows(4 * static_cast<std::size_t>(n));  // in the order of i
    float *ax = rows.data(), *ay = ax + n, *az = ay + n, *d = az + n;
    for (int j = 0; j < coarse.n[1]; ++j) {
      const float ratio_y = fine.distance(1, by[1] * j) / coarse.distance(1, j);
      std::fill(rows.begin(), rows.end(), 0.0f);
      const auto add_both = [&](const float* even, float* to) {  // of the cells of even and odd i
        const float* odd = even + fine.half;
        for (int m = 0; m < fine.n[0] / 2; ++m) to[m] += even[m] + odd[m];
        if (fine.n[0] % 2 == 1) to[n - 1] += even[n - 1];
      };
      const auto add_even = [&](const float* even, float* to) {
        for (int m = 0; m < n; ++m) to[m] += even[m];
      };
      const auto add_each = [&](const float* even, float* to) {
        for (int i = 0; i < n; ++i) to[i] += even[i / 2 + (i % 2) * fine.half];
      };
      for (int fk = by[2] * k; fk < std::min(fine.n[2], by[2] * (k + 1)); ++fk)
        for (int fj = by[1] * j; fj < std::min(fine.n[1], by[1] * (j + 1)); ++fj) {
          const std::size_t from = fine.begin(fj, fk);
          const auto add = [&](const LevelArray<float>& of, float* to) {
            by[0] == 2 ? add_both(of.data() + from, to) : add_each(of.data() + from, to);
          };
          if (by[0] == 2)
            add_even(fine.a[0].data() + from, ax);
          else
            add_each(fine.a[0].data() + from, ax);
          if (fj == by[1] * j) add(fine.a[1], ay);
          if (fk == by[2] * k) add(fine.a[2], az);
          add_diagonal(fine, fj, fk, d);
        }
      for (int i = 0; i < n; ++i) {
        ax[i] *= n > 1 ? ratio_x[static_cast<std::size_t>(i)] : 0.0f;
        ay[i] *= coarse.n[1] > 1 ? ratio_y : 0.0f;
        az[i] *= coarse.n[2] > 1 ? ratio_z : 0.0f;
        sums[0] += static_cast<double>(ax[i]);
        sums[1] += static_cast<double>(ay[i]);
        sums[2] += static_cast<double>(az[i]);
      }
      const std::size_t at = coarse.begin(j, k);
      split_halves(n, ax, coarse.a[0].data() + at, coarse.half);
      split_halves(n, ay, coarse.a[1].data() + at, coarse.half);
      split_halves(n, az, coarse.a[2].data() + at, coarse.half);
      split_halves(n, d, coarse.d.data() + at, coarse.half);
      coarse.wrap_row(coarse.a[0].data() + at);
    }
    coarse.plane_sums[plane] = sums;
  });
  team.for_parts(static_cast<std::size_t>(coarse.n[2]),
                 [&](std::size_t k) { coarse.invert_diagonal(static_cast<int>(k)); });
}

/// Directions to halve: that of the strongest coupling and those not much weaker. None if one cell
/// is left.
inline std::array<bool, 3> directions_to_halve(const Level& level) {
  constexpr double much_weaker = 0.3;
  std::array<double, 3> sum{};
  for (const auto& plane : level.plane_sums)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += plane[c];
  double strongest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] *= static_cast<double>(level.n[c]) / std::max(1, level.n[c] - !level.wraps[c]);
    if (level.n[c] > 1) strongest = std::max(strongest, sum[c]);
  }
  std::array<bool, 3> halved{};
  for (std::size_t c = 0; c < 3; ++c)
    halved[c] = level.n[c] > 1 && sum[c] >= much_weaker * strongest;
  return halved;
}

}  // namespace silt::inline SILT_TARGET::fluid_detail
