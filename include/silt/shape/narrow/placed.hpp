// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/shape/narrow/normal_search.hpp>
#include <silt/shape/narrow/placed_polyhedron.hpp>

namespace silt::inline SILT_TARGET {

/// A ball at its place: a ConvexSet.
struct PlacedBall {
  double radius;   // [m]
  Vec3d position;  // [m]

  Vec3d support(const Vec3d& n) const { return position + (radius / norm(n)) * n; }
};

/// A super-ellipsoid or poly-super-ellipsoid at its place: a ConvexSet. Form: result of form_of().
template <class Form>
struct PlacedSuper {
  Form form;
  BodyAxes<double> axes;  // body to space
  Vec3d position;         // [m] of the form's origin

  /// Height, point and radii of curvature at the outward unit normal n, with the given tangents.
  Cap<double> cap(const Vec3d& n, const Vec3d& s, const Vec3d& t) const {
    return cap_at(form, axes.to_body(n), axes.to_body(s), axes.to_body(t));
  }
  Vec3d support(const Vec3d& n) const {
    const Vec3d m = normalised(n);
    Vec3d s, t;
    tangents(m, s, t);
    const auto c = cap(m, s, t);
    return position + c.height * m + c.along_s * s + c.along_t * t;
  }
};

static_assert(ConvexSet<PlacedBall>);
static_assert(ConvexSet<PlacedSuper<SuperForm<double>>>);

/// Radius [m] for Hertz' law of a body with the outward unit normal n. For a polyhedron, whose
/// faces have none and whose corners have 0: that of the sphere of equal volume.
inline double contact_radius_at(const PlacedBall& ball, const Vec3d&) { return ball.radius; }
template <class Form>
double contact_radius_at(const PlacedSuper<Form>& body, const Vec3d& n) {
  Vec3d s, t;
  tangents(n, s, t);
  return contact_radius(body.form, body.cap(n, s, t));
}
inline double contact_radius_at(const PlacedPolyhedron& body, const Vec3d&) {
  return body.shape->equal_volume_radius();
}

namespace detail {
/// [m] radius of the bounding sphere about the body's position.
inline double bound_of(const PlacedBall& b) { return b.radius; }
template <class Form>
double bound_of(const PlacedSuper<Form>& b) {
  return b.form.bound;
}
inline double bound_of(const PlacedPolyhedron& b) { return b.shape->bounding_radius(); }
}  // namespace detail

/// Contact of two bodies, or of one with a wall, for all shapes.
///
///   force on i          = F(overlap) gradient normal, acts at `point`
///   torque on i         = couple times that force, about `point`
///   rate of the overlap = -gradient (normal . v + couple normal . w), v, w of i relative to the
///                         partner at `point`                                                   (1)
///
/// conserve energy for any law F. Gradient 1 and couple 0 if the overlap is a depth.
struct SolidContact {
  Vec3d normal{0, 0, 1};      // [-] unit, from the partner to i
  Vec3d point{0, 0, 0};       // [m] in the frame in which the bodies are placed
  double overlap = 0;         // [m]; if apart minus a lower bound of the gap, or 0
  double gradient = 1;        // [-]
  double couple = 0;          // [m]
  double R_eff = 0;           // [m] for Hertz' law
  std::uint32_t feature = 0;  // of a wall: number of the face, edge or corner of either
  Symmetric3 spread{};        // [m2] covariance of the contact region across the normal
};

}  // namespace silt
