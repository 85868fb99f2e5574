// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <silt/core/error.hpp>
#include <silt/fluid/concept.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// The pressure p [Pa] of silt's flows excludes the weight of the fluid: p = P - rho g.(x - x0)
/// with the true pressure P. A fluid at rest has uniform p. Data to add the weight:
struct FluidWeight {
  Vec3d gravity;  // [m/s2]
  Vec3d from;     // [m] the point x0 of equal pressures: a surface, an outlet

  /// rho g.(x - x0) [Pa] at a point x [m].
  double pressure(double density, const Vec3d& x) const { return density * dot(gravity, x - from); }
};

/// Values of a flow at a point.
struct FlowValues {
  Vec3d velocity;                                           // [m/s] between the particles
  double pressure;                                          // [Pa] without the fluid's weight
  double voidage;                                           // [-]
  std::optional<double> temperature{};                      // [K] of a flow with heat
  Vec3d superficial() const { return voidage * velocity; }  // [m/s]
};

namespace detail {

/// The temperature [K] of a flow's cells; null if it has none.
template <class Flow>
const CellField* temperature_of(const Flow& flow) {
  if constexpr (requires { flow.has_heat(); })
    return flow.has_heat() ? &flow.temperature() : nullptr;
  else
    return nullptr;
}

/// The two neighbours of a point along one direction: the lower one, and the weight of the upper.
struct Between {
  int low;
  double high;  // [-]
};
/// Among values at cell centres (`shift` 0.5) or at faces (0) of direction d; `past`: number of
/// values usable beyond the first and the last.
inline Between neighbours_of(double along, int first, int last, double shift) {
  const double s = along - shift;
  const int low = std::clamp(static_cast<int>(std::floor(s)), first, std::max(first, last - 1));
  return {low, last > first ? s - low : 0};
}

/// Position in cells of a grid, from its lower corner; empty outside the box. Periodic ones wrap.
inline std::optional<std::array<double, 3>> place_in_cells(const Grid& g, const Vec3d& x) {
  const Vec3d &low = g.box().min, &h = g.h();
  std::array<double, 3> at{(x.x - low.x) / h.x, (x.y - low.y) / h.y, (x.z - low.z) / h.z};
  for (std::size_t d = 0; d < 3; ++d) {
    const double n = g.cells()[d];
    if (g.periodic(static_cast<int>(d))) at[d] -= n * std::floor(at[d] / n);
    if (!(at[d] >= -1e-9 * n && at[d] <= n * (1 + 1e-9))) return std::nullopt;
  }
  return at;
}

/// Cell values around a point.
template <class Flow>
class CellsAround {
 public:
  CellsAround(const Flow& flow, const std::array<double, 3>& at) : grid_(flow.grid()), at_(at) {
    open_ = flow.open_cells();
    for (int d = 0; d < 3; ++d) {
      const auto c = static_cast<std::size_t>(d);
      const int n = grid_.cells()[c];
      near_[c] = grid_.periodic(d) ? neighbours_of(at[c], -1, n, 0.5)
                                   : neighbours_of(at[c], 0, n - 1, 0.5);
    }
    whole_ = true;
    for (int corner = 0; corner < 8 && open_ != nullptr; ++corner)
      whole_ = whole_ && is_open(of_corner(corner));
    if (!whole_) find_nearest();
  }
  bool in_fluid() const { return whole_ || found_; }

  /// Linear between cells; next to walls in the box from the nearest fluid cell and its slopes.
  double value(const CellField& f) const {
    double sum = 0;
    if (whole_) {
      for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        for (int d = 0; d < 3; ++d) {
          const double high = near_[static_cast<std::size_t>(d)].high;
          weight *= corner >> d & 1 ? high : 1 - high;
        }
        if (weight != 0) sum += weight * of(f, of_corner(corner));
      }
      return sum;
    }
    sum = of(f, nearest_);
    for (std::size_t d = 0; d < 3; ++d) {
      auto low = nearest_, high = nearest_;
      --low[d], ++high[d];
      if (!is_open(low)) low = nearest_;
      if (!is_open(high)) high = nearest_;
      const int apart = high[d] - low[d];
      if (apart > 0) sum += (at_[d] - 0.5 - nearest_[d]) * (of(f, high) - of(f, low)) / apart;
    }
    return sum;
  }

 private:
  using Cell = std::array<int, 3>;
  Cell of_corner(int corner) const {
    Cell c{};
    for (int d = 0; d < 3; ++d) {
      const auto k = static_cast<std::size_t>(d);
      c[k] = near_[k].low + (corner >> d & 1 && grid_.cells()[k] > 1 ? 1 : 0);
    }
    return c;
  }
  Cell wrapped(Cell c) const {
    for (int d = 0; d < 3; ++d) {
      const auto k = static_cast<std::size_t>(d);
      if (grid_.periodic(d)) c[k] = (c[k] % grid_.cells()[k] + grid_.cells()[k]) % grid_.cells()[k];
    }
    return c;
  }
  double of(const CellField& f, const Cell& c) const {
    const Cell w = wrapped(c);
    return f(w[0], w[1], w[2]);
  }
  bool is_open(const Cell& c) const {
    const Cell w = wrapped(c);
    for (std::size_t d = 0; d < 3; ++d)
      if (w[d] < 0 || w[d] >= grid_.cells()[d]) return false;
    return open_ == nullptr || (*open_)(w[0], w[1], w[2]) > 0;
  }
  void find_nearest() {
    double least = 1.5 * 1.5 * 3;
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const Cell c{static_cast<int>(std::floor(at_[0])) + i,
                       static_cast<int>(std::floor(at_[1])) + j,
                       static_cast<int>(std::floor(at_[2])) + k};
          double away = 0;  // [cells] squared
          for (std::size_t d = 0; d < 3; ++d) away += std::pow(at_[d] - 0.5 - c[d], 2);
          if (away < least && is_open(c)) least = away, nearest_ = c, found_ = true;
        }
  }

  const Grid& grid_;
  const CellField* open_;
  std::array<double, 3> at_;
  std::array<Between, 3> near_;
  bool whole_, found_ = false;
  Cell nearest_{};
};

