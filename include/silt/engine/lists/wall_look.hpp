// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/engine/lists/wall_seams.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Position of particle k `back` [s] ago.
template <class EngineType>
Vec3d place_before(const EngineType& e, std::size_t k, double back) {
  return e.particles.position[k].centre() - back * e.particles.motion[k].velocity();
}

/// Finds the contacts of a sphere with one surface of a wall, or one image of it: `place` [m] of
/// its centre as seen from there, `within` [m] of which the surface is; returns their number.
template <class Surface, class Candidate, class Contacts>
int touching_points(const Surface& surface, const Wall& wall, const Candidate& c,
                    const Vec3d& place, double within, const Contacts& contacts,
                    SurfacePoint* points) {
  const Vec3d centre = in_wall(wall, place);
  int count;
  if constexpr (requires { surface.contacts(centre, within, contacts.facets(c), points); })
    count = surface.contacts(centre, within, contacts.facets(c), points);
  else
    count = surface.contacts(centre, within, points);
  for (int k = 0; k < count && wall.moves(); ++k)
    points[k].normal = wall.pose.rotate(points[k].normal);
  return count;
}

/// Calls visit(candidate, point) for every contact of a sphere with one surface of a wall, or one
/// image of it, at the positions of `back` [s] ago.
template <class EngineType, class Candidate, class Visit>
void for_each_contact_with(const EngineType& e, const Candidate& c, double back,
                           const Visit& visit) {
  const Wall& wall = e.walls[c.wall];
  const double r = e.particles.position[c.particle].r;
  const Vec3d place = e.lists.walls.seen(c, place_before(e, c.particle, back));
  visit_surface(wall.surfaces[c.surface], [&](const auto& surface) {
    SurfacePoint points[std::remove_cvref_t<decltype(surface)>::max_contacts];
    const int count = touching_points(surface, wall, c, place, r, e.lists.walls, points);
    for (int k = 0; k < count; ++k) visit(c, points[k]);
  });
}

/// The same for a surface and its images, without seams between them.
template <class EngineType, class Candidate, class Visit>
void for_each_contact_of_images(const EngineType& e, std::span<const Candidate> images, double back,
                                const Visit& visit) {
  const Candidate& c = images[0];
  if constexpr (!std::remove_cvref_t<decltype(e.lists.walls)>::repeats) {
    for_each_contact_with(e, c, back, visit);
  } else {
    if (images.size() == 1) return for_each_contact_with(e, c, back, visit);
    DynArray<Touch> found;
    for (std::size_t k = 0; k < images.size(); ++k)
      for_each_contact_with(e, images[k], back, [&](const WallCandidate&, const SurfacePoint& p) {
        found.push_back({p, k, false});
      });
    drop_image_seams(found, e.walls[c.wall].surfaces[c.surface],
                     1e-6 * e.particles.position[c.particle].r);
    for (const Touch& t : found)
      if (!t.seam) visit(images[t.candidate], t.point);
  }
}

/// The same for all spheres and walls, except spheres removed since.
template <class EngineType, class Visit>
void for_each_wall_contact(const EngineType& e, double back, const Visit& visit) {
  const auto all = e.lists.walls.candidates();
  for (std::size_t k = 0, next = 1; k < all.size(); k = next++) {
    if constexpr (std::remove_cvref_t<decltype(e.lists.walls)>::repeats)
      next = end_of_images(all, k);
    if (all[k].surface < e.walls[all[k].wall].surfaces.size())
      for_each_contact_of_images(e, all.subspan(k, next - k), back, visit);
  }
}

}  // namespace silt::detail
