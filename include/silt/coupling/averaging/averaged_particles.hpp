// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

struct AveragedForm;  // coupling/averaging/averaged_form.hpp

/// Particles as input of an averaging operator.
struct AveragedParticles {
  std::span<const Vec3d> position;  // [m] of the centre of mass
  std::span<const double> radius;   // [m] of the sphere, or of the sphere of equal volume
  // Only for bodies:
  std::span<const Quaternion> orientation = {};  // principal axes to space
  std::span<const std::uint32_t> form = {};      // index in `forms`; left out: all have the first
  std::span<const AveragedForm> forms = {};      // left out: spheres
};

/// Result of place().
struct AveragingReport {
  std::size_t particles = 0;
  std::size_t outside = 0;       // outside the grid: no weights, gather gives 0
  std::size_t without_open = 0;  // no open cell in range: all weight on the nearest open cell
  std::size_t bytes = 0;         // memory of the weights
};

}  // namespace silt
