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
/// Errors: set_side() and set_boundary(): InputError for rates that are not finite, patches without
///         an open face, and velocities that flow the other way than the rate.
/// Tests:  tests/fluid/inflow.cpp.
struct Inflow {
  Vec3d velocity{0, 0, 0};                             // [m/s]
  std::function<Vec3d(const Vec3d& place)> profile{};  // [m/s] at a place [m]; instead of velocity
  /// [m3/s] into the box, below 0 out of it; velocities left out: straight in.
  std::optional<double> rate{};
  /// Signed distance [m] to the edge of a patch of the side, positive in it; it must be right
  /// within a cell of the edge. Beyond it the side is a wall at rest, which a turbulent flow does
  /// not feel.
  std::function<double(const Vec3d& place)> outline{};
};

/// Fluid flows out, at a given pressure.
struct Outflow {
  double pressure = 0;  // [Pa]
};

using FlowSide = std::variant<NoSlip, FreeSlip, Inflow, Outflow>;

namespace fluid_detail {

/// One field a direction: of velocities and fluxes.
using Three = std::array<CellField, 3>;

}  // namespace fluid_detail

}  // namespace silt
