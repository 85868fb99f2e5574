// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET {

/// Sequence of sweeps over the planes of a grid.
struct PlaneSweeps {
  int planes, rows;           // of the grid; rows of each plane [-]
  int stages;                 // sweeps, each over all planes [-]
  std::size_t row_bytes;      // read and written by a stage per row
  bool wraps_planes = false;  // the last plane is coupled with the first
  bool wraps_rows = false;    // the last row of each plane is coupled with its first
  bool backward = false;      // adjoint order where the order matters: wraps of odd numbers
};

/// Calls stage(s, k, from, to) for rows from ... to-1 of plane k, for all stages s, planes and
/// rows. The result is that of successive sweeps over all planes, but in an order that keeps rows
/// in cache.
///
/// Stage s of row (j, k) may read the row and its four neighbours and write the row; it must not
/// read values of a neighbour that stage s writes there (red-black: the other colour). Planes are
/// processed in a wave, stage s one plane behind stage s-1, and within a plane in strips of rows,
/// stage s one row behind (parallelograms in time); the rows of all stages then fit a core's own
/// cache. Threads process slabs of planes: in each, stage s omits the s planes next to another
/// slab, which are processed when both slabs are done (trapezoids in time). The numbers are those
/// of plain sweeps, bit for bit, for any number of threads. Rows of one stage and plane come in
/// ascending order.
///
/// If the first and the last plane of an odd number are coupled, they have the same colour and the
/// order matters: plain sweeps, the last plane after the others, or before them if `backward`.
template <class Stage>
void sweep_planes(const Team& team, const PlaneSweeps& of, const Stage& stage) {
  constexpr std::size_t cache_bytes = 400000;  // of 512 KiB to 2 MiB of a core's own cache
  const int n = of.planes, stages = of.stages, rows = of.rows;
  if (of.wraps_planes && (n % 2 == 1 || n < 2 * stages)) {
    const bool seam = n % 2 == 1 && n > 1;
    for (int s = 0; s < stages; ++s) {
      if (seam && of.backward) stage(s, n - 1, 0, rows);
      team.for_parts(static_cast<std::size_t>(seam ? n - 1 : n),
                     [&](std::size_t k) { stage(s, static_cast<int>(k), 0, rows); });
      if (seam && !of.backward) stage(s, n - 1, 0, rows);
    }
    return;
  }
  const std::size_t fit = cache_bytes / (of.row_bytes * static_cast<std::size_t>(stages + 2));
  int strip = std::max(4 * stages, static_cast<int>(fit) - stages / 2);
  if (of.wraps_rows || rows < strip + strip / 2) strip = rows;
  const auto do_rows = [&](int s, int k, int at) {  // stage s of the strip that begins at row `at`
    const int from = std::max(0, at == 0 ? 0 : at - s);
    const int to = at + strip >= rows ? rows : at + strip - s;
    if (from < to) stage(s, k, from, to);
  };

  const int slabs = std::max(1, std::min(team.threads(), n / (2 * stages)));
  const auto begin = [&](int slab) {
    return static_cast<int>(static_cast<long long>(n) * slab / slabs);
  };
  team.for_parts(static_cast<std::size_t>(slabs), [&](std::size_t part) {
    const int slab = static_cast<int>(part), from = begin(slab), to = begin(slab + 1);
    const int low = slab > 0 || of.wraps_planes, high = slab + 1 < slabs || of.wraps_planes;
    for (int at = 0; at < rows; at += strip)
      for (int front = from; front < to + stages; ++front)
        for (int s = 0; s < stages; ++s)
          if (const int k = front - s; k >= from + low * s && k < to - high * s) do_rows(s, k, at);
  });
  const int first = of.wraps_planes ? 0 : 1;  // slab whose lower end is to be closed
  team.for_parts(static_cast<std::size_t>(slabs - first), [&](std::size_t part) {
    const int closed = begin(static_cast<int>(part) + first);
    for (int s = 1; s < stages; ++s)
      for (int k = closed - s; k < closed + s; ++k) stage(s, (k + n) % n, 0, rows);
  });
}

}  // namespace silt
