// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Open faces of a cell: one bit for each lower face (1, 2, 4 for x, y, z), and 8 if d > 0. Lower
/// faces of index 0 lead to the last cell.
using Openings = DynArray<std::uint8_t>;

/// Sets of cells connected by open faces, and those of them without a Dirichlet value (d > 0).
struct Components {
  static constexpr std::int32_t held = -1, blocked = -2;

  /// For every cell, i fastest: the number of its floating set, `held` if its set has a cell with d
  /// > 0, `blocked` if all faces are closed and d = 0.
  DynArray<std::int32_t> of_cell;
  DynArray<std::size_t> sizes;  // cells of each floating set [-]
  bool any_blocked = false;

  void find(const Openings& open, const std::array<int, 3>& n) {
    const std::size_t cells = open.size();
    constexpr std::int32_t unseen = -3;
    of_cell.assign(cells, unseen);
    sizes.clear();
    any_blocked = false;
    const std::array<std::size_t, 3> step{
        1, static_cast<std::size_t>(n[0]),
        static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1])};
    DynArray<std::size_t> members;
    for (std::size_t seed = 0; seed < cells; ++seed) {
      if (of_cell[seed] != unseen) continue;
      const auto number = static_cast<std::int32_t>(sizes.size());
      bool dirichlet = false, faces = false;
      members.assign(1, seed);
      of_cell[seed] = number;
      for (std::size_t next = 0; next < members.size(); ++next) {
        const std::size_t cell = members[next];
        dirichlet |= (open[cell] & 8) != 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const auto across = static_cast<std::size_t>(n[c]);
          const std::size_t at = cell / step[c] % across;
          const std::size_t below = at > 0 ? cell - step[c] : cell + (across - 1) * step[c];
          const std::size_t above = at + 1 < across ? cell + step[c] : cell - at * step[c];
          const auto visit = [&](bool is_open, std::size_t other) {
            if (!is_open) return;
            faces = true;
            if (of_cell[other] == unseen) of_cell[other] = number, members.push_back(other);
          };
          visit(open[cell] >> c & 1, below);
          visit(open[above] >> c & 1, above);
        }
      }
      if (!dirichlet && faces) {
        sizes.push_back(members.size());
        continue;
      }
      any_blocked |= !dirichlet;
      for (const std::size_t cell : members) of_cell[cell] = dirichlet ? held : blocked;
    }
  }
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
