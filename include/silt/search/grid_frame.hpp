// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Reports the first sphere that a search cannot place.
[[noreturn, gnu::cold]] inline void throw_not_finite(const SphereSet& spheres) {
  std::size_t k = 0;
  const auto& rows = spheres.rows;
  while (k + 1 < rows.size() && is_finite(rows[k].centre()) && std::isfinite(rows[k].r)) ++k;
  throw InputError(text("neighbour search: sphere ", k, " at ", rows[k].centre(),
                        " m with a reach of ", rows[k].r,
                        " m has no finite position or size; remove it, or find its cause"));
}

/// Bounding box of all centres; in periodic directions the whole length. InputError for a sphere
/// without a finite position or size.
template <class Domain>
Box bounds_of(const SphereSet& spheres, const Domain& domain, const Team& team) {
  const auto rows = spheres.rows;
  std::array<Box, Team::most_ranges> boxes;
  std::array<double, Team::most_ranges> sums{};  // NaN if any summand is
  team.for_ranges(rows.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    Box box;
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) {
      box.include(rows[k].centre());
      sum += 0 * rows[k].x + 0 * rows[k].y + 0 * rows[k].z + 0 * rows[k].r;
    }
    boxes[r] = box, sums[r] = sum;
  });
  Box bounds;
  for (const auto& box : boxes) bounds.include(box);
  if (std::any_of(sums.begin(), sums.end(), [](double sum) { return sum != 0; }))
    throw_not_finite(spheres);
  if constexpr (Domain::periodic) {
    double* const low[3] = {&bounds.min.x, &bounds.min.y, &bounds.min.z};
    double* const high[3] = {&bounds.max.x, &bounds.max.y, &bounds.max.z};
    const double from[3] = {domain.box().min.x, domain.box().min.y, domain.box().min.z};
    for (int d = 0; d < 3; ++d)
      if (domain.repeats(d)) *low[d] = from[d], *high[d] = from[d] + domain.length(d);
  }
  return bounds;
}

/// Regular cells in a box, none narrower than a cutoff. Spheres within the cutoff of each other are
/// in the same cell or in cells that share a face, an edge or a corner.
///
/// A periodic direction has at least three cells or just one: the cells before and after a cell are
/// then two other cells, or none.
struct GridFrame {
  std::array<double, 3> low{};                // [m]
  std::array<double, 3> per_length{};         // [1/m] cells; 0: one cell
  std::array<std::size_t, 3> count{1, 1, 1};  // cells
  std::array<bool, 3> wraps{};                // the last cell is next to the first

  GridFrame() = default;
  template <class Domain>
  GridFrame(const Box& bounds, double cutoff, const Domain& domain) {
    const Vec3d e = bounds.extent();
    const double length[3] = {e.x, e.y, e.z};
    const double from[3] = {bounds.min.x, bounds.min.y, bounds.min.z};
    for (int d = 0; d < 3; ++d) {
      // Wider than the cutoff by more than the rounding of positions: no two spheres within the
      // cutoff are two cells apart.
      const double edge = cutoff * (1 + 1e-9) + 1e-15 * length[d];
      double cells = std::clamp(std::floor(length[d] / edge), 1.0, 0x1p52);
      bool repeats = false;
      if constexpr (Domain::periodic) repeats = domain.repeats(d);
      if (!(cells >= (repeats ? 3 : 2))) cells = 1;
      low[d] = from[d];
      count[d] = static_cast<std::size_t>(cells);
      per_length[d] = cells > 1 ? cells / length[d] : 0;
      wraps[d] = repeats && cells > 1;
    }
  }

  double cells() const {
    return static_cast<double>(count[0]) * static_cast<double>(count[1]) *
           static_cast<double>(count[2]);
  }
  /// Cell index of a coordinate in direction d: 0 ... count[d] - 1.
  std::size_t along(double x, int d) const {
    const double c = (x - low[d]) * per_length[d];
    return c <= 0 ? 0 : std::min(count[d] - 1, static_cast<std::size_t>(c));
  }
  /// Width of a cell [m]; infinite if there is only one.
  double edge(int d) const { return 1 / per_length[d]; }
};

/// Finest cells of at least `cutoff` [m] that satisfy `fits`; they grow until they do.
template <class Domain, class Fits>
GridFrame finest_frame(const Box& bounds, double cutoff, const Domain& domain, const Fits& fits) {
  const Vec3d e = bounds.extent();
  for (double edge = std::max({cutoff, 1e-12 * e.x, 1e-12 * e.y, 1e-12 * e.z});; edge *= 1.26) {
    const GridFrame frame(bounds, edge, domain);
    if (fits(frame)) return frame;
  }
}

}  // namespace silt::detail