/// Component d of the velocity, linear between faces; ghosts follow the conditions at the sides.
template <class Flow>
double velocity_in_cells(const Flow& flow, int d, const std::array<double, 3>& at) {
  const Grid& g = flow.grid();
  const CellField& u = flow.velocity(d);
  std::array<Between, 3> near;
  for (int e = 0; e < 3; ++e) {
    const auto c = static_cast<std::size_t>(e);
    const int n = g.cells()[c];
    near[c] = e == d ? neighbours_of(at[c], 0, n, 0) : neighbours_of(at[c], -1, n, 0.5);
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    int f[3];
    double weight = 1;
    for (int e = 0; e < 3; ++e) {
      const Between& b = near[static_cast<std::size_t>(e)];
      f[e] = b.low + (corner >> e & 1), weight *= corner >> e & 1 ? b.high : 1 - b.high;
    }
    if (weight != 0) sum += weight * u(f[0], f[1], f[2]);
  }
  return sum;
}

}  // namespace detail

/// Whether there is fluid at a point [m]: in the flow's box, and not inside its walls by more than
/// a cell.
template <FlowOnGrid Flow>
bool has_fluid_at(const Flow& flow, const Vec3d& x) {
  const auto at = detail::place_in_cells(flow.grid(), x);
  return at && detail::CellsAround<Flow>(flow, *at).in_fluid();
}

/// Interpolates a flow at a point [m], after start() or a step: linear between its values on faces
/// (velocity) and in cells (pressure, void fraction). Exact for linear fields. Within half a cell
/// of a side, pressure and void fraction are extrapolated, and velocities match those of the side.
/// Near walls in the box, and at the wall itself, pressure and void fraction use only fluid cells;
/// velocities are first order.
/// Errors: InputError if there is no fluid. Tests: tests/fluid/flow_at.cpp.
template <FlowOnGrid Flow>
FlowValues flow_at(const Flow& flow, const Vec3d& x) {
  const auto at = detail::place_in_cells(flow.grid(), x);
  require(at.has_value(), "flow_at: the place ", x, " m is outside the flow's box from ",
          flow.grid().box().min, " to ", flow.grid().box().max, " m");
  const detail::CellsAround<Flow> around(flow, *at);
  require(around.in_fluid(), "flow_at: at ", x,
          " m there is no fluid: it is within a wall by more than a cell");
  const Flow& seen = flow;
  std::optional<double> temperature;
  if (const CellField* T = detail::temperature_of(seen)) temperature = around.value(*T);
  return {{detail::velocity_in_cells(flow, 0, *at), detail::velocity_in_cells(flow, 1, *at),
           detail::velocity_in_cells(flow, 2, *at)},
          around.value(seen.pressure()),
          std::clamp(around.value(seen.voidage()), 0.0, 1.0),
          temperature};
}

/// Mean pressure [Pa] over the plane normal to direction d at `where` [m], weighted with the area
/// open to the fluid, as measured by a ring of taps. Linear between the layers of cells.
/// Errors: InputError if the plane is outside the box, or has no fluid.
template <FlowOnGrid Flow>
double mean_pressure_across(const Flow& flow, int d, double where) {
  require(d >= 0 && d < 3, "mean_pressure_across: direction ", d, " is not 0, 1 or 2");
  const Grid& g = flow.grid();
  const auto c = static_cast<std::size_t>(d);
  const Vec3d low = g.box().min, high = g.box().max;
  const double from = d == 0 ? low.x : d == 1 ? low.y : low.z;
  const double to = d == 0 ? high.x : d == 1 ? high.y : high.z;
  const int n = g.cells()[c];
  double along = (where - from) * n / (to - from);
  if (g.periodic(d)) along -= n * std::floor(along / n);
  require(along >= -1e-9 * n && along <= n * (1 + 1e-9), "mean_pressure_across: ", where,
          " m is outside the flow's box, which goes from ", from, " to ", to, " m in ", "xyz"[d]);
  const detail::Between near = g.periodic(d) ? detail::neighbours_of(along, -1, n, 0.5)
                                             : detail::neighbours_of(along, 0, n - 1, 0.5);
  double sum = 0, area = 0;
  const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
  for (int y = 0; y < g.cells()[b]; ++y)
    for (int x = 0; x < g.cells()[a]; ++x) {
      double share = 1, value = 0;
      for (const int end : {0, 1}) {
        std::array<int, 3> cell{};
        cell[a] = x, cell[b] = y, cell[c] = n > 1 ? ((near.low + end) % n + n) % n : 0;
        if (const auto* open = flow.open_cells()) share *= (*open)(cell[0], cell[1], cell[2]);
        value +=
            (end == 1 ? near.high : 1 - near.high) * flow.pressure()(cell[0], cell[1], cell[2]);
      }
      if (share > 0) sum += share * value, area += share;
    }
  require(area > 0, "mean_pressure_across: at ", where, " m in ", "xyz"[d], " there is no fluid");
  return sum / area;
}

}  // namespace silt
