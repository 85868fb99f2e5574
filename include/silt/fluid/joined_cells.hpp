// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <map>

#include <silt/core/dyn_array.hpp>
#include <silt/fluid/flow_boundary.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Groups of cells: those with their centres in a wall are merged with neighbours. Such a cell
/// contains few or no particle centres. Particles distribute to a group with one density per fluid
/// volume, and gather the mean of the group; the two operations remain adjoint.
class JoinedCells {
 public:
  /// A cell with its centre in a wall is merged with the neighbour, with its centre in the fluid,
  /// that has the widest opening to it. `area` of faces, `share` of cells: [-] open shares.
  void find(const Grid& grid, const FlowBoundary& boundary, const Three& area,
            const CellField& share) {
    std::map<std::array<int, 3>, DynArray<Cell>> groups;  // by the cell with its centre in fluid
    const auto& n = grid.cells();
    const auto of = [&](const std::array<int, 3>& c) { return share(c[0], c[1], c[2]); };
    const auto centred = [&](const std::array<int, 3>& c) {
      return of(c) > 0 && boundary.distance(grid.centre(c[0], c[1], c[2])) > 0;
    };
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const std::array<int, 3> from{i, j, k};
          if (of(from) == 0 || of(from) == 1 || centred(from)) continue;
          std::array<int, 3> to{};
          double widest = 0;
          for (std::size_t d = 0; d < 3; ++d)
            for (const int way : {-1, 1}) {
              std::array<int, 3> face = from, next = from;
              face[d] += way > 0, next[d] += way;
              const double passed = area[d](face[0], face[1], face[2]);
              if (grid.periodic(static_cast<int>(d))) next[d] = (next[d] + n[d]) % n[d];
              if (next[d] < 0 || next[d] >= n[d] || passed <= widest || !centred(next)) continue;
              widest = passed, to = next;
            }
          if (!(widest > 0)) continue;
          auto& group = groups[to];
          if (group.empty()) group.push_back({to, of(to)});
          group.push_back({from, of(from)});
        }
    groups_.clear();
    for (auto& [_, group] : groups) groups_.push_back(std::move(group));
  }
  /// Distributes amounts in proportion to shares.
  void spread(CellField& amounts) const {
    for (const auto& g : groups_) {
      double sum = 0, shares = 0;
      for (const auto& c : g) sum += amounts(c.at[0], c.at[1], c.at[2]), shares += c.share;
      for (const auto& c : g) amounts(c.at[0], c.at[1], c.at[2]) = sum * c.share / shares;
    }
  }
  /// Replaces values by their mean.
  void average(CellField& values) const {
    for (const auto& g : groups_) {
      double sum = 0, shares = 0;
      for (const auto& c : g) sum += c.share * values(c.at[0], c.at[1], c.at[2]), shares += c.share;
      for (const auto& c : g) values(c.at[0], c.at[1], c.at[2]) = sum / shares;
    }
  }

 private:
  struct Cell {
    std::array<int, 3> at;
    double share;
  };
  DynArray<DynArray<Cell>> groups_;
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
