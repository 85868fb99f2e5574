// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Limits that a run must keep; where one is broken it stops with a SimulationError.
struct Guard {
  double max_overlap = 0.3;        // [-] of the smaller radius
  double max_time_step = 0.125;    // [-] of the shortest contact time at the largest speed
  std::optional<Box> domain = {};  // [m] particles must stay inside; left out: not checked
};

namespace detail {

/// Looks for the particle that has become not a number; says where, and what to change.
template <class EngineType>
[[noreturn]] void throw_not_finite(const EngineType& e, std::int64_t step, double time) {
  for (std::size_t k = 0; k < e.particles.size(); ++k) {
    const auto& m = e.particles.motion[k];
    const auto& p = e.particles.position[k];
    if (e.particles.is_parked(k) || (is_finite(m.velocity()) && is_finite(p.centre()))) continue;
    throw SimulationError(
        text("step ", step, ", t = ", time, " s: the velocity of particle ", e.particles.id[k],
             " is not finite near ", e.lists.reference[k],
             " m; lower the time step, or look for overlapping particles at the start"),
        step, {e.particles.id[k]}, e.lists.reference[k]);
  }
  throw SimulationError(text("step ", step, ", t = ", time,
                             " s: the squared velocities overflow; lower the time step"),
                        step, {}, {});
}

/// Names the contact with the largest overlap over the smaller radius. The spheres may have moved
/// on by a step since it was measured: the deepest contact now tells which one it is.
template <class EngineType, class Domain>
[[noreturn]] void throw_overlap(const EngineType& e, const Domain& domain, std::int64_t step,
                                double time, double limit) {
  double most = -1;  // [-]
  std::uint32_t a = 0, b = 0;
  e.lists.pairs.for_each([&](std::size_t k) {
    const std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
    const auto &p = e.particles.position[i], &q = e.particles.position[j];
    Vec3d d = p.centre() - q.centre();
    if constexpr (Domain::periodic) d = domain.shortest(d);
    const double ratio = (p.r + q.r - norm(d)) / std::min(p.r, q.r);
    if (ratio > most) most = ratio, a = i, b = j;
  });
  bool with_wall = false;
  std::size_t wall = 0;
  for (const auto& c : e.lists.walls.candidates()) {
    const auto& row = e.particles.position[c.particle];
    visit_surface(e.walls[c.wall].surfaces[c.surface], [&](const auto& surface) {
      SurfacePoint points[std::remove_cvref_t<decltype(surface)>::max_contacts];
      const Vec3d centre = e.lists.walls.in_body(e.walls[c.wall], row.centre());
      int count;
      if constexpr (requires { surface.contacts(centre, row.r, e.lists.walls.facets(c), points); })
        count = surface.contacts(centre, row.r, e.lists.walls.facets(c), points);
      else
        count = surface.contacts(centre, row.r, points);
      for (int k = 0; k < count; ++k)
        if (const double ratio = 1 - points[k].distance / row.r; ratio > most)
          most = ratio, with_wall = true, a = c.particle, wall = c.wall;
    });
  }
  const Vec3d where = e.particles.position[a].centre();
  const auto head = text("step ", step, ", t = ", time, " s: ");
  const auto tail =
      text(e.largest_overlap, " of the radius, above the limit guard.max_overlap = ", limit,
           "; use a stiffer material, a lower speed or a smaller time step, or start "
           "without overlaps");
  if (with_wall)
    throw SimulationError(text(head, "particle ", e.particles.id[a], " at ", where,
                               " m overlaps wall ", wall, " by ", tail),
                          step, {e.particles.id[a]}, where);
  throw SimulationError(text(head, "particles ", e.particles.id[a], " and ", e.particles.id[b],
                             " near ", where, " m overlap by ", tail),
                        step, {e.particles.id[a], e.particles.id[b]}, where);
}

template <class EngineType>
void check_inside(const EngineType& e, const Box& domain, std::int64_t step, double time) {
  for (std::size_t k = 0; k < e.particles.size(); ++k) {
    const Vec3d p = e.particles.position[k].centre();
    if (domain.contains(p) || e.particles.is_parked(k)) continue;
    throw SimulationError(
        text("step ", step, ", t = ", time, " s: particle ", e.particles.id[k], " at ", p,
             " m is outside guard.domain from ", domain.min, " to ", domain.max,
             " m; close the walls, add an outlet where particles may leave, or enlarge the domain"),
        step, {e.particles.id[k]}, p);
  }
}

}  // namespace detail
}  // namespace silt
