// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/core/position_row.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Motion of one sphere as the pair kernel reads it. Every entry enters a pair as a sum or
/// difference, so that one signed multiply-add of two rows gives the row of the pair: v_i - v_j,
/// 1/m*, the spin velocity r_i w_i + r_j w_j, 1/R*.
template <bool Rotates, class Scalar = double>
struct MotionRow;

template <class Scalar>
struct alignas(8 * sizeof(Scalar)) MotionRow<true, Scalar> {
  Scalar vx, vy, vz;  // [m/s] at the last half step
  Scalar inv_m;       // [1/kg]; 0: fixed
  Scalar wx, wy, wz;  // [m/s] radius times angular velocity, at the last half step
  Scalar inv_r;       // [1/m]
  Vec3<Scalar> velocity() const { return {vx, vy, vz}; }
  Vec3<Scalar> spin_velocity() const { return {wx, wy, wz}; }
};

template <class Scalar>
struct alignas(4 * sizeof(Scalar)) MotionRow<false, Scalar> {
  Scalar vx, vy, vz;  // [m/s] at the last half step
  Scalar inv_m;       // [1/kg]; 0: fixed
  Vec3<Scalar> velocity() const { return {vx, vy, vz}; }
};

static_assert(sizeof(PositionRow) == 32 && sizeof(MotionRow<true>) == 64 &&
              sizeof(MotionRow<false>) == 32);

/// The body a row is a part of.
struct PartRow {
  std::uint32_t body, local;  // index of the body; number of the part in its form
  Vec3d image{0, 0, 0};       // [m] shift from the body's frame to this image (periodic boxes)
};

}  // namespace silt
