// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/core/storage.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/level_rows.hpp>
#include <silt/fluid/plane_sweeps.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Values of a level. Arrays begin at other places of a page each: a kernel reads a dozen at the
/// same place, and at one place of all pages a first-level cache holds eight lines or so.
template <class Scalar>
class LevelArray {
 public:
  LevelArray() = default;
  /// `number` of the array in the level.
  LevelArray(std::size_t values, std::size_t number)
      : skip_(number * 9 * 64 / sizeof(Scalar)), values_(values + skip_, Scalar(0)) {}
  Scalar* data() { return values_.data() + skip_; }
  const Scalar* data() const { return values_.data() + skip_; }
  Scalar& operator[](std::size_t i) { return values_[skip_ + i]; }
  Scalar operator[](std::size_t i) const { return values_[skip_ + i]; }
  void clear() { std::fill(values_.begin(), values_.end(), Scalar(0)); }

 private:
  std::size_t skip_ = 0;
  AlignedVector<Scalar> values_;
};

/// One grid of the multigrid: coefficients of faces and cells, unknown and right side, in float.
///
/// Every direction wraps; where the grid does not, the faces of index 0 are closed (a = 0).
struct Level {
  std::array<int, 3> n{};                   // cells [-]
  std::array<bool, 3> wraps{};              // the last cell is coupled with the first
  std::array<bool, 3> halved{};             // directions in which the next level has half the cells
  std::array<std::vector<float>, 3> width;  // of the cells, in those of the finest [-]
  std::array<LevelArray<float>, 3> a;       // coefficients of the lower faces
  LevelArray<float> d, inverse, x, r;       // diagonal, 1 / (sum a + d) or 0, unknown, right side
  std::vector<std::uint8_t> row_has_d;
  std::vector<std::array<double, 3>> plane_sums;  // of a over each plane
  std::ptrdiff_t half = 0;            // from the cells of even i of a row to those of odd i
  std::size_t stride = 0, plane = 0;  // from row to row, from plane to plane

  Level(const std::array<int, 3>& cells, const std::array<bool, 3>& wrap) : n(cells), wraps(wrap) {
    const std::size_t most = pieces(static_cast<std::size_t>(n[0] + 1) / 2, room) * room;
    half = static_cast<std::ptrdiff_t>(most) + room;  // between them i = n and, from behind, i = -1
    stride = 2 * most + room;
    constexpr std::size_t page = 1024, apart = 21 * 16;  // floats; see LevelArray
    plane = stride * static_cast<std::size_t>(n[1]);
    if (n[1] > 1 && n[2] > 1) plane += (page + apart - plane % page) % page;
    const std::size_t rows = static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]);
    for (std::size_t c = 0; c < 3; ++c) {
      a[c] = {values(), c};
      width[c].assign(static_cast<std::size_t>(n[c]), 1.0f);
    }
    d = {values(), 6};
    inverse = {values(), 3};
    x = {values(), 4};
    r = {values(), 5};
    row_has_d.assign(rows, 0);
    plane_sums.assign(static_cast<std::size_t>(n[2]), {});
  }
  static std::size_t pieces(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
  }
  std::size_t values() const { return plane * static_cast<std::size_t>(n[2]) + 2 * room; }
  std::size_t row_number(int j, int k) const {
    return static_cast<std::size_t>(j) +
           static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(k);
  }
  std::size_t begin(int j, int k) const {
    return room + stride * static_cast<std::size_t>(j) + plane * static_cast<std::size_t>(k);
  }
  std::size_t index(int i, int j, int k) const {
    return begin(j, k) + static_cast<std::size_t>(i / 2 + (i % 2) * half);
  }
  /// Cells of one colour are coupled: the last with the first of an odd number.
  bool has_seam() const {
    return (wraps[0] && n[0] % 2 == 1) || (wraps[1] && n[1] % 2 == 1) ||
           (wraps[2] && n[2] % 2 == 1);
  }
  int after(int c, int i) const { return i + 1 == n[static_cast<std::size_t>(c)] ? 0 : i + 1; }
  int before(int c, int i) const { return (i == 0 ? n[static_cast<std::size_t>(c)] : i) - 1; }

  FaceRows faces(int j, int k) const {
    const std::size_t at = begin(j, k);
    return {a[0].data() + at,
            a[1].data() + at,
            a[1].data() + begin(after(1, j), k),
            a[2].data() + at,
            a[2].data() + begin(j, after(2, k)),
            row_has_d[row_number(j, k)] ? d.data() + at : nullptr};
  }
  template <class Float>
  NeighbourRows<Float> neighbours(Float* v, int j, int k) const {
    return {v + begin(j, k), v + begin(before(1, j), k), v + begin(after(1, j), k),
            v + begin(j, before(2, k)), v + begin(j, after(2, k))};
  }
  /// Copies what stands at the other end of a row.
  void wrap_row(float* row) const {
    if (!wraps[0]) return;
    const int last = n[0] - 1;
    row[half - 1] = row[last / 2 + (last % 2) * half];
    row[n[0] / 2 + (n[0] % 2) * half] = row[0];
  }
  /// How much a coarser face is further from centre to centre than the finer one i.
  float distance(std::size_t c, int i) const {
    const auto at = [&](int of) { return width[c][static_cast<std::size_t>(of)]; };
    return 0.5f * (at(i) + at(before(static_cast<int>(c), i)));
  }
  /// From a and d of plane k and of the next: the inverse of the whole diagonal.
  void invert_diagonal(int k) {
    for (int j = 0; j < n[1]; ++j) {
      const FaceRows f = faces(j, k);
      const float* own = d.data() + begin(j, k);
      float* out = inverse.data() + begin(j, k);
      bool any = false;
      for (const int h : {0, 1}) {
        const Sides side(h, half);
        for (int m = 0; m < cells_of_half(n[0], h); ++m) {
          const std::ptrdiff_t i = side.own + m;
          const float sum = (f.x[i] + f.x[side.upper + m]) + (f.y_low[i] + f.y_up[i]) +
                            (f.z_low[i] + f.z_up[i]) + own[i];
          any |= own[i] > 0;
          out[i] = sum > 0 ? 1 / sum : 0.0f;
        }
      }
      row_has_d[row_number(j, k)] = any;
    }
  }
};

