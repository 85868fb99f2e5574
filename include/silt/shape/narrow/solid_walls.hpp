// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/shape/narrow/solid_round_search.hpp>

namespace silt::inline SILT_TARGET {

/// Contacts of convex bodies with walls, all in the wall's frame: planes (solid_planes.hpp),
/// cylinders and cones; meshes in solid_mesh_contacts.hpp.
///
/// Every function writes up to `most` contacts with overlap > 0, deepest first, and returns how
/// many. The normal is from the wall to the body, the point midway between the surfaces. From one
/// step to the next a contact is the one of the same feature with the nearest normal:
///   polyhedra         a corner's number, where corners touch on their own; else 0
///   super-ellipsoids  on the inner side of a round wall the edge or corner of the body; else 0
///   meshes            see mesh_contacts()
/// More contacts than `most`: those kept change by a jump as they change places in depth.

namespace detail {

/// A contact at p, `beyond` the surface; free normal = -side N. `grow`: dilation of the body.
template <class Body>
SolidContact round_contact(const RoundWall& wall, const Body& body, const Vec3d& p, const Vec3d& e,
                           double side, double grow) {
  const Vec3d N = wall.normal(e);
  const double beyond = wall.beyond(p, N);
  SolidContact out;
  out.normal = -side * N, out.overlap = side * beyond + grow;
  out.point = wall.from + p + (0.5 * (side * grow - beyond)) * N;
  out.R_eff = contact_radius_at(body, side * N);
  return out;
}

/// Which edge or corner of the body p is near, 0 to 26, by its place over the semi-axes; 13 where
/// the body is round. Exponents up to 3 count as round: a rolling body keeps its feature.
template <class Form>
std::uint32_t body_cell(const PlacedSuper<Form>& body, const Vec3d& p) {
  const Vec3d at = body.axes.to_body(p), a2 = body.form.axes2_towards(at);
  const auto third = [](double x, double square, double dual_exponent) -> std::uint32_t {
    return dual_exponent >= 1.5 || 4 * x * x < square ? 1 : x > 0 ? 2 : 0;
  };
  return third(at.x, a2.x, body.form.p2) + 3 * third(at.y, a2.y, body.form.p2) +
         9 * third(at.z, a2.z, body.form.p1);
}

template <class Form>
int inner_contacts(const RoundWall& wall, const PlacedSuper<Form>& body, DeepestContacts& deepest) {
  const InnerMaxima<Form> maxima(wall, body);
  std::array<std::uint8_t, 27> seen{};
  for (int k = 0; k < maxima.count(); ++k) {
    const auto& at = maxima[k];
    if (!wall.between_ends(at.p, at.e)) continue;
    auto contact = round_contact(wall, body, at.p, at.e, 1, 0);
    const auto cell = body_cell(body, wall.from + at.p - body.position);
    contact.feature = cell + 27u * seen[cell]++;
    deepest.add(contact);
  }
  return deepest.count;
}
inline int inner_contacts(const RoundWall& wall, const PlacedPolyhedron& body,
                          DeepestContacts& deepest) {
  const auto& corners = body.shape->vertices();
  const double r = body.shape->radius();
  for (std::uint32_t v = 0; v < corners.size(); ++v) {
    const Vec3d p = body.pose.to_space(corners[v]) - wall.from;
    const double z = dot(p, wall.axis);
    const Vec3d across = p - z * wall.axis;
    const double distance = norm(across);
    if (!(wall.n_r * distance + wall.n_z * z - wall.offset + r > 0)) continue;
    const Vec3d e = distance > 0 ? across * (1 / distance) : wall.x;
    if (!wall.between_ends(p, e)) continue;
    auto contact = round_contact(wall, body, p, e, 1, r);
    contact.feature = v;
    deepest.add(contact);
  }
  return deepest.count;
}

template <class Form>
int outer_contacts(const RoundWall& wall, const PlacedSuper<Form>& body, DeepestContacts& deepest) {
  if (support_at(wall, body, 0, -1).beyond >= 0) return 0;  // this plane parts them
  const double range = outer_range(wall, body.form.bound);
  const auto at = turning_point(wall, body, -range, range, 0, -1);
  if (at.beyond < 0 && wall.between_ends(at.p, at.e))
    deepest.add(round_contact(wall, body, at.p, at.e, -1, 0));
  return deepest.count;
}

/// A face or edge along the wall touches on a line: the middle of what lies on the wall.
inline int outer_contacts(const RoundWall& wall, const PlacedPolyhedron& body,
                          DeepestContacts& deepest) {
  const OuterAngle best(wall, body);
  const double r = body.shape->radius();
  if (best.beyond() >= r) return 0;
  const Vec3d e = wall.e(best.phi());
  const auto line = touching_line(wall, body, e, best.beyond());
  const double low = std::max(line.low, 0.0), high = std::min(line.high, wall.slant());
  if (!(low <= high)) return 0;
  // From place along the slant and height to the point itself.
  const Vec3d along = wall.n_r * wall.axis - wall.n_z * e;
  const Vec3d p = wall.radius * e + (0.5 * (low + high)) * along + best.beyond() * wall.normal(e);
  deepest.add(round_contact(wall, body, p, e, -1, r));
  return deepest.count;
}

template <class Body>
int round_contacts(const Body& body, const Vec3d& from, const Vec3d& to, double radius_from,
                   double radius_to, Side side, SolidContact* out, int most) {
  DeepestContacts deepest{out, most};
  const RoundWall wall(from, to, radius_from, radius_to, centre_of(body));
  const bool inner = side == Side::Inside;
  if (!wall.in_reach(centre_of(body), bound_of(body), inner)) return 0;
  return inner ? inner_contacts(wall, body, deepest) : outer_contacts(wall, body, deepest);
}

}  // namespace detail

/// Contacts with the lateral surface of a cylinder. Its rims do not count: a contact whose foot on
/// the surface lies beyond an end is dropped, by a jump.
///
///   inside, super-ellipsoid  every local maximum over the wall's normals N of h(N) + N . (centre -
///                            surface): a die that lies on its face touches with two edges
///   inside, polyhedron       every corner of the core beyond the surface, or nearer than its
///   radius outside                  one, at the least over N of h(-N) - N . (centre - surface),
///   near the
///                            direction of the body: its centre, not the axis, is outside
///
/// Overlaps are depths: gradient 1, couple 0, and the envelope theorem makes the normal their
/// gradient. Not continuous: the point, where a body outside tilts through a line contact (flat
/// face or edge along the axis), and at the ends. Tests: tests/shape/solid_walls.cpp
template <class Body>
int cylinder_contacts(const Body& body, const Cylinder& wall, SolidContact* out, int most) {
  return detail::round_contacts(body, wall.from, wall.to, wall.radius, wall.radius, wall.side, out,
                                most);
}
/// The same with a cone, whose normals lean along its axis.
template <class Body>
int cone_contacts(const Body& body, const Cone& wall, SolidContact* out, int most) {
  return detail::round_contacts(body, wall.from, wall.to, wall.radius_from, wall.radius_to,
                                wall.side, out, most);
}

}  // namespace silt
