// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/simulation.hpp>

/// Data for scene_warnings (io/scene_warnings.hpp): size of the scene, properties of its particles,
/// and whether its walls can hold them. Tests: tests/io/scene_warnings.cpp

namespace silt::inline SILT_TARGET::detail {

/// Extent of a scene and extremes of its particles and inlets.
struct SceneLook {
  static constexpr double far = std::numeric_limits<double>::infinity();
  std::size_t particles = 0;                         // there now
  std::size_t wall_parts = 0;                        // surfaces of all walls
  Box centres;                                       // [m] of particles and regions of inlets
  Box all;                                           // [m] of particles, inlets and finite walls
  double smallest_radius = far, largest_radius = 0;  // [m] bodies: of bounding spheres
  double list_diameter = far;  // [m] determines the reaches of neighbour lists, or less
  double largest_density = 0;  // [kg/m3] of movable particles
  double fastest = 0;          // [m/s]
  bool some_fixed = false;     // particles that are fixed
  bool walls_move = false;

  /// Adds the particles of other ranks (collective).
  template <class Sim>
  void include_ranks(const Sim& sim) {
    particles = static_cast<std::size_t>(sim.sum_over_ranks(static_cast<double>(particles)));
    centres = sim.engine().ranks.union_of(centres);
    smallest_radius = -sim.largest_over_ranks(-smallest_radius);
    largest_radius = sim.largest_over_ranks(largest_radius);
    list_diameter = -sim.largest_over_ranks(-list_diameter);
    largest_density = sim.largest_over_ranks(largest_density);
    fastest = sim.largest_over_ranks(fastest);
    some_fixed = sim.largest_over_ranks(some_fixed ? 1 : 0) > 0;
  }
  bool is_empty() const { return !(centres.min.x <= centres.max.x); }
};

template <class Sim>
SceneLook look_at(const Sim& sim) {
  SceneLook look;
  const auto include_radius = [&look](double least, double most) {
    look.smallest_radius = std::min(look.smallest_radius, least);
    look.largest_radius = std::max(look.largest_radius, most);
  };
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    ++look.particles;
    look.centres.include(sim.position(k));
    include_radius(sim.radius(k), sim.radius(k));
    look.fastest = std::max(look.fastest, norm(sim.velocity(k)));
    if (const double m = sim.mass(k); std::isfinite(m))
      look.largest_density = std::max(look.largest_density, m / sim.engine().volume_of(k));
    else
      look.some_fixed = true;
  }
  if (look.particles > 0) look.list_diameter = sim.engine().particles.mean_diameter;
  if constexpr (Sim::has_ranks) look.include_ranks(sim);
  look.all = look.centres.grown(look.largest_radius);
  for (std::size_t k = 0; k < sim.inlets(); ++k) {
    const auto& inlet = sim.inlet(k);
    look.centres.include(inlet.bounds), look.all.include(inlet.bounds);
    for (std::size_t kind = 0; kind < inlet.flow.kinds(); ++kind) {
      const auto of = inlet.flow.kind(kind);
      include_radius(of.radius.min(), of.radius.max());
      look.list_diameter = std::min(look.list_diameter, 2 * of.radius.min());
    }
    look.fastest = std::max(look.fastest, norm(inlet.flow.velocity) + norm(inlet.flow.scatter));
    look.largest_density = std::max(look.largest_density, inlet.flow.density);
  }
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    look.wall_parts += wall.surfaces.size();
    look.walls_move |= wall.moves() && !wall.surfaces.empty();
    for (const auto& surface : wall.surfaces) {
      const Box b = bounds_in_space(wall, surface);
      if (is_finite(b.min) && is_finite(b.max)) look.all.include(b);
    }
  }
  return look;
}

/// Extent of the box along the unit vector `way` [m].
inline double reach_along(const Box& box, const Vec3d& way) {
  const auto part = [](double w, double low, double high) {
    return w > 0 ? w * high : w < 0 ? w * low : 0;  // sides may be infinite
  };
  return part(way.x, box.min.x, box.max.x) + part(way.y, box.min.y, box.max.y) +
         part(way.z, box.min.z, box.max.z);
}

/// The gap between two boxes [m], 0 if they meet.
inline double gap_between(const Box& a, const Box& b) {
  const Vec3d gap{std::max({0.0, a.min.x - b.max.x, b.min.x - a.max.x}),
                  std::max({0.0, a.min.y - b.max.y, b.min.y - a.max.y}),
                  std::max({0.0, a.min.z - b.max.z, b.min.z - a.max.z})};
  return norm(gap);
}

/// Whether a surface at rest has points where a particle pulled along the unit vector `down` stays.
/// `from` [m]: position of the uppermost particle along `down`; a surface above it holds none.
inline bool may_hold(const Plane& plane, const Vec3d& down, double) {
  return dot(plane.normal, down) < -1e-6;
}
inline bool may_hold_round(const Vec3d& axis, double widening, Side side, const Vec3d& down) {
  const double along = dot(axis, down);
  if (std::abs(along) < (1 - 1e-9) * norm(axis)) return true;  // it lies aslant
  const double wider_below = along > 0 ? widening : -widening;
  return side == Side::Inside ? wider_below < 0 : wider_below > 0;
}
inline bool may_hold(const Cylinder& c, const Vec3d& down, double from) {
  return reach_along(c.bounds(), down) > from && may_hold_round(c.to - c.from, 0, c.side, down);
}
inline bool may_hold(const Cone& c, const Vec3d& down, double from) {
  return reach_along(c.bounds(), down) > from &&
         may_hold_round(c.to - c.from, c.radius_to - c.radius_from, c.side, down);
}
inline bool may_hold(const TriangleMesh& mesh, const Vec3d& down, double from) {
  const auto& p = mesh.vertices();
  return std::any_of(mesh.triangles().begin(), mesh.triangles().end(), [&](const auto& corners) {
    const Vec3d &a = p[corners[0]], &b = p[corners[1]], &c = p[corners[2]];
    const Vec3d normal = cross(b - a, c - a);
    return std::abs(dot(normal, down)) > 1e-3 * norm(normal) &&
           std::max({dot(a, down), dot(b, down), dot(c, down)}) > from;
  });
}

/// Whether some wall may hold particles pulled along `down`. Moving walls are assumed to.
template <class Sim>
bool walls_may_hold(const Sim& sim, const SceneLook& look, const Vec3d& down) {
  if (look.walls_move || look.is_empty()) return true;
  const double from = -reach_along(look.centres, -down);
  for (std::size_t w = 0; w < sim.walls(); ++w)
    for (const auto& surface : sim.wall(w).surfaces)
      if (visit_surface(surface, [&](const auto& s) { return may_hold(s, down, from); }))
        return true;
  return false;
}

/// Whether the whole box is behind a plane of the wall, which is at rest.
inline bool is_behind(const Box& box, const Wall& wall) {
  if (wall.moves()) return false;
  return std::any_of(wall.surfaces.begin(), wall.surfaces.end(), [&](const Surface& surface) {
    const auto* plane = std::get_if<Plane>(&surface);
    return plane != nullptr && reach_along(box, plane->normal) <= dot(plane->point, plane->normal);
  });
}

}  // namespace silt::detail
