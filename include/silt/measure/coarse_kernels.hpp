// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/core/error.hpp>
#include <silt/core/gauss_rule.hpp>

namespace silt::inline SILT_TARGET {

// Coarse-graining functions phi(r) [1/m3] with integral 1. Each provides its reach, its value at
// distance^2, and its integral along a line: over t from `from` to `to` at the distance
// sqrt(across2 + t^2), all within the reach.

/// exp(-r^2/(2 w^2)), cut off at 3 w and normalised with the cut-off: smooth fields.
struct GaussianKernel {
  double width;  // [m] w

  void check() const { require_positive("GaussianKernel.width", width, "m"); }
  double reach() const { return cut_off * width; }
  double value(double distance2) const {
    return factor() * std::exp(-0.5 * distance2 / (width * width));
  }
  double along(double across2, double from, double to) const {
    const double w = std::numbers::sqrt2 * width, root = std::sqrt(std::numbers::pi);
    return value(across2) * 0.5 * root * w * (std::erf(to / w) - std::erf(from / w));
  }

 private:
  static constexpr double cut_off = 3;  // [widths]
  /// [1/m3] of the integral of exp(-r^2/2 w^2) up to c w: (2 pi)^(3/2) w^3 (erf(c/sqrt 2) -
  /// sqrt(2/pi) c exp(-c^2/2)).
  double factor() const {
    static const double inside =
        std::erf(cut_off / std::numbers::sqrt2) -
        std::sqrt(2 / std::numbers::pi) * cut_off * std::exp(-0.5 * cut_off * cut_off);
    const double root = std::sqrt(2 * std::numbers::pi) * width;
    return 1 / (root * root * root * inside);
  }
};

/// 105/(16 pi c^3) (1 + 3 r/c) (1 - r/c)^3: a polynomial with two continuous derivatives that ends
/// at c (Lucy, Astron. J. 82 (1977) 1013; recalled).
struct LucyKernel {
  double radius;  // [m] c

  void check() const { require_positive("LucyKernel.radius", radius, "m"); }
  double reach() const { return radius; }
  double value(double distance2) const {
    const double q = std::min(std::sqrt(distance2) / radius, 1.0), left = 1 - q;
    return 105 / (16 * std::numbers::pi * radius * radius * radius) * (1 + 3 * q) * left * left *
           left;
  }
  /// Gauss quadrature with 8 points on both sides of the nearest point; error 1e-6 of peak times
  /// length.
  double along(double across2, double from, double to) const {
    if (from < 0 && to > 0) return along(across2, 0, -from) + along(across2, 0, to);
    static const detail::GaussRule<8> rule;
    double sum = 0;
    for (std::size_t n = 0; n < rule.at.size(); ++n) {
      const double t = from + rule.at[n] * (to - from);
      sum += rule.weight[n] * value(across2 + t * t);
    }
    return sum * (to - from);
  }
};

/// Constant within a ball: plain means, with jumps.
struct HeavisideKernel {
  double radius;  // [m]

  void check() const { require_positive("HeavisideKernel.radius", radius, "m"); }
  double reach() const { return radius; }
  double value(double distance2) const {
    return distance2 < radius * radius ? 3 / (4 * std::numbers::pi * radius * radius * radius) : 0;
  }
  double along(double, double from, double to) const { return (to - from) * value(0); }
};

}  // namespace silt
