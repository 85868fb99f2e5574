// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Changes the velocity of all spheres by a times their position relative to the centre of the box.
template <class State>
void add_flow(State& particles, const Upper3& a, const Vec3d& centre, const Team& team) {
  if (inner(a, a) == 0) return;
  team.for_ranges(particles.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      if (!particles.is_parked(k))
        particles.add_velocity(k, a * (particles.position[k].centre() - centre));
  });
}

/// Motion of the spheres relative to the flow of the box in the last step.
struct FlowPace {
  double largest_share = 0;  // [1/s] largest ratio of speed to inner reach
  Upper3 kinetic;            // [J] sum of m c_a c_b at the middle of the step
  double mass = 0;           // [kg]
};
/// `per_inner2`: as in MovedScene, or null. Call before box.advance().
template <class State>
FlowPace pace_in_flow(const State& particles, const DeformingBox& box, const double* per_inner2,
                      double dt, const Team& team) {
  std::array<FlowPace, Team::most_ranges> of;
  team.for_ranges(particles.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    FlowPace& p = of[r];
    double share2 = 0;
    for (std::size_t k = from; k < to; ++k) {
      if (particles.is_parked(k)) continue;
      const Vec3d v = particles.motion[k].velocity();
      const Vec3d x = particles.position[k].centre() - dt * v - box.centre();  // before the step
      const Vec3d c = v - box.gradient() * x, half = c - 0.5 * dt * (box.gradient() * v);
      const double m = 1 / particles.motion[k].inv_m;
      if (per_inner2 != nullptr) share2 = std::max(share2, dot(c, c) * per_inner2[k]);
      p.kinetic = p.kinetic + m * upper_outer(half, half);
      p.mass += m;
    }
    p.largest_share = std::sqrt(share2);
  });
  FlowPace all;
  for (const FlowPace& p : of) {
    all.largest_share = std::max(all.largest_share, p.largest_share);
    all.kinetic = all.kinetic + p.kinetic, all.mass += p.mass;
  }
  return all;
}

}  // namespace silt::detail
