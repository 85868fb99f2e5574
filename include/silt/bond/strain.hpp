// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/lanes.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// The two spheres of a bond: i relative to j, and the orientation of each.
template <class Real>
struct BondedEnds {
  Vec3<Real> apart;                                    // [m] x_i - x_j; the image in a periodic box
  Vec3<Real> velocity;                                 // [m/s] v_i - v_j
  BasicQuaternion<Real> orientation_i, orientation_j;  // body to space
  Vec3<Real> spin_i, spin_j;                           // [rad/s]
};

/// Reference state of a bond, without strain. Its middle is on the line between the centres.
template <class Real>
struct BondRest {
  Vec3<Real> apart;            // [m] x_i - x_j, in the axes of j
  Real share;                  // [-] share of it that is the arm of i
  BasicQuaternion<Real> turn;  // axes of i in those of j
  Real per_length;             // [1/m] inverse length of `apart`

  static BondRest of(const Vec3<Real>& apart, const Real& share,
                     const BasicQuaternion<Real>& turn) {
    return {apart, share, turn, Real(1) / sqrt(dot(apart, apart))};
  }
};

/// Strain of a bond, exact for any common rotation and translation of its ends. All in space.
///
/// Each end has its own copy of the middle of the bond, p_i and p_j. The frame of the bond is
/// halfway between its ends: with the rotation r = q_i q_rest^-1 q_j^-1 of i against j, its normal
/// is that of j rotated by sqrt(r).
///
///   shift = p_i - p_j                                                             (1)
///   turn  = 2/3 w (4 - r0),  r = (r0, w)                                          (2)
///
/// A rotation by the angle a about one axis is a (1 - a^4/480) in (2): an error of 2e-7 at 0.1 rad,
/// 2e-3 at 1 rad. Common rotations of the ends have no effect. If a force f and a couple c on i are
/// the derivatives of an energy U(shift, turn) in the frame of the bond, the loads of loads_of() do
/// exactly the work -dU for any motion. Momentum and angular momentum are conserved to rounding:
///
///   force on i  f,  on j  -f,  both at (p_i + p_j)/2                              (3)
///   couple on i A c + (shift x f) x t / 2,  on j the opposite                      (4)
///   A = ((4 - r0) 1 + (2 r0 - 3)/(1 + r0) w w^T) / 3,  t = w / (1 + r0)            (5)
///
/// Source: own derivation: in the frame of the bond d(turn)/dt = A (w_i - w_j); the frame rotates
///         with (w_i + w_j)/2 - t x (w_i - w_j)/2.
/// Valid:  rotations of i against j below about 2 rad; a real bond would break before.
/// Shapes: Real = double or a SIMD batch, lane = bond.
/// Tests:  tests/bond/strain.cpp (work of the loads, frame indifference, closed forms).
template <class Real>
struct BondStrain {
  Vec3<Real> shift, turn;            // [m], [rad] of i against j
  Vec3<Real> shift_rate, turn_rate;  // [m/s], [rad/s]
  Vec3<Real> normal;                 // [-] unit, along the bond, from j to i
  Vec3<Real> arm_i, arm_j;           // [m] from the centres to the point of the force
  Real r0;                           // [-] (2)
  Vec3<Real> w;                      // [-]
};

/// Loads of a bond on its ends.
template <class Real>
struct BondLoads {
  Vec3<Real> force;               // [N] on i; opposite on j
  Vec3<Real> torque_i, torque_j;  // [N m] about the centres
};

/// Strain of a bond; `like_i`: the axes of j in the reference state, rotated with i since then.
template <class Real>
SILT_INLINE BondStrain<Real> strain_of(const BondRest<Real>& rest, const BondedEnds<Real>& ends,
                                       const BasicQuaternion<Real>& like_i) {
  const Real half(0.5), one(1);
  BasicQuaternion<Real> r = like_i * conjugate(ends.orientation_j);
  // Of the two quaternions of a rotation, the one with the smaller angle.
  const Real sign = select(r.w < Real(0), Real(-1), one);
  BondStrain<Real> s;
  s.r0 = sign * r.w, s.w = r.vector() * sign;
  // Rotated by r, of_j is of_j + 2 r0 w x of_j + 2 w x (w x of_j). sqrt(r) = (1 + r0, w) / sqrt(2
  // (1 + r0)) rotates the normal of j halfway to that of i: of_j + w x of_j + w x (w x of_j) / (1 +
  // r0).
  const Vec3<Real> of_j = rotate(ends.orientation_j, rest.apart);
  const Vec3<Real> once = cross(s.w, of_j), twice = cross(s.w, once);
  const Vec3<Real> more = (once * s.r0 + twice) * Real(2);
  s.normal = (of_j + once + twice * (one / (one + s.r0))) * rest.per_length;
  s.shift = ends.apart - of_j - more * rest.share;
  s.arm_i = (of_j + more) * -rest.share - s.shift * half, s.arm_j = s.arm_i + ends.apart;
  s.turn = s.w * (Real(2.0 / 3) * (Real(4) - s.r0));
  s.shift_rate = ends.velocity + cross(ends.spin_i, s.arm_i) - cross(ends.spin_j, s.arm_j);
  s.turn_rate = ends.spin_i - ends.spin_j;
  return s;
}

template <class Real>
SILT_INLINE BondStrain<Real> strain_of(const BondRest<Real>& rest, const BondedEnds<Real>& ends) {
  return strain_of(rest, ends, ends.orientation_i * conjugate(rest.turn));
}

/// Rates of a strain whose velocities are `ago` [s] older than its positions: with the arms of that
/// time, so that a common rotation gives none, to second order in `ago`. With the arms of now the
/// dashpots of a bond that is swung around would pull at it, to first order.
template <class Real>
SILT_INLINE void take_rates_of(const Real& ago, const BondedEnds<Real>& ends, BondStrain<Real>& s) {
  const Vec3<Real>&w = ends.spin_i, &v = ends.spin_j;
  s.shift_rate = s.shift_rate - (cross(w, cross(w, s.arm_i)) - cross(v, cross(v, s.arm_j))) * ago;
}

/// Loads from a force and a couple on i that follow from the strain (derivatives of an energy), and
/// from those that follow from its rate (dashpots).
template <class Real>
SILT_INLINE BondLoads<Real> loads_of(const BondStrain<Real>& s, const Vec3<Real>& force,
                                     const Vec3<Real>& couple, const Vec3<Real>& rate_force,
                                     const Vec3<Real>& rate_couple) {
  const Real per = Real(1) / (Real(1) + s.r0);
  const Real third(1.0 / 3);
  const Vec3<Real> turned = couple * (third * (Real(4) - s.r0)) +
                            s.w * ((Real(2.0 / 3) * s.r0 - Real(1)) * per * dot(s.w, couple));
  const Vec3<Real> of_frame = cross(cross(s.shift, force), s.w) * (Real(0.5) * per);
  const Vec3<Real> F = force + rate_force, M = turned + of_frame + rate_couple;
  return {F, cross(s.arm_i, F) + M, -cross(s.arm_j, F) - M};
}

}  // namespace silt
