// silt - BSD-3-Clause, see LICENSE
#pragma once

#if defined(SILT_TEST_CCD)
#include <ccd/ccd.h>
#include <ccd/quat.h>
#endif

#include "random_pairs.hpp"

/// Overlap of two bodies by methods that share nothing with silt's but the support function.
namespace oracle {

using silt::Vec3d;

struct Support {
  const pairs::Form& form;
  const silt::BodyAxes<double>& axes;
  Vec3d centre;

  Vec3d operator()(const Vec3d& n) const {
    return centre + axes.to_space(support_of(form, axes.to_body(n)));
  }
};

inline double depth_along(const pairs::Pair& pair, const Vec3d& m) {
  const Support i{pair.i, pair.turn_i, {0, 0, 0}}, j{pair.j, pair.turn_j, pair.between};
  return dot(m, i(m)) - dot(m, j(-m));
}

/// The least depth over all directions, by a grid on the sphere (2 degrees) and then a search by
/// ever smaller steps to the eight neighbours. [m], to about 1e-7 of the size.
inline double least_depth(const pairs::Pair& pair) {
  constexpr int n = 10000;
  Vec3d best{0, 0, 1};
  double least = 1e300;
  for (int k = 0; k < n; ++k) {
    const double z = 1 - (2 * k + 1.0) / n, r = std::sqrt(1 - z * z), phi = 2.399963229728653 * k;
    const Vec3d m{r * std::cos(phi), r * std::sin(phi), z};
    if (const double d = depth_along(pair, m); d < least) least = d, best = m;
  }
  for (double step = 0.03; step > 1e-9;) {
    Vec3d s, t, to = best;
    silt::tangents(best, s, t);
    for (int k = 0; k < 16; ++k) {
      const double phi = 0.39269908169872414 * k;
      const Vec3d m =
          silt::normalised(best + s * (step * std::cos(phi)) + t * (step * std::sin(phi)));
      if (const double d = depth_along(pair, m); d < least) least = d, to = m;
    }
    if (to == best)
      step *= 0.5;
    else
      best = to;
  }
  return least;
}

#if defined(SILT_TEST_CCD)
inline void support_for_ccd(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const auto& body = *static_cast<const Support*>(object);
  const Vec3d n = silt::normalised({direction->v[0], direction->v[1], direction->v[2]});
  const Vec3d p = body(n);
  ccdVec3Set(point, p.x, p.y, p.z);
}

/// libccd's answers: whether the bodies share a point (GJK), and how deep (EPA).
struct Ccd {
  Support i, j;
  ccd_t settings;
  explicit Ccd(const pairs::Pair& pair)
      : i{pair.i, pair.turn_i, {0, 0, 0}}, j{pair.j, pair.turn_j, pair.between} {
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support_for_ccd;
    settings.max_iterations = 500;
    settings.epa_tolerance = 1e-7;
  }
  bool touch() const { return ccdGJKIntersect(&i, &j, &settings) != 0; }
  double depth() const {  // negative if it finds none
    ccd_real_t depth;
    ccd_vec3_t direction, position;
    return ccdGJKPenetration(&i, &j, &settings, &depth, &direction, &position) == 0 ? depth : -1;
  }
};
#endif

}  // namespace oracle
