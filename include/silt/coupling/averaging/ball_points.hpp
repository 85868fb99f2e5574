// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <silt/core/dyn_array.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// N points of equal weight that fill the unit ball: Fibonacci lattices on shells. The number of
/// points of a shell is proportional to its volume, and they are at the shell's root mean square
/// radius; shifted to the centre.
inline DynArray<Vec3d> ball_points(int n) {
  if (n == 1) return {{0, 0, 0}};
  const int shells = std::max(1, static_cast<int>(std::lround(std::cbrt(n / 8.0))));
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  DynArray<Vec3d> all;
  Vec3d mean{0, 0, 0};
  double below = 0;  // volume fraction inside the shell
  for (int s = 0; s < shells; ++s) {
    const double part = (s + 1.0) / shells;
    const int end = s + 1 == shells ? n : static_cast<int>(std::lround(n * part * part * part));
    const int count = end - static_cast<int>(all.size());
    if (count <= 0) continue;
    const double above = static_cast<double>(end) / n, u = std::cbrt(below), v = std::cbrt(above);
    const double square = 0.6 * (std::pow(v, 5) - std::pow(u, 5)) / (above - below);
    for (int k = 0; k < count; ++k) {
      const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
      const double angle = golden * k + 2.4 * s;
      all.push_back(Vec3d{r * std::cos(angle), r * std::sin(angle), z} * std::sqrt(square));
      mean += all.back();
    }
    below = above;
  }
  mean *= 1.0 / n;
  for (Vec3d& x : all) x -= mean;
  return all;
}

}  // namespace silt::detail
