// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/engine/convex/convex_rows.hpp>
#include <silt/shape/narrow/solid_mesh_contacts.hpp>
#include <silt/shape/narrow/solid_walls.hpp>

/// Contacts of a convex part with a surface of a wall; selects the geometry of shape/narrow.

namespace silt::inline SILT_TARGET::detail {

/// Largest numbers of contacts of one part with one surface, and with a plane.
inline constexpr int most_wall_contacts = 8;
template <class Kinds>
inline constexpr int most_plane_contacts = Kinds::template has<Polyhedron> ? most_wall_contacts : 1;

/// Which feature of a surface a ball touches, numbered as in solid_mesh_contacts.hpp: 0 for faces,
/// which are identified by their normals.
template <class S>
std::uint32_t feature_at([[maybe_unused]] const S& surface,
                         [[maybe_unused]] const SurfacePoint& p) {
  if constexpr (std::is_same_v<S, TriangleMesh>)
    if (p.feature >= surface.triangles().size())
      return static_cast<std::uint32_t>(Polyhedron::most_vertices) + p.feature;
  return 0;
}

/// The contacts of a placed part with a surface, both in the wall's frame.
template <class Placed, class S>
int contacts_with(const Placed& body, const S& surface, std::span<const std::uint32_t> facets,
                  SolidContact* out) {
  if constexpr (std::is_same_v<Placed, PlacedBall>) {
    SurfacePoint points[S::max_contacts];
    int count;
    if constexpr (requires { surface.contacts(body.position, body.radius, facets, points); })
      count = surface.contacts(body.position, body.radius, facets, points);
    else
      count = surface.contacts(body.position, body.radius, points);
    for (int k = 0; k < count; ++k) {
      const auto& p = points[k];
      out[k] = {p.normal,
                body.position - p.distance * p.normal,
                body.radius - p.distance,
                1,
                0,
                body.radius,
                feature_at(surface, p)};
    }
    return count;
  } else {
    int count;
    if constexpr (std::is_same_v<S, Plane>)
      count = plane_contacts(body, surface.unit(), out, most_wall_contacts);
    else if constexpr (std::is_same_v<S, TriangleMesh>)
      count = mesh_contacts(body, surface, facets, out, most_wall_contacts);
    else if constexpr (std::is_same_v<S, Cylinder>)
      count = cylinder_contacts(body, surface, out, most_wall_contacts);
    else
      count = cone_contacts(body, surface, out, most_wall_contacts);
    if constexpr (!std::is_same_v<Placed, PlacedPolyhedron>)
      for (int k = 0; k < count; ++k) {
        auto& c = out[k];
        if (!is_rim(c) && c.feature < Polyhedron::most_vertices)  // not an edge of the wall
          c.spread = symmetric(
              spread_of(body.form, body.axes, c.normal, c.point - body.position, c.overlap));
        c.point += (0.5 * c.overlap) * c.normal;  // midway between both surfaces
      }
    return count;
  }
}

/// Transforms the axes of a part into the frame of a wall.
inline void turn_into(const Pose&, PlacedBall&) {}
template <class Form>
void turn_into(const Pose& pose, PlacedSuper<Form>& body) {
  const Quaternion back = conjugate(pose.rotation);
  body.axes = {rotate(back, body.axes.x), rotate(back, body.axes.y), rotate(back, body.axes.z)};
}
inline void turn_into(const Pose& pose, PlacedPolyhedron& body) {
  const Quaternion back = conjugate(pose.rotation);
  auto& turn = body.pose.turn;
  turn = {rotate(back, turn.x), rotate(back, turn.y), rotate(back, turn.z)};
}

/// Transforms a contact from the frame of a wall into space.
inline void into_space(const Pose& pose, SolidContact& contact) {
  contact.normal = pose.rotate(contact.normal);
  contact.point = pose.to_space(contact.point);
  contact.spread = turned(rotation_matrix(pose.rotation), contact.spread);
}

/// As contacts_with_wall(), for a super-ellipsoid with the kernel for its exponents; `at` [m] in
/// the wall's frame.
template <class Rows>
int contact_with_plane(const Rows& rows, std::size_t row, const Vec3d& at, const Wall& wall,
                       const Plane& plane, SolidContact& out) {
  using Row = SuperForm<double>;
  const double distance = dot(at - plane.point, plane.normal);
  const Row form = rows.form_row(row).template get<Row>();
  if (!(distance < form.bound)) return 0;
  const Vec3d n = wall.moves() ? wall.pose.rotate(plane.normal) : plane.normal;
  const Vec3d centre = wall.moves() ? wall.pose.to_space(at) : at;
  return with_exponents(rows.exponents, [&](auto e) {
    using Form = SuperForm<double, decltype(e)::value>;
    Form kernel;
    static_assert(sizeof kernel == sizeof form);
    std::memcpy(static_cast<void*>(&kernel), &form, sizeof form);
    double R_eff = 0;
    const auto c = touch_plane(kernel, body_axes(rows.pose[row].q), n, distance, R_eff);
    out = {n, centre + c.point + (0.5 * c.overlap) * n, c.overlap, 1, 0, c.R_eff, 0};
    if constexpr (decltype(e)::value > Exponents::Two)
      out.spread = symmetric(spread_of(kernel, body_axes(rows.pose[row].q), n, c.point, c.overlap));
    return c.touches ? 1 : 0;
  });
}

/// The contacts of a row with one surface of a wall, in the space frame; points on the wall.
template <class Rows>
int contacts_with_wall(const Rows& rows, std::size_t row, const Vec3d& centre, const Wall& wall,
                       const Surface& surface, std::span<const std::uint32_t> facets,
                       SolidContact (&out)[most_wall_contacts]) {
  int count = 0;
  const Vec3d at = wall.moves() ? wall.pose.to_body(centre) : centre;
  if constexpr (std::is_same_v<typename Rows::Kinds, KindList<SuperEllipsoid>>)
    if (const auto* const plane = std::get_if<Plane>(&surface))
      return contact_with_plane(rows, row, at, wall, plane->unit(), out[0]);
  rows.visit(row, at, [&](auto body) {
    if (wall.moves()) turn_into(wall.pose, body);
    count =
        visit_surface(surface, [&](const auto& s) { return contacts_with(body, s, facets, out); });
  });
  for (int k = 0; k < count && wall.moves(); ++k) into_space(wall.pose, out[k]);
  return count;
}

inline bool is_round(const Surface& surface) {
  return std::holds_alternative<Cylinder>(surface) || std::holds_alternative<Cone>(surface);
}

/// Removes contacts with a rim that lies in the tangent plane of a deeper contact with another
/// surface and has the same orientation: where two surfaces join, it is a seam. Of two rims at the
/// same place the `first` surface's is kept. Returns the number that remains.
inline int without_seams(SolidContact* found, int count, std::span<const SolidContact> beside,
                         bool first, double tolerance) {
  const auto is_seam = [&](const SolidContact& a) {
    return is_rim(a) && std::any_of(beside.begin(), beside.end(), [&](const SolidContact& b) {
             const double deeper = b.overlap - a.overlap;
             // Points lie on the walls or behind them, by no more than the overlaps.
             const double off = std::abs(dot(a.point - b.point, b.normal));
             return (deeper > tolerance || (deeper > -tolerance && first)) &&
                    dot(a.normal, b.normal) > 0.5 && off <= tolerance + a.overlap + b.overlap;
           });
  };
  return static_cast<int>(std::remove_if(found, found + count, is_seam) - found);
}

}  // namespace silt::detail
