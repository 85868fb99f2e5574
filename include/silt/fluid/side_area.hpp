// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Share of a unit square where a function is positive; the function has these values at its
/// corners, in order, and is linear along its edges.
inline double positive_share(const std::array<double, 4>& value) {
  constexpr double x[4] = {0, 1, 1, 0}, y[4] = {0, 0, 1, 1};
  std::array<double, 8> px{}, py{};
  std::size_t n = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    if (value[k] > 0) px[n] = x[k], py[n] = y[k], ++n;
    if ((value[k] > 0) == (value[next] > 0)) continue;
    const double t = value[k] / (value[k] - value[next]);
    px[n] = x[k] + t * (x[next] - x[k]), py[n] = y[k] + t * (y[next] - y[k]), ++n;
  }
  double twice = 0;
  for (std::size_t k = 0; k < n; ++k) twice += px[k] * py[(k + 1) % n] - px[(k + 1) % n] * py[k];
  return 0.5 * twice;
}

/// Integral of flux(u, v) over the part of the rectangle with lengths a, b about (u0, v0) where
/// distance(u, v), a signed distance, is positive. The rectangle is divided into pieces x pieces of
/// size s. A boundary with the radius R is displaced by at most s^2/(4 R); straight ones are exact.
template <std::size_t pieces, class Distance, class Flux>
auto integral_inside(double u0, double v0, double a, double b, const Distance& distance,
                     const Flux& flux) {
  using Value = decltype(flux(u0, v0));
  const double middle = distance(u0, v0), reach = std::hypot(a, b);
  if (middle < -reach) return Value{};
  const bool cut = !(middle > reach);
  const double du = a / pieces, dv = b / pieces, low_u = u0 - 0.5 * a, low_v = v0 - 0.5 * b;
  std::array<std::array<double, pieces + 1>, 2> row{};
  const auto fill = [&](std::size_t j) {
    for (std::size_t i = 0; i <= pieces && cut; ++i)
      row[j % 2][i] =
          distance(low_u + static_cast<double>(i) * du, low_v + static_cast<double>(j) * dv);
  };
  Value sum{};
  fill(0);
  for (std::size_t j = 0; j < pieces; ++j) {
    fill(j + 1);
    const auto &below = row[j % 2], &above = row[(j + 1) % 2];
    for (std::size_t i = 0; i < pieces; ++i) {
      const double share =
          cut ? positive_share({below[i], below[i + 1], above[i + 1], above[i]}) : 1;
      if (share > 0)
        sum += share * flux(low_u + (static_cast<double>(i) + 0.5) * du,
                            low_v + (static_cast<double>(j) + 0.5) * dv);
    }
  }
  return du * dv * sum;
}

}  // namespace silt::inline SILT_TARGET::fluid_detail
