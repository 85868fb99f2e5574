// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <silt/core/lanes.hpp>
#include <silt/core/target.hpp>
#include <silt/fluid/level_rows.hpp>

/// Operations on single rows of the flow solver's fields in double, and conversions from the float
/// fields of the multigrid.
namespace silt::inline SILT_TARGET::fluid_detail {

using PackD = Lanes<DefaultArch>::Real;
inline constexpr int lanes_d = static_cast<int>(Lanes<DefaultArch>::width);

/// u . v of n values.
SILT_ONE_COPY double dot_row(int n, const double* u, const double* v) {
  PackD sum(0.0);
  int i = 0;
  for (; i + lanes_d <= n; i += lanes_d) sum += load<PackD>(u + i) * load<PackD>(v + i);
  double total = sum_of(sum);
  for (; i < n; ++i) total += u[i] * v[i];
  return total;
}

/// to = scale from; also returns properties of `from`: adds its scaled sum, finds the largest value
/// and whether all are finite and not negative. `first_closed`: the first counts as 0.
SILT_ONE_COPY void convert_row(int n, bool first_closed, double scale,
                               const double* __restrict from, float* __restrict to, double& sum,
                               double& largest, bool& valid) {
  // Separate sums and extremes per lane, which allows vectorisation.
  constexpr int wide = 8;
  double sums[wide] = {}, high[wide] = {}, low[wide] = {};
  bool number[wide];
  for (bool& b : number) b = true;
  const auto take = [&](int i, int lane, double v) {
    sums[lane] += v;
    high[lane] = high[lane] < v ? v : high[lane];
    low[lane] = v < low[lane] ? v : low[lane];
    number[lane] = number[lane] & (v == v);
    to[i] = static_cast<float>(v * scale);
  };
  int i = 0;
  if (first_closed) {
    for (; i < std::min(n, wide); ++i) take(i, i, i == 0 ? 0.0 : from[i]);
  }
  for (; i + wide <= n; i += wide)
    for (int lane = 0; lane < wide; ++lane) take(i + lane, lane, from[i + lane]);
  for (int lane = 0; i < n; ++i, ++lane) take(i, lane, from[i]);
  for (int lane = 0; lane < wide; ++lane) {
    sum += sums[lane] * scale;
    largest = std::max(largest, high[lane]);
    valid =
        valid && number[lane] && low[lane] >= 0 && high[lane] <= std::numeric_limits<double>::max();
  }
}

/// Marks the open faces of the n cells of a row, whose ax, ay, az and d are consecutive in `rows`;
/// returns whether any mark changed.
inline bool mark_openings(int n, const float* __restrict rows, std::uint8_t* __restrict open) {
  const float *ax = rows, *ay = ax + n, *az = ay + n, *d = az + n;
  std::uint8_t changed = 0;
  for (int i = 0; i < n; ++i) {
    const auto marks = static_cast<std::uint8_t>((ax[i] > 0 ? 1 : 0) | (ay[i] > 0 ? 2 : 0) |
                                                 (az[i] > 0 ? 4 : 0) | (d[i] > 0 ? 8 : 0));
    changed = static_cast<std::uint8_t>(changed | (marks ^ open[i]));
    open[i] = marks;
  }
  return changed != 0;
}

/// Row (j, k) of A p = b: coefficients and unknowns of the row and of its neighbours in y and z
/// (below, above, below, above). Coefficients of closed sides may be null.
struct DoubleRows {
  const double* ax;
  std::array<const double*, 4> a;
  const double *d, *p;
  std::array<const double*, 4> beside;
};

/// r = scale (b - A p); returns |b - A p|^2 of the row. r is in halves (see level_rows.hpp). Faces
/// of x at its ends are closed, or the first is the last if `wraps`; ghosts are not read.
SILT_ONE_COPY double residual_row(int n, bool wraps, const DoubleRows& of, const double* b,
                                  double scale, float* r, std::ptrdiff_t half) {
  constexpr int chunk = 256;
  alignas(64) static constexpr std::array<double, chunk> zeros{};
  alignas(64) double left[chunk];
  double total = 0;
  const auto at_end = [&](int i) {
    double v = b[i] - of.d[i] * of.p[i];
    for (std::size_t c = 0; c < 4; ++c)
      if (of.a[c]) v -= of.a[c][i] * (of.p[i] - of.beside[c][i]);
    if (i > 0 || wraps) v -= of.ax[i] * (of.p[i] - of.p[i > 0 ? i - 1 : n - 1]);
    if (i + 1 < n || wraps)
      v -= of.ax[i + 1 < n ? i + 1 : 0] * (of.p[i] - of.p[i + 1 < n ? i + 1 : 0]);
    return v;
  };
  for (int from = 0; from < n; from += chunk) {
    const int count = std::min(chunk, n - from);
    const double *ax = of.ax + from, *p = of.p + from, *d = of.d + from;
    std::array<const double*, 4> a{}, beside{};
    for (std::size_t c = 0; c < 4; ++c) {
      a[c] = of.a[c] ? of.a[c] + from : zeros.data();
      beside[c] = of.beside[c] + from;
    }
    for (int i = 0; i < count; i += lanes_d) {
      const PackD own = load<PackD>(p + i);
      PackD s = load<PackD>(b + from + i) - load<PackD>(d + i) * own;
      PackD t = load<PackD>(ax + i) * (own - load_any<PackD>(p + i - 1));
      s -= load_any<PackD>(ax + i + 1) * (own - load_any<PackD>(p + i + 1));
      t += load<PackD>(a[0] + i) * (own - load<PackD>(beside[0] + i));
      s -= load<PackD>(a[1] + i) * (own - load<PackD>(beside[1] + i));
      t += load<PackD>(a[2] + i) * (own - load<PackD>(beside[2] + i));
      s -= load<PackD>(a[3] + i) * (own - load<PackD>(beside[3] + i));
      store(left + i, s - t);
    }
    if (from == 0) left[0] = at_end(0);
    if (from + count == n) left[count - 1] = at_end(n - 1);
    total += dot_row(count, left, left);
    for (int m = 0; m < count / 2; ++m) {
      r[from / 2 + m] = static_cast<float>(scale * left[2 * m]);
      r[from / 2 + half + m] = static_cast<float>(scale * left[2 * m + 1]);
    }
    if (count % 2 == 1) r[(from + count) / 2] = static_cast<float>(scale * left[count - 1]);
  }
  return total;
}

}  // namespace silt::inline SILT_TARGET::fluid_detail
