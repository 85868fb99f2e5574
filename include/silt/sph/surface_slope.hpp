// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// h times the integral of W over a plane at y h (2D: a line), by Simpson's rule.
template <class Kernel>
double sph_of_plane(double y, int dimensions) {
  constexpr int n = 64;
  const double half = std::sqrt(std::max(4 - y * y, 0.0)), step = half / n;
  double sum = 0;
  for (int k = 0; k <= n; ++k) {
    const double x = k * step, w = Kernel::weight(std::sqrt(y * y + x * x));
    const double around = dimensions == 2 ? 2 : 2 * std::numbers::pi * x;
    sum += (k == 0 || k == n ? 1 : k % 2 == 1 ? 4 : 2) * around * w;
  }
  return sum * step / 3 * Kernel::normalisation(dimensions, 1);
}

/// Share of a half-space beyond a plane in the kernel's gradient: h |integral of grad W| = h p(y),
/// at the distance y h from the plane.
template <class Kernel>
class SphHalfSpace {
 public:
  SphHalfSpace() = default;
  explicit SphHalfSpace(int dimensions) {
    for (std::size_t k = 0; k < points; ++k)
      slope_[k] = sph_of_plane<Kernel>(2.0 * static_cast<double>(k) / (points - 1), dimensions);
  }
  double operator()(double y) const {
    const double place = std::min(0.5 * std::abs(y) * (points - 1), points - 1.0);
    const auto k = std::min(static_cast<std::size_t>(place), points - 2);
    return slope_[k] + (slope_[k + 1] - slope_[k]) * (place - static_cast<double>(k));
  }

 private:
  static constexpr std::size_t points = 65;
  std::array<double, points> slope_{};
};

/// Gradient of C = sum V W due to a flat free surface, h |grad C|, as a function of the fullness of
/// the kernel, -sum V r.grad W/D. Shifting subtracts it from grad C: the rest is due to disorder.
/// Without it all particles near a surface are shifted outwards, and the liquid rises.
///
/// At the distance y below the surface, with the share of a plane p(y) = integral of W over z = y:
///   |grad C| = p(y),  -sum V r.grad W = D C(y) - y p(y),  C(y) = 1 - integral of p from y on
template <class Kernel>
class SphSurfaceSlope {
 public:
  SphSurfaceSlope() = default;
  explicit SphSurfaceSlope(int dimensions) {
    constexpr std::size_t n = 400;  // planes from the kernel's edge inwards
    constexpr double step = 2.0 / n;
    double beyond = 0, before = 0, full = 1, slope = 0;
    std::size_t at = 0;
    for (std::size_t k = 1; k <= n; ++k) {
      const double y = 2 - static_cast<double>(k) * step, p = sph_of_plane<Kernel>(y, dimensions);
      beyond += 0.5 * step * (p + before), before = p;
      const double less = 1 - beyond - y * p / dimensions;
      for (; at < points && fullness(at) >= less; ++at)
        slope_[at] = slope + (p - slope) * (full - fullness(at)) / (full - less);
      full = less, slope = p;
    }
    for (; at < points; ++at) slope_[at] = slope;
  }
  /// [-] h |grad C| where the kernel is `full`: 1 inside, 1/2 at the surface.
  double operator()(double full) const {
    const double place = std::clamp((1 - full) * 2 * (points - 1), 0.0, points - 1.0);
    const auto k = std::min(static_cast<std::size_t>(place), points - 2);
    const double share = place - static_cast<double>(k);
    return (1 - share) * slope_[k] + share * slope_[k + 1];
  }
  /// The same, 0 inside: a nearly full kernel deviates because of disorder. For a liquid that fills
  /// its space; waves and floating bodies do not need it.
  double beyond_inside(double full) const {
    constexpr double inside = 0.97, surface = 0.92;
    return std::clamp((inside - full) / (inside - surface), 0.0, 1.0) * (*this)(full);
  }

 private:
  static constexpr std::size_t points = 65;
  static double fullness(std::size_t k) { return 1 - 0.5 * static_cast<double>(k) / (points - 1); }

  std::array<double, points> slope_{};
};

}  // namespace silt::detail
