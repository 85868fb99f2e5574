// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/placed_polyhedron.hpp>

namespace silt::inline SILT_TARGET {

/// Contact of a sphere with a polyhedron.
struct SphereContact {
  Vec3d normal{0, 0, 0};  // [-] unit, from the polyhedron to the sphere
  double overlap = 0;     // [m] 0: apart
  Vec3d point{0, 0, 0};   // [m] midway between the two surfaces
  bool buried = false;    // the centre is inside the core: out through the nearest face
};

namespace detail {

/// Point of a convex face nearest to `p`, which is over its plane.
inline Vec3d nearest_on_face(const Polyhedron& body, const Polyhedron::Face& face, const Vec3d& p) {
  const auto corner = body.loop(face);
  const Vec3d foot = p - (dot(face.normal, p) - face.offset) * face.normal;
  Vec3d best = foot;
  double best_square = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < corner.size(); ++k) {
    const Vec3d& a = body.vertices()[corner[k]];
    const Vec3d side = body.vertices()[corner[(k + 1) % corner.size()]] - a;
    if (dot(cross(side, foot - a), face.normal) >= 0) continue;  // on the inner side
    const double t = std::clamp(dot(foot - a, side) / dot(side, side), 0.0, 1.0);
    const Vec3d at = a + t * side, gap = at - foot;
    if (const double square = dot(gap, gap); square < best_square) best = at, best_square = square;
  }
  return best;
}

}  // namespace detail

/// Exact: the nearest point of the core is on a face that the centre is over. If the centre is
/// inside, the nearest face gives normal and depth (they jump where two faces are equally near).
/// Includes the dilation of the polyhedron.
/// Tests:   tests/shape/gjk.cpp
inline SphereContact sphere_contact(const Vec3d& centre, double radius,
                                    const PlacedPolyhedron& body) {
  const Polyhedron& shape = *body.shape;
  const Vec3d p = body.pose.to_body(centre);
  const double reach = radius + shape.radius();
  double highest = -std::numeric_limits<double>::infinity();
  std::size_t top = 0;
  for (std::size_t f = 0; f < shape.faces().size(); ++f) {
    const auto& face = shape.faces()[f];
    if (const double h = dot(face.normal, p) - face.offset; h > highest) highest = h, top = f;
    if (highest >= reach) return {};
  }
  SphereContact out;
  Vec3d normal = shape.faces()[top].normal;
  double distance = highest;
  if (highest > 0) {
    distance = std::numeric_limits<double>::infinity();
    for (const auto& face : shape.faces()) {
      if (dot(face.normal, p) <= face.offset) continue;
      const Vec3d gap = p - detail::nearest_on_face(shape, face, p);
      if (const double d = norm(gap); d < distance) distance = d, normal = gap * (1 / d);
    }
    if (distance >= reach) return {};
  }
  out.buried = highest <= 0;
  out.normal = body.pose.turn * normal;
  out.overlap = reach - distance;
  out.point = centre - (0.5 * (distance + radius - shape.radius())) * out.normal;
  return out;
}

}  // namespace silt
