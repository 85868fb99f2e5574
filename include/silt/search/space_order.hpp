// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>
#include <silt/search/key_sort.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Order in which neighbours are close in memory: by cells as wide as the mean cutoff, in columns
/// of 16 x 16 cells, layer by layer within a column. It depends only on the spheres, not on the
/// search.
template <class Domain>
void space_order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
                 std::vector<std::uint32_t>& order) {
  const auto rows = spheres.rows;
  const std::size_t n = rows.size();
  order.resize(n);
  if (n == 0) return;
  std::array<double, Team::most_ranges> sums{};  // [m]
  team.for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) sums[r] += rows[k].r;
  });
  const double mean = std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(n);
  const int sphere = bits_for(n);
  const auto bits = [](const GridFrame& f) {
    return bits_for(f.count[0]) + bits_for(f.count[1]) + bits_for(f.count[2]);
  };
  constexpr int in_tile = 4;  // bits: 16 cells; a narrow direction is padded to as many
  const auto frame =
      finest_frame(bounds_of(spheres, domain, team), 2 * mean + reach, domain,
                   [&](const GridFrame& f) { return bits(f) + 2 * in_tile + sphere <= 64; });
  const int z_bits = bits_for(frame.count[2]);
  const int column_bits = std::max(0, bits_for(frame.count[0]) - in_tile);
  DynArray<std::uint64_t> keys(n);
  team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
    constexpr std::uint64_t low = (1u << in_tile) - 1;
    for (std::size_t k = from; k < to; ++k) {
      const std::uint64_t x = frame.along(rows[k].x, 0), y = frame.along(rows[k].y, 1),
                          z = frame.along(rows[k].z, 2);
      const std::uint64_t column = y >> in_tile << column_bits | x >> in_tile;
      const std::uint64_t cell =
          ((column << z_bits | z) << in_tile | (y & low)) << in_tile | (x & low);
      keys[k] = cell << sphere | k;
    }
  });
  KeySort<std::uint64_t> sort;
  const int columns = column_bits + std::max(0, bits_for(frame.count[1]) - in_tile);
  sort(keys, sphere, std::min(64, sphere + 2 * in_tile + z_bits + columns), team);
  for (std::size_t k = 0; k < n; ++k)
    order[k] = static_cast<std::uint32_t>(keys[k] & ((std::uint64_t{1} << sphere) - 1));
}

}  // namespace silt::detail