/// Adds d of row (j, k) to that of a coarser row, in the order of i. d stands for conductances to
/// values beyond faces, twice as far from a coarser cell's centre: which faces is not known, but
/// they are closed ones, and a direction counts by its share of those. Where no face is closed, d
/// is a volume's and is summed.
inline void add_diagonal(const Level& fine, int j, int k, float* to) {
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

/// The coefficients of a coarser level from those of the finer one: the mean over the finer faces
/// that a coarser one covers, times its area over its longer distance.
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
  std::vector<float> ratio_x(static_cast<std::size_t>(coarse.n[0]));
  for (int i = 0; i < coarse.n[0]; ++i)
    ratio_x[static_cast<std::size_t>(i)] = fine.distance(0, by[0] * i) / coarse.distance(0, i);
  team.for_parts(static_cast<std::size_t>(coarse.n[2]), [&](std::size_t plane) {
    const int k = static_cast<int>(plane);
    const float ratio_z = fine.distance(2, by[2] * k) / coarse.distance(2, k);
    std::array<double, 3> sums{};
    const int n = coarse.n[0];
    std::vector<float> rows(4 * static_cast<std::size_t>(n));  // in the order of i
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

/// Directions to halve: the one of the strongest couplings and those not much weaker. None where
/// one cell is left.
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

/// One V-cycle of geometric multigrid as the symmetric preconditioner of conjugate gradients:
/// red-black Gauss-Seidel, `sweeps` times before (red, black) and after (black, red), piecewise
/// constant transfer, levels of half the cells down to one cell. Float throughout.
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

  /// Makes the coarser levels, once the finest has its coefficients.
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
  /// Small levels are not worth waking threads for.
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
    // Where cells of one colour are coupled across a seam the first sweep is not r / diagonal.
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

  /// Relaxes the cells of the stage's colour (even stages: i + j + k even) of rows of plane k.
  static void relax_rows(Level& level, int stage, int k, int from, int to, bool after) {
    for (int row = from; row < to; ++row) {
      const int j = after ? from + to - 1 - row : row;
      const std::size_t at = level.begin(j, k);
      relax_row(level.n[0], (j + k + stage) & 1, level.half, level.faces(j, k),
                level.inverse.data() + at, level.r.data() + at,
                level.neighbours(level.x.data(), j, k));
      level.wrap_row(level.x.data() + at);
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

  /// Calls what(h) for the halves of row (j, k) that hold cells of even i + j + k. The others need
  /// no transfer: the sweep before it left them no residual, the sweep after it sets them anew
  /// whatever they are. Not so at a seam.
  template <class What>
  static void for_halves(const Level& level, int j, int k, const What& what) {
    const int h = (j + k) & 1;
    what(h);
    if (level.has_seam()) what(1 - h);
  }

  /// r of row (j, k) of the coarser level: the sum of the finer residuals.
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

  std::vector<Level> levels_;
  std::vector<double> plane_dots_;
  Team alone_{1};
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
