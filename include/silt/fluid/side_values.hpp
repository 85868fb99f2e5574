// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/flow_boundary.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// One side of a flow's box with its velocities. For FlowSides.
struct SideValues {
  FlowSide kind = NoSlip{};
  std::array<DynArray<double>, 3> given;  // velocities where each component crosses the side
  DynArray<char> beyond;                  // 1 outside the outline; empty: no outline
  // For time-dependent inflows:
  std::array<DynArray<double>, 3> shape;  // what 1 m3/s gives
  DynArray<double> slope;                 // [m/s2] normal to the side; empty: not known yet
  double factor = 1;                      // [-] of velocities, for true areas

  /// Whether the normal velocities have jumped from `before`: by more than a third of their new
  /// value, and at another rate than in the previous step. `dt` [s] between; 0: unknown.
  bool jumped(int direction, const DynArray<double>& before, double dt) {
    const auto& now = given[static_cast<std::size_t>(direction)];
    DynArray<double> rate(dt > 0 ? now.size() : 0);
    double size = 0, change = 0, old_change = 0, turn = 0;  // sums of squares
    for (std::size_t k = 0; k < rate.size(); ++k) {
      rate[k] = (now[k] - before[k]) / dt;
      const double old = slope.empty() ? rate[k] : slope[k];
      size += now[k] * now[k], change += dt * dt * rate[k] * rate[k];
      old_change += dt * dt * old * old, turn += dt * dt * (rate[k] - old) * (rate[k] - old);
    }
    slope = std::move(rate);
    return 9 * change > size && 9 * turn > std::max(change, old_change);
  }
};

/// A line of values across a side, of direction e: the cell at the side.
struct SideLine {
  int at[3];
  int e;
};

/// Refuses an inflow that is both constant and a function of time.
inline void check_one_way(const Inflow& in, const char* name) {
  const Vec3d& v = in.velocity;
  const bool constant = in.profile || v.x != 0 || v.y != 0 || v.z != 0;
  require(!in.velocity_in_time || !(constant || in.rate || in.rate_in_time),
          "FlowSolver: the Inflow at a side in ", name,
          " has velocity_in_time and another velocity or rate; give only one");
  require(!in.rate_in_time || !in.rate, "FlowSolver: the Inflow at a side in ", name,
          " has both rate and rate_in_time; give only one");
}

/// Factor [-] of an inflow's velocities with the volume flow `passes` [m3/s] that makes it
/// `wanted`. `both_ways`: flow in and out; `faces`: number of open faces, at end `end` of direction
/// e.
inline double inflow_factor(double wanted, double passes, double both_ways, int faces, int e,
                            int end) {
  const char name[] = {"xyz"[e], 0};
  const char* const which = end == 0 ? "lower" : "upper";
  require(faces > 0, "FlowSolver: the Inflow at the ", which, " side in ", name,
          " has no face whose centre is within its outline and in the fluid; use smaller cells, "
          "or check that they overlap");
  if (wanted == 0 && passes == 0) return 1;
  require(std::abs(passes) > 1e-6 * both_ways && wanted / passes >= 0, "FlowSolver: ", wanted,
          " m3/s are to flow in at the ", which, " side in ", name, ", but its velocities let in ",
          passes,
          " m3/s, which no positive factor can turn into that; reverse them, or leave "
          "them out and give the rate");
  return wanted / passes;
}

}  // namespace silt::fluid_detail
