// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <variant>

#include <silt/boundary/surface_point.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/engine/lists/wall_candidate.hpp>

/// Seams between surfaces, and between the images of one surface, as seen by spheres.

namespace silt::inline SILT_TARGET::detail {

/// A point where a sphere touches a surface.
struct Touch {
  SurfacePoint point;     // normal in the space frame
  std::size_t candidate;  // index among the candidates of the sphere
  bool seam;              // a duplicate of another contact of the sphere
};

/// Where two surfaces join, the rim or edge of one lies in the tangent plane of the other; it is a
/// seam and not a second contact.
inline void drop_seams(std::span<Touch> found, double tolerance) {
  for (std::size_t a = 0; a < found.size(); ++a)
    for (std::size_t b = 0; b < found.size() && !found[a].seam; ++b) {
      if (found[a].candidate == found[b].candidate || found[b].seam) continue;
      const double deeper = found[a].point.distance - found[b].point.distance;
      const bool second = deeper > tolerance || (deeper > -tolerance && b < a);
      if (second && in_tangent_plane(found[a].point, found[b].point, tolerance))
        found[a].seam = true;
    }
}

/// The same for a surface and its images, to which all of `found` belong. As they are one surface,
/// the deepest contact is kept, however small the difference. Mesh facets that meet at less than
/// the smooth angle count as one, as within the mesh.
inline void drop_image_seams(std::span<Touch> found, const Surface& surface, double tolerance) {
  const auto* const mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&surface);
  for (std::size_t a = 0; a < found.size(); ++a)
    for (std::size_t b = 0; b < found.size() && !found[a].seam; ++b) {
      const SurfacePoint &one = found[a].point, &other = found[b].point;
      if (found[a].candidate == found[b].candidate || found[b].seam) continue;
      if (!(one.distance > other.distance || (one.distance == other.distance && b < a))) continue;
      found[a].seam =
          in_tangent_plane(one, other, tolerance) ||
          (mesh != nullptr && dot(one.normal, other.normal) > (*mesh)->cos_smooth_angle());
    }
}

/// The same surface by surface, for all points where a sphere touches its candidates.
template <class Candidate>
void drop_image_seams(std::span<Touch> found, std::span<const Candidate> candidates,
                      std::span<const Wall> walls, double tolerance) {
  for (std::size_t k = 0, next = 0; k < found.size(); k = next) {
    const Candidate& c = candidates[found[k].candidate];
    while (next < found.size() && same_surface(c, candidates[found[next].candidate])) ++next;
    drop_image_seams(found.subspan(k, next - k), walls[c.wall].surfaces[c.surface], tolerance);
  }
}

/// The image of one surface that is nearest to a point [m] near a sphere.
template <class Candidate, class Contacts>
const Candidate& nearest_image(const Vec3d& point, std::span<const Candidate> images,
                               const Wall& wall, const Contacts& contacts) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  double least = far;
  for (std::size_t k = 0; k < images.size() && images.size() > 1; ++k) {
    const Vec3d at = in_wall(wall, contacts.seen(images[k], point));
    double distance = far;
    visit_surface(wall.surfaces[images[k].surface], [&](const auto& surface) {
      if constexpr (requires { surface.distance_to(0u, at); }) {
        for (const std::uint32_t t : contacts.facets(images[k]))
          distance = std::min(distance, surface.distance_to(t, at));
      } else {
        SurfacePoint nearest[std::remove_cvref_t<decltype(surface)>::max_contacts];
        if (surface.contacts(at, far, nearest) > 0) distance = std::abs(nearest[0].distance);
      }
    });
    if (distance < least) least = distance, best = k;
  }
  return images[best];
}

}  // namespace silt::detail
