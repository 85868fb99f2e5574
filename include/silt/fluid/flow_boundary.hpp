// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <variant>

#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// Walls in the box of a flow: pipes, bends, drums, hoppers.
struct FlowBoundary {
  /// Signed distance [m] from the surface at a position [m]: positive in the fluid. It must be
  /// accurate within a cell of the surface.
  std::function<double(const Vec3d& place)> distance;
  std::function<Vec3d(const Vec3d& place)> velocity{};  // [m/s] of the surface; default: at rest
};

/// No-slip wall at a side of the flow's box: the fluid has the wall's velocity.
struct NoSlip {
  Vec3d velocity{0, 0, 0};  // [m/s] along the wall
};

/// Wall without friction, or a plane of symmetry.
struct FreeSlip {};

/// Inflow (or outflow) with a given superficial velocity: that of the fluid upstream of the
/// particles; between particles it is faster by 1/eps. It passes the part of the side's faces that
/// a FlowBoundary leaves open. With a rate or an outline, velocities are scaled by one factor:
///
///   rate     the volume flow is exactly this, to rounding
///   outline  the volume flow is the integral of the velocity over the part of the side within
///            the outline and in the fluid of a FlowBoundary: true areas; for a disc of radius R
///            the error is h^2/(700 R^2), in cells of size h (side_area.hpp)
///
/// Time-dependent values are functions, called once per step with the time of its end:
///
///   velocity_in_time  of position and time; with an outline it is scaled by the true area of the
///                     patch over that of its faces, a constant factor
///   rate_in_time      the profile is that of `velocity` or `profile`, or uniform and normal; if
///                     negative the flow is reversed
///
/// The time is FlowSolver::time(), in a CoupledFlow that of the simulation. Flow and pressure are
/// second order in the step. A jump of a function causes a pressure pulse in its step.
///
/// Errors: set_side() and set_boundary(): InputError for rates that are not finite, patches without
///         an open face, velocities opposite to the rate, and both a constant and a function of
///         time. step(): InputError if a function of time is not finite.
/// Tests:  tests/fluid/inflow.cpp, inflow_in_time.cpp.
struct Inflow {
  Vec3d velocity{0, 0, 0};                             // [m/s]
  std::function<Vec3d(const Vec3d& place)> profile{};  // [m/s] at a position [m]; instead of
                                                       // velocity
  /// [m3/s] into the box, negative: out of it; without velocities uniform and normal.
  std::optional<double> rate{};
  /// Signed distance [m] to the edge of a patch of the side, positive inside. It must be accurate
  /// within a cell of the edge. Outside the patch the side is a wall at rest, which turbulence
  /// models ignore.
  std::function<double(const Vec3d& place)> outline{};
  std::function<Vec3d(const Vec3d& place, double time)> velocity_in_time{};  // [m/s] of m, s
  std::function<double(double time)> rate_in_time{};                         // [m3/s] of s

  bool changes() const { return velocity_in_time || rate_in_time; }
};

/// Outflow at a given pressure.
struct Outflow {
  double pressure = 0;  // [Pa]
};

/// Condition at a side of the flow's box.
using FlowSide = std::variant<NoSlip, FreeSlip, Inflow, Outflow>;

namespace fluid_detail {

/// One field per direction: velocities and fluxes.
using Three = std::array<CellField, 3>;

}  // namespace fluid_detail

}  // namespace silt
