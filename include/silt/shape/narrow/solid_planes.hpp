// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/plane.hpp>
#include <silt/shape/narrow/placed.hpp>
#include <silt/shape/narrow/thickness_overlap.hpp>

namespace silt::inline SILT_TARGET {

/// Convex bodies at planes, and the common part of all contacts with walls: for solid_walls.hpp.

namespace detail {

template <class Form>
const Vec3d& centre_of(const PlacedSuper<Form>& body) {
  return body.position;
}
inline const Vec3d& centre_of(const PlacedPolyhedron& body) { return body.pose.position; }
/// The deepest contacts of those added; among equally deep ones the first added.
struct DeepestContacts {
  SolidContact* out;
  int most;
  int count = 0;

  void add(const SolidContact& contact) {
    if (!(contact.overlap > 0)) return;
    if (count == most && (most == 0 || !(contact.overlap > out[most - 1].overlap))) return;
    int at = count < most ? count++ : most - 1;
    for (; at > 0 && contact.overlap > out[at - 1].overlap; --at) out[at] = out[at - 1];
    out[at] = contact;
  }
  void remove(int k) { std::copy(out + k + 1, out + count--, out + k); }
};

/// Contact data of an overlap by thickness; `normal`: of the wall.
inline SolidContact solid_contact(const PlacedPolyhedron& body, const VolumeContact& found) {
  return {found.normal,
          found.point,
          found.overlap,
          found.gradient,
          found.couple,
          body.shape->equal_volume_radius(),
          0,
          found.spread};
}

/// A body whose depth in the half-space is that of its support point.
template <class Form>
SolidContact half_space_contact(const PlacedSuper<Form>& body, const Vec3d& at,
                                const Vec3d& normal) {
  const double distance = dot(body.position - at, normal);
  if (!(distance < body.form.bound)) return {};
  Vec3d s, t;
  tangents(normal, s, t);
  const auto cap = body.cap(-normal, s, t);
  SolidContact out;
  out.normal = normal, out.overlap = cap.height - distance;
  if (!(out.overlap > 0)) return {};
  out.point =
      body.position + cap.along_s * s + cap.along_t * t - (0.5 * (cap.height + distance)) * normal;
  out.R_eff = contact_radius(body.form, cap);
  return out;
}
/// Sharp core of a polyhedron, by the thickness of its part in the half-space.
inline SolidContact half_space_contact(const PlacedPolyhedron& body, const Vec3d& at,
                                       const Vec3d& normal) {
  if (!(dot(body.pose.position - at, normal) < bound_of(body))) return {};
  return solid_contact(body, thickness_overlap(body, at, normal));
}

/// Corner v of a dilated core, `height` over a wall.
inline SolidContact corner_contact(const PlacedPolyhedron& body, std::uint32_t v, const Vec3d& at,
                                   double height, const Vec3d& normal) {
  const double r = body.shape->radius();
  return {normal, at - (0.5 * (r + height)) * normal, r - height, 1,
          0,      body.shape->equal_volume_radius(),  v};
}

}  // namespace detail

/// Contacts with a plane with a unit normal.
///
///   super-ellipsoid     one, at the support point: overlap = h(-n) - distance
///   sharp polyhedron    one, thickness_overlap.hpp: with gradient and couple; one completely
///                       behind the plane is `buried`, gradient 0
///   dilated polyhedron  one for each corner of the core nearer than its radius
///
/// Continuous in position and orientation, as long as `most` covers all corners.
/// Tests:   tests/shape/solid_walls.cpp
template <class Form>
int plane_contacts(const PlacedSuper<Form>& body, const Plane& unit_plane, SolidContact* out,
                   int most) {
  detail::DeepestContacts deepest{out, most};
  deepest.add(detail::half_space_contact(body, unit_plane.point, unit_plane.normal));
  return deepest.count;
}
inline int plane_contacts(const PlacedPolyhedron& body, const Plane& unit_plane, SolidContact* out,
                          int most) {
  detail::DeepestContacts deepest{out, most};
  const Vec3d& n = unit_plane.normal;
  const double r = body.shape->radius(), centre = dot(n, body.pose.position - unit_plane.point);
  if (!(centre < detail::bound_of(body))) return 0;
  if (r > 0) {
    const Vec3d in_body = body.pose.turn.back(n);
    const auto& corners = body.shape->vertices();
    for (std::uint32_t v = 0; v < corners.size(); ++v)
      if (const double height = centre + dot(in_body, corners[v]); height < r)
        deepest.add(detail::corner_contact(body, v, body.pose.to_space(corners[v]), height, n));
  } else {
    deepest.add(detail::half_space_contact(body, unit_plane.point, n));
  }
  return deepest.count;
}

}  // namespace silt
