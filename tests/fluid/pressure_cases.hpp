// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include <silt/fluid/grid.hpp>
#include <silt/fluid/pressure_solver.hpp>

namespace silt_test {

/// A linear system on a grid: coefficients and right side.
struct PressureCase {
  silt::Grid grid;
  silt::CellField ax, ay, az, d, b;
  explicit PressureCase(const silt::Grid& on) : grid(on), ax(on), ay(on), az(on), d(on), b(on) {}

  template <class Call>
  void for_cells(const Call& call) const {
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) call(i, j, k);
  }

  /// Coefficients of the faces from weights of the cells: the mean of both sides where both are
  /// open (> 0), times area / distance.
  void join(const silt::CellField& weight) {
    const silt::Vec3d h = grid.h();
    const double shape[3] = {h.y * h.z / h.x, h.z * h.x / h.y, h.x * h.y / h.z};
    const auto face = [&](int c, double u, double v) {
      return u > 0 && v > 0 ? 0.5 * (u + v) * shape[c] : 0.0;
    };
    const auto below = [&](int c, int i, int n) {
      return i > 0 ? i - 1 : grid.periodic(c) ? n - 1 : -1;
    };
    for_cells([&](int i, int j, int k) {
      const int x = below(0, i, grid.nx()), y = below(1, j, grid.ny()), z = below(2, k, grid.nz());
      const double own = weight(i, j, k);
      if (x >= 0) ax(i, j, k) = face(0, own, weight(x, j, k));
      if (y >= 0) ay(i, j, k) = face(1, own, weight(i, y, k));
      if (z >= 0) az(i, j, k) = face(2, own, weight(i, j, z));
    });
  }
};

/// The systems of the speed comparison. C: constant coefficients. B, D: a bed with noise and three
/// bubbles below a freeboard, contrast 26 and 2500; p = 0 above. P: a bend of a pipe, 72 % of the
/// cells blocked, p = 0 at one end. Right sides are white noise.
inline PressureCase pressure_case(char name, int n) {
  using silt::Vec3d;
  PressureCase made(silt::Grid({{0, 0, 0}, {1, 1, 1}}, {n, n, n}));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr std::array<std::array<double, 4>, 3> bubbles{
      {{0.3, 0.4, 0.25, 0.12}, {0.7, 0.6, 0.35, 0.15}, {0.5, 0.2, 0.45, 0.1}}};
  silt::CellField weight(made.grid);
  made.for_cells([&](int i, int j, int k) {
    const Vec3d x = made.grid.centre(i, j, k);
    double w = 1;
    if (name == 'B' || name == 'D') {
      double depth = x.z < 0.5 ? 0.4 + 0.6 * uniform(random) : 0.0;  // of -log w / log contrast
      for (const auto& bubble : bubbles)
        if (std::hypot(x.x - bubble[0], x.y - bubble[1], x.z - bubble[2]) < bubble[3]) depth *= 0.1;
      w = std::pow(name == 'B' ? 26.0 : 2500.0, -depth);
    } else if (name == 'P') {
      w = std::hypot(std::hypot(x.x, x.z) - 0.6, x.y - 0.5) < 0.307 ? 1.0 : 0.0;
    }
    weight(i, j, k) = w;
    made.b(i, j, k) = w > 0 ? 2 * uniform(random) - 1 : 0;
    const bool outlet = name == 'P' ? k == 0 : k == n - 1;
    if (outlet) made.d(i, j, k) = 2 * w * made.grid.h().x;
  });
  made.join(weight);
  return made;
}

}  // namespace silt_test
