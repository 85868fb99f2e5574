// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <type_traits>

#include <silt/engine/lists/wall_contacts.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Where particle k was `back` [s] ago.
template <class EngineType>
Vec3d place_before(const EngineType& e, std::size_t k, double back) {
  return e.particles.position[k].centre() - back * e.particles.motion[k].velocity();
}

/// Calls visit(candidate, point) for every contact of a sphere with a wall, the spheres where they
/// were `back` [s] ago.
template <class EngineType, class Visit>
void for_each_wall_contact(const EngineType& e, double back, const Visit& visit) {
  for (const auto& c : e.lists.walls.candidates()) {
    const Wall& wall = e.walls[c.wall];
    const double r = e.particles.position[c.particle].r;
    const Vec3d centre = in_wall(wall, place_before(e, c.particle, back));
    visit_surface(wall.surfaces[c.surface], [&](const auto& surface) {
      SurfacePoint points[std::remove_cvref_t<decltype(surface)>::max_contacts];
      int count;
      if constexpr (requires { surface.contacts(centre, r, e.lists.walls.facets(c), points); })
        count = surface.contacts(centre, r, e.lists.walls.facets(c), points);
      else
        count = surface.contacts(centre, r, points);
      for (int k = 0; k < count; ++k) {
        if (wall.moves()) points[k].normal = wall.pose.rotate(points[k].normal);
        visit(c, points[k]);
      }
    });
  }
}

}  // namespace silt::detail
