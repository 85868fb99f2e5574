// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/engine/lists/wall_images.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// When the neighbour lists must be renewed so that no contact is missed. Every sphere has a skin
/// (reach) of its own: slow spheres need hardly any, however fast others are.
///
/// Let s_i be the outer and q_i the inner reach of sphere i, D_i its displacement since the search
/// and U_i since the last pruning; S, Q, D', U' the same for the walls. Gaps are counted from the
/// distance at which the law begins to act: its range, which is 0 for contact laws without
/// attraction at a distance. A pair that is not in the outer list had a gap of at least s_i + s_j
/// at the search; one that was pruned from it had a gap of at least q_i + q_j at the pruning. Hence
///   (1) if every q_i <= s_i - D_i at the pruning, and Q <= S - D', then at that moment every pair
///       outside the inner list had a gap of at least q_i + q_j (a sphere and a wall: q_i + Q);
///   (2) as long as U_i < q_i for all i, and U' <= Q, none of them touches, or comes within range.
/// U_i/q_i is bounded by the sum over steps of max_i (|v_i| dt/q_i): one multiplication per
/// particle and step. D_i is measured exactly, at each pruning. (2) is checked before the forces of
/// every step.
/// Tests: tests/engine/list_upkeep.cpp (against brute force at every step).
class ListUpkeep {
 public:
  AlignedVector<double> outer;                    // [m] s_i
  AlignedVector<double> inner;                    // [m] q_i
  AlignedVector<double> per_inner2;               // [1/m2] 1/q_i^2
  double outer_wall = 0, inner_wall = 0;          // [m] S and Q
  double used = 0;                                // [-] upper bound of the largest U_i/q_i
  std::int64_t pruned_at = -1, searched_at = -1;  // [steps]
  /// The intended lifetimes [s] of the lists, and the bounds of the reaches [m].
  struct Plan {
    double outer_time, inner_time, least_outer, most_outer, least_inner, most_inner;
  } plan{};

  /// Call when sphere k has grown by `radius` [m] and its centre was moved, so that its surface is
  /// up to `reach` [m] farther out. D_k already includes the move. s_k is reduced by `radius`, so
  /// that (1) still holds, and q_k by `reach`; the used share of q_k is scaled to the smaller
  /// value. Returns false if too little is left of either.
  bool charge(std::size_t k, double radius, double reach) {
    outer[k] -= std::max(radius, 0.0);
    if (reach <= 0) return true;
    const double left = inner[k] - reach;
    if (!(left > 0) || !(outer[k] > 0)) return false;
    used *= inner[k] / left;
    inner[k] = left, per_inner2[k] = 1 / (left * left);
    return true;
  }

  bool inner_holds(double wall_travel) const { return used < 1 && wall_travel <= inner_wall; }

  /// Sets a skin S given by the user, the largest gap of a listed pair: half of it for each sphere,
  /// and a fifth of that for the inner list.
  void set_skin(double skin) { plan = {0, 0, skin / 2, skin / 2, skin / 10, skin / 10}; }

  /// Chooses the lifetimes of both lists for spheres of mean diameter d [m] that may move at
  /// `mean_speed`, and spheres and walls at up to `fastest` [m/s]. It minimises the cost per step
  /// and particle of searching, pruning and of pairs that do not touch. The constants are
  /// nanoseconds from a profile of a hopper discharge; they affect the speed only.
  void choose_skins(double d, double mean_speed, double fastest, double time_step) {
    constexpr double search = 150, cell = 30, prune = 15, prune_pair = 8, idle_pair = 8;  // [ns]
    constexpr double pairs = 2.2, more_pairs = 10;  // per particle; more per gap over diameter
    plan = {0, 0, 0.03 * d, 0.5 * d, 0.005 * d, 0.25 * d};
    if (!(d > 0)) return;  // there are no spheres
    const double per = slack * time_step / d;
    const double mean = per * mean_speed, most = per * fastest;  // diameters per step
    double best = std::numeric_limits<double>::infinity();
    for (double outer_steps = 2; outer_steps < 1e5; outer_steps *= 1.15) {
      const double widest = std::max(0.03, most * outer_steps);
      if (widest > 0.5 && outer_steps > 2) break;
      const double listed = pairs + more_pairs * 2 * (0.03 + mean * outer_steps);
      const double pruning = prune + prune_pair * listed;
      const double idle = idle_pair * more_pairs * 2 * mean;
      const double inner_steps =
          std::clamp(std::sqrt(pruning / std::max(idle, 1e-9)), 1.0, outer_steps / 2);
      const double edge = 1 + 2 * widest;
      const double cost = (search + cell * edge * edge * edge) / outer_steps +
                          pruning / inner_steps + idle * inner_steps;
      if (cost >= best) continue;
      best = cost;
      plan.outer_time = outer_steps * time_step, plan.inner_time = inner_steps * time_step;
    }
  }

