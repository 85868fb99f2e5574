// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Nodes and weights of Gauss quadrature on [0, 1], by Newton's method on the Legendre polynomial.
template <int N>
struct GaussRule {
  std::array<double, N> at{}, weight{};

  GaussRule() {
    for (int k = 0; k < N; ++k) {
      double x = std::cos(std::numbers::pi * (k + 0.75) / (N + 0.5)), slope = 1;
      for (int step = 0; step < 50; ++step) {
        double before = 1, p = x;
        for (int n = 2; n <= N; ++n)
          before = std::exchange(p, ((2 * n - 1) * x * p - (n - 1) * before) / n);
        slope = N * (x * p - before) / (x * x - 1);
        x -= p / slope;
      }
      at[static_cast<std::size_t>(k)] = 0.5 * (1 + x);
      weight[static_cast<std::size_t>(k)] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

}  // namespace silt::detail
