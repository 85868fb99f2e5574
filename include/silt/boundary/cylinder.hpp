// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/frustum.hpp>

namespace silt::inline SILT_TARGET {

/// Lateral surface of a circular cylinder with its two rims; the ends are open.
///
/// One-sided: `Side::Inside` keeps particles inside (a drum), `Side::Outside` outside (a shaft). A
/// centre behind the surface, within the length, has a negative distance. Beyond an end a sphere
/// touches the rim. The distance is continuous there.
/// Errors: check() names `Cylinder.from`, `.to` or `.radius`.
/// Tests:  tests/boundary/cylinder.cpp
struct Cylinder {
  Vec3d from;     // [m] start of the axis
  Vec3d to;       // [m] end of the axis
  double radius;  // [m]
  Side side;      // where the particles are

  static constexpr int max_contacts = 1;

  void check() const {
    frustum().check("Cylinder");
    require_positive("Cylinder.radius", radius, "m");
  }
  Box bounds() const { return frustum().bounds(); }
  int contacts(const Vec3d& centre, double reach, SurfacePoint* out) const {
    return frustum().contacts(centre, reach, out);
  }

 private:
  detail::Frustum frustum() const { return {from, to, radius, radius, side}; }
};

}  // namespace silt
