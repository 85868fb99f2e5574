// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <silt/core/error.hpp>
#include <silt/core/symmetric3.hpp>

namespace silt::inline SILT_TARGET {

/// Volume and its first two moments: integrals over a body of 1 [m3], x [m4] and x x^T [m5], x from
/// `origin`. An origin far from the body would cause cancellation.
struct Moments {
  double volume = 0;
  Vec3d first{0, 0, 0};
  Symmetric3 second;
  Vec3d origin{0, 0, 0};  // [m] in the frame of the body

  /// Moves the reference point; `place` [m] is the present origin seen from the new one.
  void shift(const Vec3d& place) {
    const Vec3d s = first;
    origin -= place;
    first += volume * place;
    second += volume * outer(place);
    second += {2 * s.x * place.x,
               2 * s.y * place.y,
               2 * s.z * place.z,
               s.x * place.y + s.y * place.x,
               s.y * place.z + s.z * place.y,
               s.z * place.x + s.x * place.z};
  }
};

/// Mass properties of a rigid body of density 1.
struct MassProperties {
  double volume;    // [m3]
  Vec3d centroid;   // [m] in the original frame of the body
  Vec3d inertia;    // [m5] principal moments about the centroid, density 1
  Quaternion axes;  // [-] rotates principal axes into the original ones
  bool operator==(const MassProperties&) const = default;
};

/// InputError unless it may be the mass of a rigid body; `of`: the shape that it is given to.
[[gnu::cold]] inline void check_mass(const char* of, const MassProperties& m) {
  const Vec3d& i = m.inertia;
  require(m.volume > 0 && std::isfinite(m.volume) && is_finite(i) && i.x > 0 && i.y > 0 && i.z > 0,
          of, ": the volume ", m.volume, " [m3] and the principal moments ", i,
          " [m5] of its mass must be finite and greater than 0");
  const double sum = i.x + i.y + i.z, most = std::max({i.x, i.y, i.z});
  require(2 * most <= sum * (1 + 1e-9), of, ": of the principal moments of its mass, ", i,
          " [m5], one is larger than the sum of the others, which no body has");
  require(is_finite(m.centroid), of, ": the centroid of its mass, ", m.centroid,
          " [m], must be finite");
  const Quaternion& q = m.axes;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  require(std::abs(length - 1) < 1e-6, of, ": the axes of its mass are a quaternion of length ",
          length, "; divide it by that, or write it as rotation_about(axis, angle)");
}

/// Without products of inertia that are rounding, between axes of equal moments: the axes of a cube
/// or of a square prism are then those of its form, and not any others.
inline Symmetric3 without_rounding(Symmetric3 t) {
  const double least = 1e-12 * std::max({std::abs(t.xx), std::abs(t.yy), std::abs(t.zz)});
  const auto drop = [least](double& product, double a, double b) {
    if (std::abs(product) < least && std::abs(a - b) < least) product = 0;
  };
  drop(t.xy, t.xx, t.yy), drop(t.yz, t.yy, t.zz), drop(t.zx, t.zz, t.xx);
  return t;
}

/// From moments about any origin, by the parallel-axis theorem; I = tr(S) 1 - S.
/// Errors: InputError for zero volume, and for a body so thin or extended that rounding of its
///         largest principal moment, 1e-16 of it, affects the smallest.
inline MassProperties mass_properties(const Moments& m) {
  require(m.volume > 0, "mass_properties: the volume ", m.volume, " [m3] must be greater than 0");
  const Vec3d centroid = m.first * (1 / m.volume);
  Symmetric3 s = m.second;
  s += -m.volume * outer(centroid);
  const Principal p =
      principal(without_rounding({s.yy + s.zz, s.zz + s.xx, s.xx + s.yy, -s.xy, -s.yz, -s.zx}));
  const double least = std::min({p.values.x, p.values.y, p.values.z});
  const double most = std::max({p.values.x, p.values.y, p.values.z});
  require(least >= std::numeric_limits<double>::min() && std::isfinite(most),
          "mass_properties: the principal moments ", p.values, " [m5] of a body of ", m.volume,
          " [m3] must be normal numbers greater than 0; give sizes in metres, and a solid body");
  require(least > 1e-10 * most, "mass_properties: the principal moments ", p.values,
          " [m5] differ by more than 1e10: the smallest is lost in rounding; move the "
          "parts of the body closer together, or make it thicker");
  return {m.volume, m.origin + centroid, p.values, p.axes};
}

}  // namespace silt
