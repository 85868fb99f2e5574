// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/frustum.hpp>

namespace silt::inline SILT_TARGET {

/// Lateral surface of a circular cone or frustum with its rims (radius 0: the tip); the ends are
/// open. Sides, signs and rims as for Cylinder; with equal radii the two are identical.
///
/// A sphere that fills the cone touches it along a circle, of which one point is reported. Use a
/// mesh to model a single sphere stuck in a round outlet.
/// Errors: check() names `Cone.from`, `.to`, `.radius_from` or `.radius_to`.
/// Tests:  tests/boundary/cone.cpp
struct Cone {
  Vec3d from;          // [m] start of the axis
  Vec3d to;            // [m] end of the axis
  double radius_from;  // [m] at `from`
  double radius_to;    // [m] at `to`
  Side side;           // where the particles are

  static constexpr int max_contacts = 1;

  void check() const {
    frustum().check("Cone");
    require_not_negative("Cone.radius_from", radius_from, "m");
    require_not_negative("Cone.radius_to", radius_to, "m");
    require(
        radius_from > 0 || radius_to > 0,
        "Cone.radius_from and Cone.radius_to are both 0 [m]: at least one must be greater than 0");
  }
  Box bounds() const { return frustum().bounds(); }
  int contacts(const Vec3d& centre, double reach, SurfacePoint* out) const {
    return frustum().contacts(centre, reach, out);
  }

 private:
  detail::Frustum frustum() const { return {from, to, radius_from, radius_to, side}; }
};

}  // namespace silt
