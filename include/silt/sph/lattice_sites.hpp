// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>

#include <silt/core/box.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Lattice of the initial particles of an Sph.
/// @{

/// Calls visit(x) for the centres of the lattice cells in the region, and in `layers` further
/// layers around it in directions that are not periodic.
template <class Visit>
void for_each_site(const SphSetup& setup, int layers, const Visit& visit) {
  const double s = setup.spacing;
  const Vec3d low = setup.region.min, e = setup.region.extent();
  const double length[3] = {e.x, e.y, e.z};
  int from[3], to[3];
  for (std::size_t d = 0; d < 3; ++d) {
    const int more = setup.periodic[d] ? 0 : layers;
    from[d] = -more, to[d] = static_cast<int>(std::ceil(length[d] / s - 1e-6)) + more;
  }
  if (setup.dimensions == 2) from[1] = 0, to[1] = 1;
  for (int i = from[0]; i < to[0]; ++i)
    for (int j = from[1]; j < to[1]; ++j)
      for (int k = from[2]; k < to[2]; ++k)
        visit(Vec3d{low.x + (i + 0.5) * s, setup.dimensions == 2 ? low.y : low.y + (j + 0.5) * s,
                    low.z + (k + 0.5) * s});
}

/// [-] -sum V r.grad W on a lattice with the spacing: 2 or 3, apart from the effect of the kernel's
/// width.
template <class Kernel>
double sph_divergence_of_lattice(const SphSetup& setup) {
  const double s = setup.spacing, h = setup.h();
  const int n = static_cast<int>(2 * h / s) + 1, across = setup.dimensions == 2 ? 0 : n;
  double sum = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -across; j <= across; ++j)
      for (int k = -n; k <= n; ++k) {
        const double q = std::sqrt(i * i + j * j + k * k) * s / h;
        sum -= Kernel::slope(q) * q * q;
      }
  return sum * setup.volume() * Kernel::normalisation(setup.dimensions, h);
}
/// @}

}  // namespace silt::detail
