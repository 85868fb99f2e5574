// silt - BSD-3-Clause, see LICENSE
#pragma once

// The region in which infinite planes are drawn: it follows from the present scene alone, so that a
// continued run draws what one that was not interrupted does.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET::detail {

inline double& component(Vec3d& v, std::size_t d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }
inline double component(const Vec3d& v, std::size_t d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }
inline bool is_empty(const Box& box) { return !(box.min.x <= box.max.x); }

/// The planes of a wall at its present pose, with unit normals.
inline DynArray<Plane> planes_of(const Wall& wall) {
  DynArray<Plane> planes;
  for (const Surface& surface : wall.surfaces)
    if (const auto* plane = std::get_if<Plane>(&surface))
      planes.push_back(
          Plane{wall.pose.to_space(plane->point), wall.pose.rotate(plane->normal)}.unit());
  return planes;
}

/// Two planes of one wall that face each other, at low <= dot(normal, x) <= high.
struct FacingPlanes {
  Vec3d normal;      // [-]
  double low, high;  // [m]
};
/// Those that are at most ten times as far apart as the closest of the wall. Farther ones, as of a
/// box in a periodic direction, are not where the scene ends.
[[gnu::cold]] inline DynArray<FacingPlanes> facing_planes(const DynArray<Plane>& planes) {
  constexpr double most = 10;  // [-]
  DynArray<FacingPlanes> pairs;
  double closest = std::numeric_limits<double>::infinity();  // [m]
  for (std::size_t a = 0; a < planes.size(); ++a)
    for (std::size_t b = a + 1; b < planes.size(); ++b) {
      const Vec3d& n = planes[a].normal;
      if (!(norm(n + planes[b].normal) < 1e-9)) continue;
      const double low = dot(n, planes[a].point), high = dot(n, planes[b].point);
      if (!(low < high)) continue;
      pairs.push_back({n, low, high});
      closest = std::min(closest, high - low);
    }
  erase_if(pairs,
           [&](const FacingPlanes& p) { return p.high - p.low > most * (1 + 1e-9) * closest; });
  return pairs;
}

/// Corners of the first three pairs with independent normals; none if there are no three.
[[gnu::cold]] inline Box bounds_of(const DynArray<FacingPlanes>& pairs) {
  Box all;
  const std::size_t n = pairs.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t c = b + 1; c < n; ++c) {
        const Vec3d ab = cross(pairs[a].normal, pairs[b].normal),
                    bc = cross(pairs[b].normal, pairs[c].normal),
                    ca = cross(pairs[c].normal, pairs[a].normal);
        const double volume = dot(ab, pairs[c].normal);
        if (std::abs(volume) < 1e-3) continue;
        for (int k = 0; k < 8; ++k)
          all.include((1 / volume) * ((k & 1 ? pairs[a].high : pairs[a].low) * bc +
                                      (k & 2 ? pairs[b].high : pairs[b].low) * ca +
                                      (k & 4 ? pairs[c].high : pairs[c].low) * ab));
        return all;
      }
  return all;
}

/// A plane across an axis of space: its place on the axis, and the way that it faces.
struct PlaneAcross {
  std::size_t axis;
  double place;  // [m]
  bool upwards;  // towards larger coordinates
};
[[gnu::cold]] inline DynArray<PlaneAcross> planes_across(const DynArray<Plane>& planes) {
  DynArray<PlaneAcross> all;
  for (const Plane& plane : planes)
    for (std::size_t d = 0; d < 3; ++d)
      if (const double n = component(plane.normal, d); std::abs(n) > 1 - 1e-12)
        all.push_back({d, component(plane.point, d), n > 0});
  return all;
}

