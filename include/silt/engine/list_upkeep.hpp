// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/engine/rows.hpp>

namespace silt::detail {

/// When the lists must be renewed so that no contact is missed.
///
/// Let s be the outer and q < s the inner skin, D the largest displacement of a sphere since the
/// search, U since the last pruning, D' and U' the same for the walls. A pair that is not in the
/// outer list had a gap of at least s at the search, so it has at least s - 2 D now; a pair of the
/// outer list that was pruned had at least q at the pruning, so it has at least q - 2 U now. Hence
///   (1) as long as 2 U < q and s - 2 D(at the pruning) >= q, no pair outside the inner list
///   touches; (2) for walls the same holds with D + D' and U + U' in place of 2 D and 2 U.
/// U is bounded by the sum of max|v| dt (no square root a particle, no pass); D is measured exactly
/// at each pruning. (1) is checked before the forces of every step.
/// Tests: tests/engine/list_upkeep.cpp (against brute force at every step).
class ListUpkeep {
 public:
  double outer_skin = 0;                          // [m] s
  double inner_skin = 0;                          // [m] q
  double travelled = 0;                           // [m] bound of U
  std::int64_t pruned_at = -1, searched_at = -1;  // [steps]

  bool inner_holds(double wall_travel) const {
    return 2 * travelled < inner_skin && travelled + wall_travel < inner_skin;
  }
  bool outer_holds(double displacement, double wall_displacement) const {
    return searched_at >= 0 && outer_skin - 2 * displacement >= inner_skin &&
           outer_skin - displacement - wall_displacement >= inner_skin;
  }

  /// Chooses both skins for spheres of mean diameter d [m] that approach by `closing` [m] a step at
  /// most. Minimises the cost a step of a particle: search / interval + prune / interval + pairs
  /// that do not touch; its constants are rough nanoseconds of an earlier prototype on a
  /// dense bed; they set the speed alone, not the result's validity, and are not yet fitted to this
  /// engine.
  void choose_skins(double d, double closing) {
    constexpr double search = 150, prune = 15, idle_pair = 36;  // [ns], the last per skin/diameter
    constexpr double least = 0.01, most = 0.5;                  // [-] of the diameter
    double best = std::numeric_limits<double>::infinity();
    for (double s = 2 * least; s <= most; s *= 1.1) {
      const double listed = (1 + s) * (1 + s) * (1 + s);
      const double q =
          std::clamp(std::sqrt(closing / d * prune * listed / idle_pair), least, s / 2);
      const double cost = search * closing / (d * (s - q)) + prune * listed * closing / (d * q) +
                          idle_pair * q + 0.5 * listed;
      if (cost < best) best = cost, outer_skin = s * d, inner_skin = q * d;
    }
  }
  /// For a skin that the user set: the inner one is a fifth of it.
  void set_skin(double skin) { outer_skin = skin, inner_skin = 0.2 * skin; }
};

/// The largest displacement [m] of points of `region` that are carried from pose a to pose b. A
/// rigid motion is affine, so its displacement is convex and largest at a corner.
inline double largest_displacement(const Pose& a, const Pose& b, const Box& region) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{corner & 1 ? region.max.x : region.min.x,
                  corner & 2 ? region.max.y : region.min.y,
                  corner & 4 ? region.max.z : region.min.z};
    most = std::max(most, norm(b.to_space(a.to_body(p)) - p));
  }
  return most;
}

/// Poses of all walls at one instant, to measure their motion since.
class WallMarks {
 public:
  void set(std::span<const Wall> walls, const Box& region) {
    region_ = region;
    poses_.clear();
    for (const auto& w : walls) poses_.push_back(w.pose);
  }
  double travel(std::span<const Wall> walls) const {
    double most = 0;
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (walls[w].moves())
        // Of the points that are in the region now: it is they that spheres there may touch.
        most = std::max(most, largest_displacement(walls[w].pose, poses_[w], region_));
    return most;
  }
  std::span<const Pose> poses() const { return poses_; }
  const Box& region() const { return region_; }
  void restore(std::vector<Pose> poses, const Box& region) {
    poses_ = std::move(poses), region_ = region;
  }

 private:
  std::vector<Pose> poses_;
  Box region_;
};

}  // namespace silt::detail
