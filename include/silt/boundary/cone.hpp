// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/frustum.hpp>

namespace silt::inline SILT_TARGET {

/// The lateral surface of a circular cone or frustum with its rims (a radius of 0 is the tip); the
/// ends are open. Sides, signs and rims as for Cylinder, which it equals where the radii are equal.
///
/// A sphere that fills the cone touches it along a circle, of which one point is reported: a jam of
/// a single sphere in a round outlet is better described by a mesh.
/// Errors: check() names `Cone.from`, `.to`, `.radius_from` or `.radius_to`.
/// Tests:  tests/boundary/cone.cpp
struct Cone {
  Vec3d from;          // [m] beginning of the axis
  Vec3d to;            // [m] end of the axis
  double radius_from;  // [m] at `from`
  double radius_to;    // [m] at `to`
  Side side;           // free for the particles

  static constexpr int max_contacts = 1;

  void check() const {
    frustum().check("Cone");
    require_not_negative("Cone.radius_from", radius_from, "m");
    require_not_negative("Cone.radius_to", radius_to, "m");
    require(radius_from > 0 || radius_to > 0,
            "Cone.radius_from and Cone.radius_to are both 0 [m]: at least one must be greater");
  }
  Box bounds() const { return frustum().bounds(); }
  int contacts(const Vec3d& centre, double reach, SurfacePoint* out) const {
    return frustum().contacts(centre, reach, out);
  }

 private:
  detail::Frustum frustum() const { return {from, to, radius_from, radius_to, side}; }
};

}  // namespace silt
