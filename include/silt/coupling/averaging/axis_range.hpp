// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Cells in one direction on which a particle has weights. Weights on cells low ... high of an
/// unbounded grid are mapped to `count` cells from `start` on: wrapped in periodic directions, and
/// folded at walls (cell -1 - i to cell i). The volume is conserved, and a uniform suspension
/// remains uniform at a wall.
/// Tests: tests/coupling/averaging.cpp.
struct AxisRange {
  int low, high;     // on the unbounded grid
  int start, count;  // on the grid
  int cells;         // of the grid
  bool periodic;
  bool bends;  // some of low ... high are beyond an end, and the mapping is not one to one

  AxisRange() = default;
  AxisRange(int from, int to, int n, bool wraps)
      : low(from), high(to), cells(n), periodic(wraps), bends(false) {
    count = high - low + 1;
    if (wraps) {
      start = modulo(low, n);
      if (count > n) start = 0, count = n, bends = true;
      return;
    }
    start = low;
    if (low >= 0 && high < n) return;
    bends = true;
    int first = std::clamp(low, 0, n - 1), last = std::clamp(high, 0, n - 1);
    if (low < 0) last = std::max(last, std::min(n - 1, -1 - low));
    if (high >= n) first = std::min(first, std::max(0, 2 * n - 1 - high));
    if (low < -n || high >= 2 * n) first = 0, last = n - 1;
    start = first, count = last - first + 1;
  }

  int raw() const { return high - low + 1; }
  /// Index among the `count` cells for cell r of low ... high.
  int place(int r) const {
    if (!bends) return r - low;
    if (periodic) return modulo(r, cells);
    const int m = modulo(r, 2 * cells);
    return (m < cells ? m : 2 * cells - 1 - m) - start;
  }

 private:
  static int modulo(int a, int n) { return (a % n + n) % n; }
};

}  // namespace silt
