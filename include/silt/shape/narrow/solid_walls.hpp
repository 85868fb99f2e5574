// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/shape/narrow/solid_rims.hpp>

namespace silt::inline SILT_TARGET {

/// Contacts of convex bodies with walls, all in the wall's frame: planes (solid_planes.hpp),
/// cylinders and cones; meshes in solid_mesh_contacts.hpp.
///
/// Every function writes up to `most` contacts with overlap > 0, deepest first, and returns their
/// number. The normal is from the wall to the body, the point midway between the surfaces. From
/// step to step a contact is identified by its feature and the nearest normal:
///   polyhedra         number of the corner, if corners touch separately; else 0
///   super-ellipsoids  on the inner side of a round wall the edge or corner of the body; else 0
///   rims              1000 at `from`, 1001 at `to`
///   meshes            see mesh_contacts()
/// With more contacts than `most`, the selection jumps when their order in depth changes.

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

/// Edge or corner of the body near p, 0 to 26, from its position over the semi-axes; 13 where the
/// body is round. Exponents up to 3 count as round: a rolling body keeps its feature.
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
int inner_contacts(const RoundWall& wall, const PlacedSuper<Form>& body, DeepestContacts& deepest,
                   double&) {
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
/// A contact of a polyhedron `over_end` from an end of the surface, at the angle of e: if the rim
/// there is a shorter way out, through a face inclined over it, that counts. False: no contact, as
/// the body is on the rim and this point is beyond it.
[[gnu::noinline]] inline bool over_rim(const RoundWall& wall, const PlacedPolyhedron& body,
                                       const Vec3d& e, double over_end, bool at_to, double free,
                                       SolidContact& contact) {
  const double beyond = contact.overlap - body.shape->radius();
  const double phi = std::atan2(dot(e, wall.y), dot(e, wall.x));
  const Rim rim(wall, at_to, free);
  const RimInPolyhedron in_body(rim, body, std::max(0.0, beyond - over_end));
  if (free < 0 && in_body.stays_in(phi, beyond * contact.normal)) return false;
  const auto there = in_body(phi);
  const Vec3d n = body.pose.turn * -there.out;
  if (there.depth > -1e-9 * bound_of(body) && there.depth < contact.overlap &&
      rim.under_surface(n, e) < -most_tilt)
    contact = rim.contact(rim.at(e), n, there.depth, contact.R_eff);
  return true;
}

/// `ahead`: of add_rim().
inline int inner_contacts(const RoundWall& wall, const PlacedPolyhedron& body,
                          DeepestContacts& deepest, double& ahead) {
  const auto& corners = body.shape->vertices();
  const double r = body.shape->radius(), slant = wall.slant();
  for (std::uint32_t v = 0; v < corners.size(); ++v) {
    const Vec3d p = body.pose.to_space(corners[v]) - wall.from;
    const double z = dot(p, wall.axis);
    const Vec3d across = p - z * wall.axis;
    const double distance = norm(across);
    const double beyond = wall.n_r * distance + wall.n_z * z - wall.offset;
    if (!(beyond + r > 0)) continue;
    const Vec3d e = distance > 0 ? across * (1 / distance) : wall.x;
    const double u = wall.along(p, e), over_end = std::min(u, slant - u);
    ahead = std::max(ahead, beyond - std::abs(over_end));
    if (over_end < 0) continue;
    auto contact = round_contact(wall, body, p, e, 1, r);
    if (over_end < 2 * beyond && !over_rim(wall, body, e, over_end, 2 * u > slant, -1, contact))
      continue;
    contact.feature = v;
    deepest.add(contact);
  }
  return deepest.count;
}

template <class Form>
int outer_contacts(const RoundWall& wall, const PlacedSuper<Form>& body, DeepestContacts& deepest,
                   double&) {
  if (support_at(wall, body, 0, -1).beyond >= 0) return 0;  // this plane separates them
  const double range = outer_range(wall, body.form.bound);
  const auto at = turning_point(wall, body, -range, range, 0, -1);
  if (at.beyond < 0 && wall.between_ends(at.p, at.e))
    deepest.add(round_contact(wall, body, at.p, at.e, -1, 0));
  return deepest.count;
}

/// A face or edge along the wall touches on a line: the middle of the part on the wall.
inline int outer_contacts(const RoundWall& wall, const PlacedPolyhedron& body,
                          DeepestContacts& deepest, double& ahead) {
  const OuterAngle best(wall, body);
  const double r = body.shape->radius();
  if (best.beyond() >= r) return 0;
  const Vec3d e = wall.e(best.phi());
  const auto line = touching_line(wall, body, e, best.beyond());
  const double low = std::max(line.low, 0.0), high = std::min(line.high, wall.slant());
  const double depth = r - best.beyond(), over_end = std::min(line.high, wall.slant() - line.low);
  ahead = std::max(0.0, depth - std::abs(over_end));
  if (!(low <= high)) return 0;
  // From position along the slant and height to the point itself.
  const Vec3d along = wall.n_r * wall.axis - wall.n_z * e;
  const Vec3d p = wall.radius * e + (0.5 * (low + high)) * along + best.beyond() * wall.normal(e);
  auto contact = round_contact(wall, body, p, e, -1, r);
  if (over_end < -2 * best.beyond())
    over_rim(wall, body, e, over_end, line.high > wall.slant() - line.low, 1, contact);
  if (is_rim(contact)) return 0;  // handled by add_rim()
  deepest.add(contact);
  return deepest.count;
}

/// Whether the rim leaves the body as soon as it has left the surface.
inline bool leaves_rim(const Rim& rim, const PlacedPolyhedron& body, const SolidContact& on_rim,
                       const SolidContact& other) {
  const Vec3d p = on_rim.point - rim.wall.from;
  const double phi = std::atan2(dot(p, rim.wall.y), dot(p, rim.wall.x));
  return !RimInPolyhedron(rim, body, 0).stays_in(phi, other.overlap * other.normal);
}
template <class Form>
bool leaves_rim(const Rim&, const PlacedSuper<Form>&, const SolidContact&, const SolidContact&) {
  return false;
}

/// Adds the contacts with a rim. If a body touches rim and surface at the same place, the shorter
/// way out counts.
template <class Body>
[[gnu::noinline]] void add_rim(const Rim& rim, const Body& body, double ahead, bool alone,
                               DeepestContacts& deepest) {
  const RoundWall& wall = rim.wall;
  std::array<SolidContact, 8> found;
  DeepestContacts on_rim{found.data(), static_cast<int>(found.size())};
  if (rim.radius > 1e-12 * wall.length) {
    rim_contacts(rim, body, ahead, alone, on_rim);
  } else if (const auto tip = tip_contact(rim, body)) {
    const double along = rim.inwards * dot(tip->normal, wall.axis);
    const double across = norm(tip->normal - dot(tip->normal, wall.axis) * wall.axis);
    if (wall.n_r * along + std::abs(wall.n_z) * across <= 0) on_rim.add(*tip);
  }
  for (int k = 0; k < on_rim.count; ++k) {
    const SolidContact& on = found[static_cast<std::size_t>(k)];
    bool longer = false;
    for (int c = 0; c < deepest.count && !longer; ++c) {
      const SolidContact& other = deepest.out[c];
      const double reach = 2 * std::max(on.overlap, other.overlap);
      if (is_rim(other) || norm(on.point - other.point) > reach) continue;
      if (on.overlap < other.overlap)
        deepest.remove(c--);
      else
        longer = leaves_rim(rim, body, on, other);
    }
    if (!longer) deepest.add(on);
  }
}

template <class Body>
int round_contacts(const Body& body, const Vec3d& from, const Vec3d& to, double radius_from,
                   double radius_to, Side side, SolidContact* out, int most) {
  DeepestContacts deepest{out, most};
  const RoundWall wall(from, to, radius_from, radius_to, centre_of(body));
  const bool inner = side == Side::Inside;
  if (!wall.in_reach(centre_of(body), bound_of(body), inner)) return 0;
  const Vec3d centre = centre_of(body) - wall.from;
  const double beyond = wall.beyond(centre, wall.normal(wall.x)), z = dot(centre, wall.axis);
  double ahead = 0;
  // A body that has passed an end to the other side is not behind the surface.
  if ((inner ? beyond <= 0 : beyond >= 0) || (z >= 0 && z <= wall.length)) {
    if (inner)
      inner_contacts(wall, body, deepest, ahead);
    else
      outer_contacts(wall, body, deepest, ahead);
  }
  const bool alone = deepest.count == 0;
  for (const bool at_to : {false, true})
    if (const Rim rim(wall, at_to, inner ? -1 : 1); rim.is_near(centre_of(body), bound_of(body)))
      add_rim(rim, body, std::min(ahead, 0.05 * bound_of(body)), alone, deepest);
  return deepest.count;
}

}  // namespace detail

/// Contacts with the lateral surface of a cylinder and with its rims.
///
///   inside, super-ellipsoid  every local maximum over the wall's normals N of h(N) + N . (centre -
///                            surface): a die on its face touches with two edges
///   inside, polyhedron       every corner of the core beyond the surface, or nearer than r
///   outside                  one, at the minimum over N of h(-N) - N . (centre - surface), near
///                            the direction of the body: its centre, not the axis, is outside
///   rims                     every point of the circle that is locally deepest in the body, if the
///                            surface does not rise above the plane across the normal there
///
/// Overlaps are depths: gradient 1, couple 0; by the envelope theorem the normal is their gradient.
/// At the end of the surface the contact on the rim has the same depth and normal, as for spheres:
/// smooth and dilated bodies do not jump, as long as they overlap by less than their radii of
/// curvature. A corner of a sharp polyhedron that slips over a rim has different ways out before
/// and after: over_rim() takes the shorter one, and the remaining jump is some 0.7 of the overlap.
/// Also discontinuous is the point, where a body outside tilts through a line contact (flat face or
/// edge along the axis) or lies flat on a rim, and where two points of a rim merge while both are
/// deep.
/// Tests:   tests/shape/solid_walls.cpp, solid_rims.cpp, engine/rims.cpp
template <class Body>
int cylinder_contacts(const Body& body, const Cylinder& wall, SolidContact* out, int most) {
  return detail::round_contacts(body, wall.from, wall.to, wall.radius, wall.radius, wall.side, out,
                                most);
}
/// The same with a cone, whose normals are inclined along its axis.
template <class Body>
int cone_contacts(const Body& body, const Cone& wall, SolidContact* out, int most) {
  return detail::round_contacts(body, wall.from, wall.to, wall.radius_from, wall.radius_to,
                                wall.side, out, most);
}

}  // namespace silt
