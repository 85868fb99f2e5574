// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/cell_values.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Values for the particles in a cell.
struct HeldValues {
  Vec3d velocity{0, 0, 0};  // [m/s]
  Vec3d push{0, 0, 0};      // [N/m3] pressure and viscous stress
};

/// Values of a flow, stored on cells of another size over its box: the mean over points in each
/// cell, no farther apart than the flow's own cells, linear between those.
class HeldCells {
 public:
  void make(const Grid& g, double size) {
    const Vec3d extent = g.box().extent(), h = g.h();
    low_ = g.box().min;
    const double length[3] = {extent.x, extent.y, extent.z}, width[3] = {h.x, h.y, h.z};
    for (int d = 0; d < 3; ++d) {
      count_[d] = std::max(1, static_cast<int>(std::lround(length[d] / size)));
      size_[d] = length[d] / count_[d];
      points_[d] = std::max(1, static_cast<int>(std::ceil(size_[d] / width[d] - 1e-9)));
      periodic_[d] = g.periodic(d);
    }
    values_.resize(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) *
                   static_cast<std::size_t>(count_[2]));
  }
  void renew(const Grid& g, const CellValues& from, bool with_pressure, const Team& team) {
    const double share = 1.0 / (points_[0] * points_[1] * points_[2]);
    team.for_parts(static_cast<std::size_t>(count_[2]), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      for (int j = 0; j < count_[1]; ++j)
        for (int i = 0; i < count_[0]; ++i) {
          HeldValues sum;
          for (int c = 0; c < points_[2]; ++c)
            for (int b = 0; b < points_[1]; ++b)
              for (int a = 0; a < points_[0]; ++a)
                add(g, from, with_pressure,
                    {i + (a + 0.5) / points_[0], j + (b + 0.5) / points_[1],
                     k + (c + 0.5) / points_[2]},
                    sum);
          values_[index(i, j, k)] = {share * sum.velocity, share * sum.push};
        }
    });
  }
  const HeldValues& at(const Vec3d& p) const {
    return values_[index(place(p.x - low_.x, 0), place(p.y - low_.y, 1), place(p.z - low_.z, 2))];
  }

 private:
  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>((k * count_[1] + j) * count_[0] + i);
  }
  int place(double x, int d) const {
    const double L = size_[d] * count_[d];
    if (periodic_[d]) x -= L * std::floor(x / L);
    return std::clamp(static_cast<int>(x / size_[d]), 0, count_[d] - 1);
  }
  /// `at` in units of these cells.
  void add(const Grid& g, const CellValues& from, bool with_pressure, const double (&at)[3],
           HeldValues& sum) const {
    const double h[3] = {g.h().x, g.h().y, g.h().z};
    int low[3], high[3];
    double of_high[3];
    for (int d = 0; d < 3; ++d) {
      const int n = g.cells()[static_cast<std::size_t>(d)];
      double x = at[d] * size_[d] / h[d] - 0.5;
      if (!periodic_[d]) x = std::clamp(x, 0.0, n - 1.0);
      const int below = static_cast<int>(std::floor(x));
      of_high[d] = x - below;
      low[d] = (below + n) % n;
      high[d] = periodic_[d] ? (below + 1 + n) % n : std::min(below + 1, n - 1);
    }
    for (int corner = 0; corner < 8; ++corner) {
      int c[3];
      double w = 1;
      for (int d = 0; d < 3; ++d) {
        const bool up = (corner >> d) & 1;
        c[d] = up ? high[d] : low[d], w *= up ? of_high[d] : 1 - of_high[d];
      }
      if (w == 0) continue;
      const auto value = [&](const CellValues::Three& of) {
        return Vec3d{of[0](c[0], c[1], c[2]), of[1](c[0], c[1], c[2]), of[2](c[0], c[1], c[2])};
      };
      sum.velocity += w * value(from.velocity);
      if (with_pressure) sum.push += w * (value(from.stress) - value(from.slope));
    }
  }

  Vec3d low_{0, 0, 0};
  int count_[3] = {0, 0, 0}, points_[3] = {1, 1, 1};
  double size_[3] = {0, 0, 0};  // [m]
  bool periodic_[3] = {false, false, false};
  DynArray<HeldValues> values_;
};

}  // namespace silt::detail
