// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <variant>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/scene_look.hpp>
#include <silt/io/warning_limits.hpp>

/// Warnings about single settings of a scene: friction, a belt, the size of a mesh, an outlet, a
/// motion.
/// Parts of scene_warnings() (io/scene_warnings.hpp). Tests: tests/io/scene_warnings.cpp.

namespace silt::inline SILT_TARGET::detail {

/// Friction [-] in the coefficients of a law, also of one that others are built on; else 0.
template <class Coefficients>
double friction_of(const Coefficients& c) {
  if constexpr (requires { c.friction; })
    return c.friction;
  else if constexpr (requires { c.body; })
    return friction_of(c.body);
  else
    return 0;
}

/// Coefficient of rolling friction [-] of a model, also of one of two; else 0.
template <class Coefficients>
double rolling_friction_of(const Coefficients& c) {
  if constexpr (requires { c.rolling_friction; })
    return c.rolling_friction;
  else if constexpr (requires { c.first, c.second; })
    return std::max(rolling_friction_of(c.first), rolling_friction_of(c.second));
  else
    return 0;
}

/// A coefficient in per cent is accepted by every law.
template <class Sim>
void warn_of_friction(const Sim& sim, DynArray<std::string>& out) {
  const auto& contacts = sim.contacts();
  const auto warn = [&](const char* name, double limit, const char* usual, const auto& of) {
    double most = 0;
    std::size_t i = 0, j = 0;
    for (std::size_t a = 0; a < contacts.materials(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        if (!contacts.has_pair(a, b)) continue;
        if (const double mu = of(a, b); mu > most) most = mu, i = b, j = a;
      }
    if (!(most > limit)) return;
    out.push_back(text(name, " = ", about(most), " [-] between ", contacts.material_name(i),
                       " and ", i == j ? std::string("itself") : contacts.material_name(j),
                       " is larger than that of any solid, which is seldom above ", usual,
                       "; if it was meant in per cent, give ", about(most / 100)));
  };
  warn("friction", WarningLimits::most_friction, "1",
       [&](std::size_t a, std::size_t b) { return friction_of(contacts.coefficients(a, b)); });
  warn("rolling_friction", WarningLimits::most_rolling_friction, "0.5",
       [&](std::size_t a, std::size_t b) {
         return rolling_friction_of(contacts.rolling_coefficients(a, b));
       });
}

/// Only the tangential part of a surface velocity acts: that of a plane along its normal does
/// nothing.
template <class Sim>
void warn_of_belts(const Sim& sim, DynArray<std::string>& out) {
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const SurfaceVelocity& belt = sim.wall(w).belt;
    if (sim.wall(w).surfaces.size() != 1 || belt.is_zero() || !(belt.rate == Vec3d{0, 0, 0}))
      continue;
    const auto* plane = std::get_if<Plane>(&sim.wall(w).surfaces[0]);
    if (plane == nullptr) continue;
    const Vec3d normal = sim.wall(w).pose.rotate(plane->unit().normal);
    if (norm(belt.at(plane->point, normal)) > 1e-6 * norm(belt.velocity)) continue;
    out.push_back(text("surface_velocity = ", belt.velocity, " [m/s] of ", sim.wall_name(w),
                       " is along its normal and has no effect, since only the part along the "
                       "surface acts; a wall that moves so has a motion: translation(velocity)"));
  }
}

/// A file in mm read as if it were in m.
template <class Sim>
void warn_of_meshes(const Sim& sim, const SceneLook& look, DynArray<std::string>& out) {
  if (look.is_empty() || (look.particles < WarningLimits::few && sim.inlets() == 0)) return;
  const double size = norm(look.centres.grown(look.largest_radius).extent());
  for (std::size_t w = 0; w < sim.walls(); ++w)
    for (const Surface& surface : sim.wall(w).surfaces) {
      if (!is_mesh(surface)) continue;
      const double mesh =
          norm(visit_surface(surface, [](const auto& s) { return s.bounds(); }).extent());
      if (!(mesh > WarningLimits::largest_mesh * size)) continue;
      out.push_back(text("the mesh of ", sim.wall_name(w), " measures ", about(mesh), " m, ",
                         about(mesh / size), " times the ", about(size),
                         " m of all particles and inlets; if its file is in mm, read it with a "
                         "scale, as by mesh_wall(file, 1e-3)"));
      return;
    }
}

/// Warns of an outlet around the particles that are there; false if it is in order.
template <class Sim>
bool warn_of_emptying(const Sim& sim, const SceneLook& look, std::size_t outlet,
                      DynArray<std::string>& out) {
  const Box& region = sim.outlet(outlet).region;
  if (look.particles < WarningLimits::few || sim.outlet(outlet).count > 0) return false;
  double inside = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    inside += sim.is_present(k) && region.contains(sim.position(k));
  inside = sim.sum_over_ranks(inside);
  const auto all = static_cast<double>(look.particles);
  if (inside < all && (sim.step() > 0 || inside <= WarningLimits::emptied_at_start * all))
    return false;
  out.push_back(text("outlet ", outlet, " from ", region.min, " to ", region.max, " m contains ",
                     static_cast<std::size_t>(inside), " of ", look.particles,
                     " particles and will remove them in the first step; give it the place where "
                     "particles are to leave"));
  return true;
}

/// An inlet in an outlet, which removes what it places.
template <class Sim>
void warn_of_inlets(const Sim& sim, DynArray<std::string>& out) {
  for (std::size_t i = 0; i < sim.inlets(); ++i)
    for (std::size_t k = 0; k < sim.outlets(); ++k) {
      const Box &in = sim.inlet(i).bounds, &region = sim.outlet(k).region;
      if (!region.contains(in.min) || !region.contains(in.max)) continue;
      out.push_back(text("inlet ", i, " from ", in.min, " to ", in.max, " m lies in outlet ", k,
                         ", which removes the particles that it places; move one of them"));
    }
}

/// A free wall whose centre of mass is far outside of its surfaces, as one that was left out.
template <class Sim>
void warn_of_centres(const Sim& sim, DynArray<std::string>& out) {
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    const auto* body = std::get_if<FreeBody>(&wall.drive);
    if (body == nullptr || !is_finite(wall.extent.min) || !is_finite(wall.extent.max)) continue;
    const double size = norm(wall.extent.extent()),
                 off = gap_between(Box{body->centre, body->centre}, wall.extent);
    if (!(off > size)) continue;
    out.push_back(text("FreeBody.centre = ", body->centre, " [m] of ", sim.wall_name(w), " is ",
                       about(off), " m outside of its surfaces, which are ", about(size),
                       " m across; give the centre of mass in the coordinates of the surfaces, as "
                       "free_body(mesh, density) does"));
  }
}

/// A wall that was added just now, in a scene that has run, and whose motion has moved it off the
/// surface that was given. A wall that turns stays in its place.
template <class Sim>
void warn_of_late_motions(const Sim& sim, DynArray<std::string>& out) {
  for (std::size_t w = 0; w < sim.walls(); ++w) {
    const Wall& wall = sim.wall(w);
    if (!(wall.added > 0) || wall.added != sim.time() || !wall.motion || wall.state.changed != 0 ||
        wall.motion.template target<Rotation>() != nullptr)
      continue;
    const Pose& p = wall.pose;
    const double turned = norm(Vec3d{p.rotation.x, p.rotation.y, p.rotation.z});
    if (!(norm(p.translation) > 0) && !(turned > 0)) continue;
    out.push_back(text(sim.wall_name(w), " was added at ", about(wall.added),
                       " s, and its motion, which counts from time 0, has already moved it by ",
                       p.translation, " m; let the motion begin now: from(sim.time(), motion)"));
  }
}

}  // namespace silt::detail
