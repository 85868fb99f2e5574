// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/lattice_sites.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Why fill() found no place: the region, inside(x), one wall, or several causes together.
template <class Inside>
[[gnu::cold]] std::string sph_why_empty(const SphSetup& setup, const WallParticles& walls,
                                        const Inside& inside) {
  const double s = setup.spacing;
  const Vec3d e = setup.region.extent();
  const double length[3] = {e.x, e.y, e.z};
  const char* const slice = ", or .dimensions = 2, where the liquid lies in x and z";
  for (std::size_t d = 0; d < 3; ++d) {
    if (length[d] >= s * (1 - 1e-6) || (d == 1 && setup.dimensions == 2)) continue;
    if (length[d] == 0)
      return text("SphSetup.region has no extent in ", "xyz"[d], " (from ", setup.region.min,
                  " to ", setup.region.max, " m), and the liquid is in 3D; give it one", slice);
    return sentence("SphSetup.spacing = ", s, " m is larger than SphSetup.region, which is ",
                    length[d], " m long in ", "xyz"[d], "; use a smaller spacing",
                    d == 1 ? slice : "");
  }
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec3d low{far, far, far}, high{-far, -far, -far};
  std::size_t all = 0, wanted = 0, near_walls = 0;
  DynArray<std::size_t> behind(walls.walls(), 0);
  for_each_site(setup, 0, [&](const Vec3d& x) {
    ++all;
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    if (!inside(x)) return;
    ++wanted, near_walls += walls.is_too_near(x, s);
    for (std::size_t w = 0; w < behind.size(); ++w) behind[w] += walls.is_behind(w, x);
  });
  if (wanted == 0)
    return sentence("inside(x) is false at all ", all, " places of the lattice, from ", low, " to ",
                    high, " m with a spacing of ", s,
                    " m; check the function and SphSetup.region, both in m, or use a smaller "
                    "spacing");
  for (std::size_t w = 0; w < behind.size(); ++w)
    if (behind[w] == wanted)
      return sentence("all ", wanted, " places where inside(x) is true are behind wall ",
                      walls.called(w),
                      "; the normal of a wall points to the liquid: turn it, or move the wall");
  return sentence("of ", wanted, " places where inside(x) is true, ", near_walls,
                  " are behind walls or less than half a spacing in front of one, and ",
                  wanted - near_walls,
                  " behind openings; check that walls and openings leave space, or use a smaller "
                  "spacing than ",
                  s, " m");
}

}  // namespace silt::detail
