// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET {

/// How sweeps over the planes of a grid follow each other.
struct PlaneSweeps {
  int planes;             // of the grid [-]
  int stages;             // sweeps, each over all planes [-]
  bool wraps = false;     // the last plane is coupled with the first
  bool backward = false;  // the adjoint order where the order matters: wraps, odd planes
};

/// Calls stage(s, k) for all stages s and planes k as if every stage swept over all planes before
/// the next one begins, but in an order that finds planes still in cache.
///
/// Stage s of plane k may read planes k-1, k and k+1 and write plane k; of what it reads from k-1
/// and k+1 nothing may be written there by stage s (red-black: the other colour). Planes are done
/// in a wave, stage s one plane behind stage s-1. Threads take slabs: in each, stage s leaves out
/// the s planes next to another slab, which are done when both slabs are (trapezoids in time).
/// The numbers are those of plain sweeps, bit for bit, whatever the number of threads.
///
/// Where the first and the last plane of an odd number are coupled, they have the same colour and
/// the order matters: plain sweeps, the last plane after the others, or before them if `backward`.
template <class Stage>
void sweep_planes(const Team& team, const PlaneSweeps& of, const Stage& stage) {
  const int n = of.planes, stages = of.stages;
  if (of.wraps && (n % 2 == 1 || n < 2 * stages)) {
    const bool seam = n % 2 == 1 && n > 1;
    for (int s = 0; s < stages; ++s) {
      if (seam && of.backward) stage(s, n - 1);
      team.for_parts(static_cast<std::size_t>(seam ? n - 1 : n),
                     [&](std::size_t k) { stage(s, static_cast<int>(k)); });
      if (seam && !of.backward) stage(s, n - 1);
    }
    return;
  }
  const int slabs = std::max(1, std::min(team.threads(), n / (2 * stages)));
  const auto begin = [&](int slab) {
    return static_cast<int>(static_cast<long long>(n) * slab / slabs);
  };
  team.for_parts(static_cast<std::size_t>(slabs), [&](std::size_t part) {
    const int slab = static_cast<int>(part), from = begin(slab), to = begin(slab + 1);
    const int low = slab > 0 || of.wraps, high = slab + 1 < slabs || of.wraps;
    for (int front = from; front < to + stages; ++front)
      for (int s = 0; s < stages; ++s)
        if (const int k = front - s; k >= from + low * s && k < to - high * s) stage(s, k);
  });
  const int first = of.wraps ? 0 : 1;  // slab whose lower end is to be closed
  team.for_parts(static_cast<std::size_t>(slabs - first), [&](std::size_t part) {
    const int at = begin(static_cast<int>(part) + first);
    for (int s = 1; s < stages; ++s)
      for (int k = at - s; k < at + s; ++k) stage(s, (k + n) % n);
  });
}

}  // namespace silt
