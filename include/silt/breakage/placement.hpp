// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/random.hpp>
#include <silt/core/symmetric3.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Places spherical fragments inside their parent sphere of `radius` [m]; returns centres relative
/// to its centre. All are inside, and their centre of mass is the centre of the parent to rounding.
/// They overlap: with the whole mass they would have to fill the sphere, and spheres fill at most
/// 74 %. The largest is placed first. Each takes, of 12 random positions, that with the least
/// overlap with those before it.
///
/// Radii [m] descending, none above `radius`; masses [kg]. A single fragment is at the centre.
inline DynArray<Vec3d> place_fragments(std::span<const double> radii,
                                       std::span<const double> masses, double radius,
                                       Random& random) {
  constexpr int trials = 12;
  DynArray<Vec3d> places;
  const auto somewhere = [&](double r) {
    const double z = random.uniform(-1, 1), angle = random.uniform(0, 2 * std::numbers::pi),
                 way = std::max(radius - r, 0.0) * std::cbrt(random.uniform()),
                 across = way * std::sqrt(std::max(1 - z * z, 0.0));
    return Vec3d{across * std::cos(angle), across * std::sin(angle), way * z};
  };
  for (std::size_t k = 0; k < radii.size(); ++k) {
    Vec3d best{0, 0, 0};
    double widest = -HUGE_VAL;  // [m] gap to the nearest earlier one
    for (int t = 0; t < trials && radii.size() > 1; ++t) {
      const Vec3d p = somewhere(radii[k]);
      double gap = HUGE_VAL;
      for (std::size_t m = 0; m < k; ++m)
        gap = std::min(gap, norm(p - places[m]) - radii[k] - radii[m]);
      if (gap > widest) widest = gap, best = p;
    }
    places.push_back(best);
  }
  Vec3d moment{0, 0, 0};
  double mass = 0;
  for (std::size_t k = 0; k < places.size(); ++k)
    moment += masses[k] * places[k], mass += masses[k];
  double scale = 1;  // factor that brings all inside again
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k] -= (1 / mass) * moment;
    const double room = std::max(radius - radii[k], 0.0), way = norm(places[k]);
    if (way > room) scale = std::min(scale, room / way);
  }
  for (Vec3d& p : places) p = scale * p;
  return places;
}

/// Angular velocity [rad/s] of spheres that rotate as one rigid body about the origin with the
/// angular momentum L [kg m2/s]; inertia_factor: 2/5 for spheres, moment about the centre over m
/// r^2.
inline Vec3d rotation_of_fragments(std::span<const Vec3d> places, std::span<const double> radii,
                                   std::span<const double> masses, double inertia_factor,
                                   const Vec3d& L) {
  Symmetric3 I;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const double own = inertia_factor * radii[k] * radii[k] + dot(places[k], places[k]);
    I += masses[k] * Symmetric3{own, own, own};
    I += -masses[k] * outer(places[k]);
  }
  const Vec3d x{I.xx, I.xy, I.zx}, y{I.xy, I.yy, I.yz}, z{I.zx, I.yz, I.zz};
  const Vec3d yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  return (1 / dot(x, yz)) * (L.x * yz + L.y * zx + L.z * xy);
}

}  // namespace silt
