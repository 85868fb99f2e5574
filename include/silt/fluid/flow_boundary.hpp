// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <functional>

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

}  // namespace fluid_detail

}  // namespace silt
