// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/engine/lists/wall_seams.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Where particle k was `back` [s] ago.
template <class EngineType>
Vec3d place_before(const EngineType& e, std::size_t k, double back) {
  return e.particles.position[k].centre() - back * e.particles.motion[k].velocity();
}

/// Calls visit(candidate, point) for every contact of a sphere with one surface of a wall, or one
/// image of it, the spheres where they were `back` [s] ago.
template <class EngineType, class Candidate, class Visit>
void for_each_contact_with(const EngineType& e, const Candidate& c, double back,
                           const Visit& visit) {
  const Wall& wall = e.walls[c.wall];
  const double r = e.particles.position[c.particle].r;
  const Vec3d centre = in_wall(wall, e.lists.walls.seen(c, place_before(e, c.particle, back)));
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

/// The same for a surface and its images, without the seams between them.
template <class EngineType, class Candidate, class Visit>
void for_each_contact_of_images(const EngineType& e, std::span<const Candidate> images, double back,
                                const Visit& visit) {
  const Candidate& c = images[0];
  if constexpr (!std::remove_cvref_t<decltype(e.lists.walls)>::repeats) {
    for_each_contact_with(e, c, back, visit);
  } else {
    if (images.size() == 1) return for_each_contact_with(e, c, back, visit);
    std::vector<Touch> found;
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

/// The same for all spheres and walls.
template <class EngineType, class Visit>
void for_each_wall_contact(const EngineType& e, double back, const Visit& visit) {
  const auto all = e.lists.walls.candidates();
  for (std::size_t k = 0, next = 1; k < all.size(); k = next++) {
    if constexpr (std::remove_cvref_t<decltype(e.lists.walls)>::repeats)
      next = end_of_images(all, k);
    for_each_contact_of_images(e, all.subspan(k, next - k), back, visit);
  }
}

/// Begins the contacts with walls that bonds held so far: what they overlap by now is left out of
/// them, by their history of the number `offset`.
template <class EngineType>
void begin_freed_at_walls(EngineType& e, std::size_t offset) {
  auto& walls = e.lists.walls;
  for (const auto& [id, wall] : e.particles.bonds.freed_at_walls)
    for (const auto& c : walls.candidates()) {
      if (c.particle != e.find(id) || c.wall != wall) continue;
      std::size_t slot = c.slot;
      for_each_contact_with(e, c, 0, [&](const auto&, const SurfacePoint& p) {
        const std::size_t end = c.slot + walls.slots_of(e.walls[c.wall].surfaces[c.surface]);
        while (slot < end && walls.slot(slot).touching) ++slot;  // images have theirs in common
        if (slot == end) return;
        walls.slot(slot) = {p.normal, true};
        walls.history(offset)[slot] = static_cast<typename EngineType::Scalar>(
            std::max(e.particles.position[c.particle].r - p.distance, 0.0));
      });
    }
  e.particles.bonds.freed_at_walls.clear();
}

}  // namespace silt::detail
