// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <variant>

#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

/// What stands in the box of a flow: pipes, bends, drums, hoppers.
struct FlowBoundary {
  /// Signed distance [m] to the surface at a place [m]: positive in the fluid. It must be right
  /// within a cell of the surface.
  std::function<double(const Vec3d& place)> distance;
  std::function<Vec3d(const Vec3d& place)> velocity{};  // [m/s] of the surface; at rest if left out
};

/// A wall at a side of the flow's box: the fluid has its velocity there.
struct NoSlip {
  Vec3d velocity{0, 0, 0};  // [m/s] along the wall
};

/// A wall without friction, or a plane of symmetry.
struct FreeSlip {};

/// Fluid flows in (or is drawn out) at a given velocity, which is superficial: that of the fluid in
/// front of the particles; beside them it is 1/eps times as fast. It passes what a FlowBoundary
/// leaves open of the side's faces. With a rate or an outline, velocities are scaled by one factor:
///
///   rate     just that much passes, to rounding
///   outline  what passes is the integral of the velocity over the part of the side that is within
///            the outline, and in the fluid of a FlowBoundary: true areas; that of a disc
///            of radius R to h^2/(700 R^2) of it, in cells of size h (side_area.hpp)
///
/// What changes with time is a function of it, which is asked once a step for the step's end:
///
///   velocity_in_time  of place and time; with an outline it is scaled by the patch's true area
///   over
///                     that of its faces, at all times the same
///   rate_in_time      the shape is that of `velocity` or `profile`, or straight in; below 0 it
///                     flows the other way
///
/// The time is FlowSolver::time(), which in a CoupledFlow is that of the simulation. Flow and
/// pressure follow to second order in the step. A function that jumps is felt as a blow of the
/// pressure in the step in which it does.
/// Errors: set_side() and set_boundary(): InputError for rates that are not finite, patches without
///         an open face, velocities that flow the other way than the rate, and both a constant and
///         a function of time. step(): InputError where a function of time is not finite.
/// Tests:  tests/fluid/inflow.cpp, inflow_in_time.cpp.
struct Inflow {
  Vec3d velocity{0, 0, 0};                             // [m/s]
  std::function<Vec3d(const Vec3d& place)> profile{};  // [m/s] at a place [m]; instead of velocity
  /// [m3/s] into the box, below 0 out of it; velocities left out: straight in.
  std::optional<double> rate{};
  /// Signed distance [m] to the edge of a patch of the side, positive in it; it must be right
  /// within a cell of the edge. Beyond it the side is a wall at rest, which a turbulent flow does
  /// not feel.
  std::function<double(const Vec3d& place)> outline{};
  std::function<Vec3d(const Vec3d& place, double time)> velocity_in_time{};  // [m/s] of m, s
  std::function<double(double time)> rate_in_time{};                         // [m3/s] of s

  bool changes() const { return velocity_in_time || rate_in_time; }
};

/// Fluid flows out, at a given pressure.
struct Outflow {
  double pressure = 0;  // [Pa]
};

/// What a side of the flow's box is.
using FlowSide = std::variant<NoSlip, FreeSlip, Inflow, Outflow>;

namespace fluid_detail {

/// One field a direction: of velocities and fluxes.
using Three = std::array<CellField, 3>;

}  // namespace fluid_detail

}  // namespace silt
