// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <limits>

#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Number of a particle: given in the order in which they come, and never again.
using ParticleId = std::uint64_t;
/// Id of a particle that has left.
inline constexpr ParticleId no_particle = std::numeric_limits<ParticleId>::max();
/// Place of what is not there.
inline constexpr std::uint32_t no_place = std::numeric_limits<std::uint32_t>::max();

/// Centre and radius of one sphere [m]: what a search and the gap of a pair need, half a cache
/// line.
struct alignas(32) PositionRow {
  double x, y, z, r;
  Vec3d centre() const { return {x, y, z}; }
};

/// Two particles by their place in the rows.
struct IndexPair {
  std::uint32_t a, b;
};

}  // namespace silt