/// The region of particles with these centres [m] and this largest radius [m], at least ten radii
/// wide. Where all centres are before a plane it ends at the plane.
[[gnu::cold]] inline Box region_of_particles(const Box& centres, double radius,
                                             const DynArray<PlaneAcross>& planes) {
  Box around = centres.grown(radius);
  for (std::size_t d = 0; d < 3; ++d) {
    double &low = component(around.min, d), &high = component(around.max, d);
    const double missing = 10 * radius - (high - low);
    if (missing > 0) low -= 0.5 * missing, high += 0.5 * missing;
    for (const PlaneAcross& p : planes) {
      if (p.axis != d) continue;
      if (p.upwards && p.place <= component(centres.min, d)) low = std::max(low, p.place);
      if (!p.upwards && p.place >= component(centres.max, d)) high = std::min(high, p.place);
    }
  }
  return around;
}

/// With the region of an Sph, which is where its liquid can be: bodies in it may be far wider than
/// deep, as prisms of a liquid in 2D.
template <class Sim>
concept HasLiquidRegion = requires(const Sim& sim) {
  { sim.fluid().setup().region } -> std::convertible_to<Box>;
};

/// Particles, the region of a liquid, inlets, finite walls, walls of facing planes, and planes
/// across an axis that are at most two extents of all these away. `radius` [m]: the largest.
template <class Sim>
[[gnu::cold]] Box region_of_scene(const Sim& sim, const Box& centres, double radius) {
  DynArray<PlaneAcross> planes;
  Box all;
  DynArray<double> low[3], high[3];  // [m] of facing planes across an axis
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    for (const Surface& surface : wall.surfaces) {
      const Box b = bounds_in_space(wall, surface);
      if (!is_empty(b) && is_finite(b.min) && is_finite(b.max)) all.include(b);
    }
    const auto of_wall = planes_of(wall);
    for (const PlaneAcross& p : planes_across(of_wall)) planes.push_back(p);
    const auto pairs = facing_planes(of_wall);
    all.include(bounds_of(pairs));
    for (const FacingPlanes& pair : pairs)
      for (std::size_t d = 0; d < 3; ++d)
        if (const double n = component(pair.normal, d); std::abs(n) > 1 - 1e-12) {
          low[d].push_back(std::min(n * pair.low, n * pair.high));
          high[d].push_back(std::max(n * pair.low, n * pair.high));
        }
  }
  for (std::size_t k = 0; k < sim.inlets(); ++k) all.include(sim.inlet(k).bounds);
  if (!is_empty(centres)) {
    Box particles = region_of_particles(centres, radius, planes);
    if constexpr (Sim::Domain::periodic && !deforms<typename Sim::Domain>)
      for (std::size_t d = 0; d < 3; ++d)
        if (sim.domain().repeats(static_cast<int>(d))) {
          component(particles.min, d) = component(sim.domain().box().min, d);
          component(particles.max, d) = component(sim.domain().box().max, d);
        }
    if constexpr (HasLiquidRegion<Sim>) {
      Box liquid = sim.fluid().setup().region;
      liquid.include(centres.min), liquid.include(centres.max);
      for (std::size_t d = 0; d < 3; ++d)
        if (component(liquid.max, d) > component(liquid.min, d)) {
          component(particles.min, d) = component(liquid.min, d);
          component(particles.max, d) = component(liquid.max, d);
        }
    }
    all.include(particles);
  }
  if (is_empty(all)) return all;
  for (std::size_t d = 0; d < 3; ++d) {
    for (const double x : low[d]) component(all.min, d) = std::min(component(all.min, d), x);
    for (const double x : high[d]) component(all.max, d) = std::max(component(all.max, d), x);
  }
  const Vec3d e = all.extent();
  const double near = 2 * std::max({e.x, e.y, e.z});  // [m]
  const Box base = all;
  for (const PlaneAcross& p : planes) {
    double &from = component(all.min, p.axis), &to = component(all.max, p.axis);
    if (p.place < component(base.min, p.axis) - near) continue;
    if (p.place > component(base.max, p.axis) + near) continue;
    from = std::min(from, p.place), to = std::max(to, p.place);
  }
  return all;
}

}  // namespace silt::detail
