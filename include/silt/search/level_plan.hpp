// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/search/levels.hpp>
#include <silt/search/occupied_rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Which level searches which between levels, and the cost.
class LevelPlan {
 public:
  void make(const OccupiedRows& grid);
  /// True if spheres of level `coarse` search for those of level `fine`.
  bool coarse_look(std::size_t coarse, std::size_t fine) const {
    return coarse_look_[coarse * count_ + fine];
  }
  /// The row where a part of the work begins.
  std::size_t first_row(std::size_t part, std::size_t parts, const OccupiedRows& grid) const;

 private:
  std::size_t count_ = 0;
  DynArray<std::uint8_t> coarse_look_;  // by coarse and fine level
  DynArray<double> work_;               // [ns] of the levels before each, and of all
};

inline void LevelPlan::make(const OccupiedRows& grid) {
  const auto& levels = grid.levels();
  count_ = levels.size();
  coarse_look_.assign(count_ * count_, false), work_.assign(count_ + 1, 0);
  const auto spheres = [&](std::size_t l) {
    const std::size_t end = l + 1 < count_ ? levels[l + 1].first_sphere : grid.spheres().size();
    return static_cast<double>(end - levels[l].first_sphere);
  };
  for (std::size_t l = 0; l < count_; ++l) {
    double work = spheres(l) * own_level_cost;
    for (std::size_t c = 0; c < count_; ++c) {
      if (c == l) continue;
      const auto [coarse, fine] = std::minmax(c, l);
      const auto cost =
          across_levels(spheres(coarse), levels[coarse].cutoff, spheres(fine), levels[fine].cutoff);
      coarse_look_[coarse * count_ + fine] = cost.coarse_look < cost.fines_look;
      if (coarse_look_[coarse * count_ + fine] == (l == coarse))
        work += std::min(cost.coarse_look, cost.fines_look);
    }
    work_[l + 1] = work_[l] + work;
  }
}

inline std::size_t LevelPlan::first_row(std::size_t part, std::size_t parts,
                                        const OccupiedRows& grid) const {
  if (part == 0) return 0;
  if (part == parts) return grid.rows();
  const double before = work_.back() * static_cast<double>(part) / static_cast<double>(parts);
  std::size_t l = 0;
  while (l + 1 < count_ && work_[l + 1] <= before) ++l;
  const std::size_t from = grid.levels()[l].first_sphere,
                    to = l + 1 < count_ ? grid.levels()[l + 1].first_sphere : grid.spheres().size();
  const double share = (before - work_[l]) / std::max(work_[l + 1] - work_[l], 1e-9);
  const double inside = share > 0 ? std::min(share, 1.0) : 0;  // NaN where cutoffs are 0
  const auto sphere = from + static_cast<std::size_t>(inside * static_cast<double>(to - from));
  return sphere >= grid.spheres().size() ? grid.rows() : grid.row_of(sphere);
}

}  // namespace silt::detail
