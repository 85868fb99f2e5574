// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Data of an SPH particle for its neighbours: one cache line.
struct alignas(64) SphRow {
  double x, y, z;     // [m]
  double vx, vy, vz;  // [m/s]
  double density;     // [kg/m3]
  double pressure;    // [Pa]

  Vec3d position() const { return {x, y, z}; }
  Vec3d velocity() const { return {vx, vy, vz}; }
  void place(const Vec3d& at) { x = at.x, y = at.y, z = at.z; }
  void move(const Vec3d& v) { vx = v.x, vy = v.y, vz = v.z; }

  /// Fills up a pack: far from all others.
  static SphRow nobody() { return {far, far, far, 0, 0, 0, 1, 0}; }
  bool is_there() const { return x < 0.5 * far; }

 private:
  static constexpr double far = 1e30;
};
static_assert(sizeof(SphRow) == 64);

/// [kg/(m3 s)] Rate of density without diffusion.
struct SphGrowth {
  double density = 0;  // by the liquid around, and by walls and bodies that come nearer
  double parting = 0;  // by walls and bodies from which the particle parts, at most 0
};

/// What rows have beside SphRow, the first two of walls and bodies; empty: none of them has it.
struct SphBeside {
  std::span<const Vec3d> sticking{};    // [m/s] part of the velocity that only viscosities use
  std::span<const char> holds{};        // 1: may pull the liquid
  std::span<const double> viscosity{};  // [m2/s] of a viscosity that varies; of solids 0
  bool may_pull(std::size_t row) const { return !holds.empty() && holds[row] != 0; }
  SphBeside of_liquid() const { return {{}, {}, viscosity}; }
};

/// What a mirror image keeps of the liquid it sees, for velocities at the end of a step.
struct SphImage {
  double over = 0;    // [-] 1/(sum of V W); 0: sees none
  double share = 0;   // [-] weight of the mirrored values
  double nearer = 1;  // [-] see sph_velocity_at_wall
};

/// tau/rho [m2/s2] of a particle, symmetric, from turbulence.
struct alignas(64) SphStress {
  double xx = 0, yy = 0, zz = 0, yz = 0, zx = 0, xy = 0;
};

/// The same in mixed precision: positions are integers in a small unit, relative to the middle of
/// all (SphPairs::shorten).
struct SphBrief {
  std::int32_t x, y, z;
  float vx, vy, vz, density, pressure, volume;
  static constexpr std::int32_t most = 1 << 30;  // particles are within half of it
};

}  // namespace silt::detail
