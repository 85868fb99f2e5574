// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <limits>

#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Number of a particle: given in the order of creation, and never used again.
using ParticleId = std::uint64_t;
/// Marks a particle that has left.
inline constexpr ParticleId no_particle = std::numeric_limits<ParticleId>::max();
/// Marks the absence of a place.
inline constexpr std::uint32_t no_place = std::numeric_limits<std::uint32_t>::max();

/// Centre and radius of a sphere [m], for searches and gaps of pairs: half a cache line.
struct alignas(32) PositionRow {
  double x, y, z, r;
  Vec3d centre() const { return {x, y, z}; }
};

/// Two particles by their places in the rows.
struct IndexPair {
  std::uint32_t a, b;
};

}  // namespace silt
