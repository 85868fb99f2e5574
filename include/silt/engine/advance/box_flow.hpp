// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/state/body.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The flow of a DeformingBox in a step.
struct BoxFlow {
  Upper3 gradient;                                                    // [1/s]
  Vec3d centre{0, 0, 0};                                              // [m]
  Vec3d at(const Vec3d& p) const { return gradient * (p - centre); }  // [m/s]
};
struct NoBoxFlow {};

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

/// The same for bodies, whose parts follow when they are placed. Their spins do not change: as for
/// spheres, only contacts turn them.
inline void add_flow_to_bodies(std::span<Body> bodies, const Upper3& a, const Vec3d& centre,
                               const Team& team) {
  if (inner(a, a) == 0) return;
  team.for_ranges(bodies.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      if (bodies[k].id != no_particle) bodies[k].velocity += a * (bodies[k].centre - centre);
  });
}

/// Motion of the particles relative to the flow of the box in the last step.
struct FlowPace {
  double largest_share = 0;    // [1/s] largest ratio of speed to inner reach
  Upper3 kinetic;              // [J] sum of m c_a c_b at the middle of the step
  Vec3d momentum{0, 0, 0};     // [kg m/s] of the same
  double mass = 0, count = 0;  // [kg], [-]
};
/// find(k, moved) calls moved(position, velocity, 1/m, 1/reach^2) if there is a particle k.
template <class Find>
FlowPace pace_in_flow(std::size_t count, const DeformingBox& box, double dt, const Team& team,
                      const Find& find) {
  std::array<FlowPace, Team::most_ranges> of;
  team.for_ranges(count, [&](std::size_t r, std::size_t from, std::size_t to) {
    FlowPace& p = of[r];
    double share2 = 0;
    for (std::size_t k = from; k < to; ++k)
      find(k, [&](const Vec3d& now, const Vec3d& v, double inv_m, double per_inner2) {
        const Vec3d x = now - dt * v - box.centre();  // before the step
        const Vec3d c = v - box.gradient() * x, half = c - 0.5 * dt * (box.gradient() * c);
        const double m = 1 / inv_m;
        share2 = std::max(share2, dot(c, c) * per_inner2);
        p.kinetic = p.kinetic + m * upper_outer(half, half);
        p.momentum += m * half, p.mass += m, p.count += 1;
      });
    p.largest_share = std::sqrt(share2);
  });
  FlowPace all;
  for (const FlowPace& p : of) {
    all.largest_share = std::max(all.largest_share, p.largest_share);
    all.kinetic = all.kinetic + p.kinetic;
    all.momentum += p.momentum, all.mass += p.mass, all.count += p.count;
  }
  return all;
}
/// Of spheres. `per_inner2`: as in MovedScene, or null. Call before box.advance().
template <class State>
FlowPace pace_in_flow(const State& particles, const DeformingBox& box, const double* per_inner2,
                      double dt, const Team& team) {
  return pace_in_flow(particles.size(), box, dt, team, [&](std::size_t k, const auto& moved) {
    if (!particles.is_parked(k))
      moved(particles.position[k].centre(), particles.motion[k].velocity(),
            particles.motion[k].inv_m, per_inner2 != nullptr ? per_inner2[k] : 0.0);
  });
}
/// Of bodies, in the order of their first parts, which a restart keeps. Parts measure how they move
/// relative to the lists (BodyMotion::place()).
template <class State>
FlowPace pace_of_bodies(const State& particles, std::span<const Body> bodies,
                        const DeformingBox& box, double dt, const Team& team) {
  return pace_in_flow(particles.size(), box, dt, team, [&](std::size_t k, const auto& moved) {
    const Body& b = bodies[particles.part[k].body];
    if (particles.part[k].local == 0 && b.id != no_particle)
      moved(b.centre, b.velocity, b.inv_m, 0.0);
  });
}
/// [J] sum F_a d_b over the parts of all bodies, with the contact force F on a part and the
/// distance d of its centre from the body's. The virial of pairs of parts, less this, is that of
/// pairs of bodies.
template <class State, class LoadOf>
Upper3 virial_of_arms(const State& particles, std::span<const Body> bodies, const LoadOf& load_of,
                      const Team& team) {
  std::array<Upper3, Team::most_ranges> of;
  team.for_ranges(particles.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      if (const Body& b = bodies[particles.part[k].body]; b.id != no_particle)
        of[r] = of[r] + upper_outer(load_of(k), particles.position[k].centre() - b.centre);
  });
  Upper3 sum;
  for (const Upper3& one : of) sum = sum + one;
  return sum;
}

}  // namespace silt::detail
