// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/gjk.hpp>
#include <silt/shape/polyhedron.hpp>

namespace silt::inline SILT_TARGET {

/// Core of a polyhedron at its place: a ConvexSet. Does not own the shape.
struct PlacedPolyhedron {
  const Polyhedron* shape;
  RigidPose pose;

  SILT_INLINE Vec3d support(const Vec3d& n) const {
    return pose.to_space(shape->support(pose.turn.back(n)));
  }
};
static_assert(ConvexSet<PlacedPolyhedron>);

/// [m] Gap of the cores of two bodies along `axis` (from b to a, not zero): > 0 proves them apart.
/// In units of |axis|. Tests all corners of both, in lanes.
inline double gap_along(const PlacedPolyhedron& a, const PlacedPolyhedron& b, const Vec3d& axis) {
  return dot(axis, a.pose.position - b.pose.position) - a.shape->reach(-a.pose.turn.back(axis)) -
         b.shape->reach(b.pose.turn.back(axis));
}

}  // namespace silt
