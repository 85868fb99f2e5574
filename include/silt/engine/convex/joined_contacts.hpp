// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/engine/convex/contacts_with_wall.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/engine/lists/wall_seams.hpp>

/// Contacts of one convex part with a wall and its images in a periodic box. `List`: WallContacts.
/// Tests: tests/engine/wall_images_bodies.cpp

namespace silt::inline SILT_TARGET::detail {

/// The contacts of a row with this centre [m] and the image of a wall that a candidate belongs to;
/// points are near the row.
template <class Rows, class List, class Candidate>
int contacts_with_image(const Rows& rows, const Vec3d& centre, const Wall& wall, const List& list,
                        const Candidate& c, SolidContact (&found)[most_wall_contacts]) {
  const Vec3d seen = list.seen(c, centre);
  const int count = contacts_with_wall(rows, c.particle, seen, wall, wall.surfaces[c.surface],
                                       list.facets(c), found);
  if constexpr (List::repeats)
    for (int k = 0; c.image != 0 && k < count; ++k) found[k].point += centre - seen;
  return count;
}

/// The contacts of one convex part with a surface and its images, all shifted to the part. Where
/// images join or overlap, a place of the part has one contact, as on one surface. Contacts of
/// sharp polyhedra with meshes: one per patch, whichever images it is seen in.
template <class Candidate>
struct JoinedContacts {
  static constexpr std::size_t most = 64;
  SolidContact contact[most];
  const Candidate* of[most];
  std::size_t count = 0;

  /// each(image, found): the contacts with one image.
  template <class Rows, class List, class Each>
  void join(const Rows& rows, const Vec3d& centre, const Wall& wall, const List& list,
            std::span<const Candidate> images, const Each& each) {
    if (join_patches(rows, centre, wall, list, images)) return;
    SolidContact found[most_wall_contacts];
    for (const Candidate& image : images) {
      const int n = each(image, found);
      for (int k = 0; k < n && count < most; ++k) contact[count] = found[k], of[count++] = &image;
    }
    drop_seams(wall.surfaces[images[0].surface], 1e-6 * rows.pose[images[0].particle].least_radius);
  }

 private:
  /// Returns false if it is not a mesh, or not a sharp polyhedron.
  template <class Rows, class List>
  bool join_patches(const Rows& rows, const Vec3d& centre, const Wall& wall, const List& list,
                    std::span<const Candidate> images) {
    const auto* const mesh =
        std::get_if<std::shared_ptr<const TriangleMesh>>(&wall.surfaces[images[0].surface]);
    if (mesh == nullptr) return false;
    bool sharp = false;
    const Vec3d at = in_wall(wall, centre);
    rows.visit(images[0].particle, at, [&](auto body) {
      if constexpr (std::is_same_v<decltype(body), PlacedPolyhedron>) {
        sharp = body.shape->radius() == 0;
        if (!sharp) return;
        if (wall.moves()) turn_into(wall.pose, body);
        DeepestContacts deepest{contact, most_wall_contacts};
        SurfaceDepth depth(body, **mesh);
        for (const Candidate& image : images) {
          const Vec3d way = in_wall(wall, list.seen(image, centre)) - at;
          for (const auto t : list.facets(image)) depth.add(t, way);
        }
        depth.write(deepest);
        count = static_cast<std::size_t>(deepest.count);
      }
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (wall.moves()) into_space(wall.pose, contact[k]);
      of[k] = &nearest_image(contact[k].point, images, wall, list);
    }
    return sharp;
  }

  /// `tolerance` [m] within which depths count as equal.
  void drop_seams(const Surface& surface, double tolerance) {
    const auto* const mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&surface);
    const double smooth = mesh != nullptr ? (*mesh)->cos_smooth_angle() : 1 - 1e-9;
    bool dropped[most] = {};
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count && !dropped[a]; ++b) {
        if (of[a] == of[b] || dropped[b]) continue;
        dropped[a] = (mesh != nullptr && is_seam(contact[a], contact[b], b < a, tolerance)) ||
                     is_same(contact[a], contact[b], b < a, smooth, tolerance);
      }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; ++k)
      if (!dropped[k]) contact[kept] = contact[k], of[kept++] = of[k];
    count = kept;
  }

  static bool is_edge(const SolidContact& c) { return c.feature >= Polyhedron::most_vertices; }

  /// Whether `a` is an edge or corner of a mesh in the tangent plane of another contact `b` that is
  /// deeper, or equally deep and a face or the first.
  static bool is_seam(const SolidContact& a, const SolidContact& b, bool first, double tolerance) {
    if (!is_edge(a) || !(dot(a.normal, b.normal) > 0.5)) return false;
    const double deeper = b.overlap - a.overlap;
    const double off = std::abs(dot(a.point - b.point, b.normal));
    return (deeper > tolerance || (deeper > -tolerance && (!is_edge(b) || first))) &&
           off <= tolerance + a.overlap + b.overlap;
  }

  /// Whether `a` is the same contact as `b`, seen by another image, and less deep, or equally deep
  /// and later.
  static bool is_same(const SolidContact& a, const SolidContact& b, bool first, double smooth,
                      double tolerance) {
    if (!(b.overlap > a.overlap || (b.overlap == a.overlap && first))) return false;
    if (!(dot(a.normal, b.normal) > smooth)) return false;
    if (a.feature != b.feature && !is_edge(a) && !is_edge(b)) return false;  // corners of the part
    const double turn = norm(a.normal - b.normal);
    return norm(a.point - b.point) <= 1.5 * std::max(a.R_eff, b.R_eff) * turn + tolerance;
  }
};

/// Calls visit(contact, image) for the contacts of a row with the images of one surface.
template <class Rows, class List, class Candidate, class Visit>
void for_each_joined(const Rows& rows, const Vec3d& centre, const Wall& wall, const List& list,
                     std::span<const Candidate> images, const Visit& visit) {
  if (images.size() > 1) {
    JoinedContacts<Candidate> all;
    all.join(rows, centre, wall, list, images, [&](const Candidate& image, auto& found) {
      return contacts_with_image(rows, centre, wall, list, image, found);
    });
    for (std::size_t k = 0; k < all.count; ++k) visit(all.contact[k], *all.of[k]);
    return;
  }
  SolidContact found[most_wall_contacts];
  const int count = contacts_with_image(rows, centre, wall, list, images[0], found);
  for (int k = 0; k < count; ++k) visit(found[k], images[0]);
}

}  // namespace silt::detail
