// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// What stands in the box of a flow: pipes, bends, drums, hoppers.
struct FlowBoundary {
  /// Signed distance [m] to the surface at a place [m]: positive in the fluid. It must be right
  /// within a cell of the surface.
  std::function<double(const Vec3d& place)> distance;
  std::function<Vec3d(const Vec3d& place)> velocity{};  // [m/s] of the surface; at rest if left out
};

namespace fluid_detail {

/// One field a direction: of velocities and fluxes.
using Three = std::array<Field, 3>;

/// Solids in the grid of a flow. A face is open if its centre is in the fluid. Towards a neighbour
/// in the solid, viscosity acts over the true distance to the surface (theta h instead of h):
///   mu (u_w - u)/(theta h^2) = mu (u_c - u)/h^2 + mu/h^2 (u_w/theta - u_c) - mu/h^2 (1/theta - 1)
///   u
/// of which the first term is that of the closed neighbour, whose velocity is u_c; then comes
/// `push`, and `drag` times u, which is implicit.
/// Source: F. Gibou et al., J. Comput. Phys. 176 (2002) 205 (symmetric Dirichlet condition).
struct FlowSolids {
  static constexpr double nearest = 0.05;  // theta, at the least

  FlowSolids(const Grid& grid, const FlowBoundary& boundary, double viscosity)
      : open{Field(grid, 1), Field(grid, 1), Field(grid, 1)},
        drag{Field(grid), Field(grid), Field(grid)},
        push{Field(grid), Field(grid), Field(grid)},
        velocity{Field(grid), Field(grid), Field(grid)},
        cells(grid) {
    for (int d = 0; d < 3; ++d) set(grid, boundary, viscosity, d), find_spans(grid, d);
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i)
          cells(i, j, k) = open[0](i, j, k) + open[0](i + 1, j, k) + open[1](i, j, k) +
                                       open[1](i, j + 1, k) + open[2](i, j, k) +
                                       open[2](i, j, k + 1) >
                                   0
                               ? 1
                               : 0;
  }

  Three open;      // [-] 1 or 0
  Three drag;      // [kg/(m3 s)]
  Three push;      // [N/m3] what goes with the walls' velocity
  Three velocity;  // [m/s] of the solid, in closed faces
  Field cells;     // [-] 1 with open faces, 0 without

  /// Values `from` ... `to`-1 of a row of faces, of which all others are in solids, as are those
  /// next to them.
  struct Span {
    int from = 0, to = 0;
  };
  Span span(int d, int j, int k) const {
    return spans_[static_cast<std::size_t>(d)]
                 [static_cast<std::size_t>(k) * rows_ + static_cast<std::size_t>(j)];
  }

 private:
  void find_spans(const Grid& grid, int d) {
    const auto& n = grid.cells();
    const auto c = static_cast<std::size_t>(d);
    rows_ = static_cast<std::size_t>(n[1] + 1);
    spans_[c].assign(rows_ * static_cast<std::size_t>(n[2] + 1), {});
    for (int k = 0; k <= n[2]; ++k)
      for (int j = 0; j <= n[1]; ++j) {
        Span& to = spans_[c][static_cast<std::size_t>(k) * rows_ + static_cast<std::size_t>(j)];
        to = {n[0] + 1, 0};
        for (int z = k - 1; z <= k + 1; ++z)
          for (int y = j - 1; y <= j + 1; ++y)
            for (int i = -1; i <= n[0] + 1; ++i)
              if (open[c](i, y, z) != 0)
                to.from = std::min(to.from, i - 1), to.to = std::max(to.to, i + 2);
      }
  }
  std::array<std::vector<Span>, 3> spans_;
  std::size_t rows_ = 0;

  void set(const Grid& grid, const FlowBoundary& boundary, double viscosity, int d) {
    constexpr int g = Grid::ghost;
    const auto& n = grid.cells();
    const std::size_t c = static_cast<std::size_t>(d);
    const double h[3] = {grid.h().x, grid.h().y, grid.h().z};
    const auto of = [d](const Vec3d& v) { return d == 0 ? v.x : d == 1 ? v.y : v.z; };
    Field distance(grid);
    const auto for_all = [&](const auto& visit) {
      for (int k = -g; k < n[2] + g; ++k)
        for (int j = -g; j < n[1] + g; ++j)
          for (int i = -g; i < n[0] + g; ++i) visit(i, j, k);
    };
    const auto place = [&](int i, int j, int k) {
      const int at[3] = {i, j, k};
      double x[3];
      for (int e = 0; e < 3; ++e) {
        const int m = n[static_cast<std::size_t>(e)];
        const int in = grid.periodic(e) ? (at[e] % m + m) % m : at[e];
        x[e] = (in + (e == d ? 0.0 : 0.5)) * h[e];
      }
      return grid.box().min + Vec3d{x[0], x[1], x[2]};
    };
    for_all([&](int i, int j, int k) {
      const Vec3d x = place(i, j, k);
      const double away = boundary.distance(x);
      require(!std::isnan(away), "FlowBoundary.distance is no number at ", x, " m");
      distance(i, j, k) = away;
      if (away > 0) return;
      open[c](i, j, k) = 0;
      if (boundary.velocity) {
        velocity[c](i, j, k) = of(boundary.velocity(x));
      }
    });
    for_all([&](int i, int j, int k) {
      if (open[c](i, j, k) == 0) return;
      for (int e = 0; e < 3; ++e)
        for (const int side : {-1, 1}) {
          int to[3] = {i, j, k};
          to[e] += side;
          const int m = n[static_cast<std::size_t>(e)];
          if (to[e] < -g || to[e] >= m + g) continue;
          // Beyond a side of the box it is the side that the fluid feels.
          if (!grid.periodic(e) && (to[e] < 0 || to[e] >= m + (e == d))) continue;
          if (open[c](to[0], to[1], to[2]) != 0) continue;
          const double here = distance(i, j, k), there = distance(to[0], to[1], to[2]);
          const double theta = std::clamp(here / (here - there), nearest, 1.0);
          const double link = viscosity / (h[e] * h[e]);
          Vec3d x = place(i, j, k);  // on the surface
          (e == 0 ? x.x : e == 1 ? x.y : x.z) += side * theta * h[e];
          const double wall = boundary.velocity ? of(boundary.velocity(x)) : 0;
          drag[c](i, j, k) += link * (1 / theta - 1);
          push[c](i, j, k) += link * (wall / theta - velocity[c](to[0], to[1], to[2]));
        }
    });
  }
};

}  // namespace fluid_detail

}  // namespace silt
