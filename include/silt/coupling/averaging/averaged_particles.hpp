// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

struct AveragedForm;  // coupling/averaging/averaged_form.hpp

/// Where the particles are, as an averaging operator sees them.
struct AveragedParticles {
  std::span<const Vec3d> position;  // [m] of the centre of mass
  std::span<const double> radius;   // [m] of the sphere, or of the sphere of the body's volume
  // Of bodies alone:
  std::span<const Quaternion> orientation = {};  // principal axes to space
  std::span<const std::uint32_t> form = {};      // which of `forms`; left out: all the first
  std::span<const AveragedForm> forms = {};      // left out: spheres
};

/// What place() found.
struct AveragingReport {
  std::size_t particles = 0;
  std::size_t outside = 0;       // not in the grid: they have no weights, gather gives 0
  std::size_t without_open = 0;  // none of their cells is open: all goes to the nearest open cell
  std::size_t bytes = 0;         // that the weights take
};

}  // namespace silt