  /// The outer reach [m] of a sphere that may move at `speed` [m/s].
  double outer_reach(double speed) const {
    return std::clamp(slack * plan.outer_time * speed, plan.least_outer, plan.most_outer);
  }
  void set_outer_wall(double wall_speed) {
    outer_wall = wall_speed < 0 ? 0 : outer_reach(wall_speed);
  }

  /// Sets the inner reaches of particles from ... to-1. Returns false if the outer list is used up:
  /// if half of the wanted reach exceeds what displacement(k) [m] has left of the outer reach.
  template <class Displacement>
  bool set_inner(std::size_t from, std::size_t to, std::span<const double> speeds,
                 const Displacement& displacement) {
    bool enough = true;
    for (std::size_t k = from; k < to; ++k) {
      const double wanted = inner_reach(speeds[k]);
      const double left = outer[k] - displacement(k);
      enough &= left >= 0.5 * wanted;
      inner[k] = std::min(wanted, left);
      per_inner2[k] = 1 / (inner[k] * inner[k]);
    }
    return enough;
  }
  bool set_inner_wall(double wall_speed, double wall_displacement) {
    if (wall_speed < 0) return inner_wall = 0, true;  // walls at rest
    const double wanted = inner_reach(wall_speed);
    const double left = outer_wall - wall_displacement;
    inner_wall = std::min(wanted, left);
    return left >= 0.5 * wanted;
  }

  void restore(std::span<const double> outer_reaches, std::span<const double> inner_reaches) {
    outer.assign(outer_reaches.begin(), outer_reaches.end());
    inner.assign(inner_reaches.begin(), inner_reaches.end());
    per_inner2.resize(inner.size());
    for (std::size_t k = 0; k < inner.size(); ++k)
      per_inner2[k] = inner[k] > 0 ? 1 / (inner[k] * inner[k]) : 0;  // 0: there is no list
  }

 private:
  static constexpr double slack = 1.2;  // reach relative to what the present speed needs

  double inner_reach(double speed) const {
    return std::clamp(slack * plan.inner_time * speed, plan.least_inner, plan.most_inner);
  }
};

/// The largest displacement [m] of points of `region` moved from pose a to pose b. A rigid motion
/// is affine, so its displacement is convex and largest at a corner.
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

/// The same for the points of a wall. A driven wall of finite size may rotate fast about itself;
/// only its own points count, which lie within the bounds of its surfaces. Of an infinite surface
/// only the points in `region` [m] count.
inline double displacement_of(const Wall& wall, const Pose& a, const Pose& b, const Box& region) {
  const Box& own = wall.extent;
  if (!wall.is_driven() || !is_finite(own.min) || !is_finite(own.max))
    return largest_displacement(a, b, region);
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{corner & 1 ? own.max.x : own.min.x, corner & 2 ? own.max.y : own.min.y,
                  corner & 4 ? own.max.z : own.min.z};
    most = std::max(most, norm(b.to_space(p) - a.to_space(p)));
  }
  return most;
}

/// The largest displacement [m] of moving walls in the last step, as displacement_of(), with
/// images.
inline double longest_way(std::span<const Wall> walls, const Box& region, const Vec3d& period) {
  double most = 0;
  for (const Wall& w : walls)
    if (w.moves())
      most = std::max(
          most, displacement_of(w, w.pose, w.last_pose, region_with_images(region, w, period)));
  return most;
}

/// Poses of all walls at one instant, from which their later motion is measured.
class WallMarks {
 public:
  Vec3d period{0, 0, 0};  // [m] lengths of a box that walls repeat with; 0 where it is not periodic
  void set(std::span<const Wall> walls, const Box& region) {
    region_ = region;
    poses_.clear();
    for (const auto& w : walls) poses_.push_back(w.pose);
  }
  double travel(std::span<const Wall> walls) const {
    double most = 0;
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (walls[w].moves())
        // Only points that are in the region now can touch spheres there.
        most = std::max(most,
                        displacement_of(walls[w], walls[w].pose, poses_[w], region_of(walls[w])));
    return most;
  }
  /// Includes the points of this region.
  void include(const Box& region) { region_.include(region); }
  std::span<const Pose> poses() const { return poses_; }
  const Box& region() const { return region_; }
  /// The region extended by the points of a wall whose images may lie in it.
  Box region_of(const Wall& wall) const { return region_with_images(region_, wall, period); }
  void restore(DynArray<Pose> poses, const Box& region) {
    poses_ = std::move(poses), region_ = region;
  }

 private:
  DynArray<Pose> poses_;
  Box region_;
};

}  // namespace silt::detail
