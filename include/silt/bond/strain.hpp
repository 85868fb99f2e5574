// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/lanes.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// The two spheres that a bond holds together: i against j, and how each is turned.
template <class Real>
struct BondedEnds {
  Vec3<Real> apart;                                    // [m] x_i - x_j; in a periodic box the image
  Vec3<Real> velocity;                                 // [m/s] v_i - v_j
  BasicQuaternion<Real> orientation_i, orientation_j;  // body to space
  Vec3<Real> spin_i, spin_j;                           // [rad/s]
};

/// A bond as it was made: without strain.
template <class Real>
struct BondRest {
  Vec3<Real> arm_i, arm_j;     // [m] from the centres to the bond's middle, in the ends' own axes
  BasicQuaternion<Real> turn;  // axes of i in those of j
  Vec3<Real> normal;           // [-] unit, from j to i, in the axes of j
};

/// How a bond is strained: exactly, however far its ends turn and move together.
///
/// Each end carries its own copy of the bond's middle, p_i and p_j. The bond's frame is turned
/// halfway between the ends: with r = q_j^-1 q_i q_rest^-1, the turn of i against j, it is
/// q_j sqrt(r). In it
///
///   shift = p_i - p_j                                                             (1)
///   turn  = 2/3 w (4 - r0),  r = (r0, w)                                          (2)
///
/// A turn by the angle a about one axis is a (1 - a^4/480) in (2): 1e-7 off at 0.1 rad, 2e-3 at
/// 1 rad. What ends turn together does not enter. If a force f and a couple c on i are the
/// derivatives of an energy U(shift, turn), and loads() takes them to space, then they do the work
/// -dU exactly, for any motion; momentum and angular momentum are kept to rounding:
///
///   force on i  R f,  on j  -R f,  both at (p_i + p_j)/2                          (3)
///   couple on i R (A c + (shift x f) x t / 2),  on j the opposite                  (4)
///   A = ((4 - r0) 1 + (2 r0 - 3)/(1 + r0) w w^T) / 3,  t = w / (1 + r0)            (5)
///
/// Source: own derivation: d(turn)/dt = A (w_i - w_j), and the frame turns by
///   (w_i + w_j)/2 - t x (w_i - w_j)/2, both in the bond's frame.
/// Valid:  turns of i against j below 2 rad or so; a bond that is turned by more is torn.
/// Shapes: Real = double or a SIMD batch, lane = bond.
/// Tests:  tests/bond/strain.cpp (work of the loads, frame indifference, closed forms).
template <class Real>
struct BondStrain {
  Vec3<Real> shift, turn;            // [m], [rad] of i against j, in the bond's frame
  Vec3<Real> shift_rate, turn_rate;  // [m/s], [rad/s]
  BasicQuaternion<Real> frame;       // to space
  Vec3<Real> arm_i, arm_j;           // [m] from the centres to where the force acts, in space
  Real r0;                           // [-] (2)
  Vec3<Real> w;                      // [-]
};

/// What a bond does to its ends.
template <class Real>
struct BondLoads {
  Vec3<Real> force;               // [N] on i; on j the opposite
  Vec3<Real> torque_i, torque_j;  // [N m] about the centres
};

/// The strain of a bond.
template <class Real>
SILT_INLINE BondStrain<Real> strain_of(const BondRest<Real>& rest, const BondedEnds<Real>& ends) {
  const Real half(0.5), one(1);
  BasicQuaternion<Real> r =
      conjugate(ends.orientation_j) * ends.orientation_i * conjugate(rest.turn);
  // Of the two quaternions of one rotation that of the shorter way.
  const Real sign = select(r.w < Real(0), Real(-1), one);
  r = {sign * r.w, sign * r.x, sign * r.y, sign * r.z};
  const Real to_half = one / sqrt(Real(2) * (one + r.w));
  const BasicQuaternion<Real> h{(one + r.w) * to_half, r.x * to_half, r.y * to_half, r.z * to_half};
  BondStrain<Real> s;
  s.r0 = r.w, s.w = r.vector();
  s.frame = ends.orientation_j * h;
  const BasicQuaternion<Real> back = conjugate(s.frame);
  const Vec3<Real> b_i = rotate(ends.orientation_i, rest.arm_i),
                   b_j = rotate(ends.orientation_j, rest.arm_j);
  const Vec3<Real> gap = ends.apart + b_i - b_j;
  s.arm_i = b_i - half * gap, s.arm_j = b_j + half * gap;
  s.shift = rotate(back, gap);
  s.turn = (Real(2.0 / 3) * (Real(4) - r.w)) * s.w;
  const Vec3<Real> v = ends.velocity + cross(ends.spin_i, s.arm_i) - cross(ends.spin_j, s.arm_j);
  const Vec3<Real> spins = ends.spin_i - ends.spin_j;
  s.shift_rate = rotate(back, v), s.turn_rate = rotate(back, spins);
  return s;
}

/// The loads of a force and a couple on i that go with the strain (derivatives of an energy), and
/// of others that go with the rates (dashpots), all in the bond's frame.
template <class Real>
SILT_INLINE BondLoads<Real> loads_of(const BondStrain<Real>& s, const Vec3<Real>& force,
                                     const Vec3<Real>& couple, const Vec3<Real>& rate_force,
                                     const Vec3<Real>& rate_couple) {
  const Real third(1.0 / 3), one(1);
  const Real per = one / (one + s.r0);
  const Vec3<Real> turned = third * ((Real(4) - s.r0) * couple +
                                     ((Real(2) * s.r0 - Real(3)) * per * dot(s.w, couple)) * s.w);
  const Vec3<Real> frame_couple = (Real(0.5) * per) * cross(cross(s.shift, force), s.w);
  const Vec3<Real> F = rotate(s.frame, force + rate_force);
  const Vec3<Real> M = rotate(s.frame, turned + frame_couple + rate_couple);
  return {F, cross(s.arm_i, F) + M, -cross(s.arm_j, F) - M};
}

}  // namespace silt
