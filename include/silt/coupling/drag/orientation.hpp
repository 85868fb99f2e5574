// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/non_spherical.hpp>

namespace silt::inline SILT_TARGET {

/// Drag and lift of a body with an axis of symmetry n (unit vector) at any angle alpha to the slip
/// W, from C_D along the axis (C0) and across it (C90):
///
///   C_D = C0 + (C90 - C0) sin^2 alpha,  C_L = (C90 - C0) sin alpha |cos alpha|                (1)
///   F = (pi/8) rho d^2 |W|^2 (C_D e_W + C_L e_L),  e_L = sgn(n.W) ((n x W) x W)/|.|           (2)
///     = (pi/8) rho d^2 |W| [C90 W - (C90 - C0) (n.W) n]                                        (3)
///
/// (3) is (1) and (2) multiplied out: no angle is needed, and n may have either sign. Exact in
/// Stokes flow, an interpolation beyond. d [m] diameter of the sphere of equal volume.
/// Source: J. Happel, H. Brenner, Low Reynolds Number Hydrodynamics (1965), ch. 5.
/// Shapes: Real = double, float or a pack. Tests: tests/coupling/non_spherical.cpp.
template <class Real>
inline Vec3<Real> axisymmetric_force(const Real& d, const Real& rho, const Vec3<Real>& W,
                                     const Vec3<Real>& n, const Real& C0, const Real& C90) {
  const Real scale = detail::lanes_of<Real>(std::numbers::pi / 8) * rho * d * d * sqrt(dot(W, W));
  return W * (scale * C90) - n * (scale * (C90 - C0) * dot(n, W));
}

/// Direction e_L of (2): normal to W, in the plane of n and W, away from the part of n across W if
/// n.W > 0. 0 if n is along or across W.
template <class Real>
inline Vec3<Real> lift_direction(const Vec3<Real>& n, const Vec3<Real>& W) {
  const Vec3<Real> e = cross(cross(n, W), W);
  const Real length = sqrt(max(dot(e, e), smallest<Real>())), along = dot(n, W);
  const Real none(0);
  return e * (select(along > none, Real(1), select(along < none, Real(-1), none)) / length);
}

/// Drag and lift [N] from given C_D and C_L at this angle.
template <class Real>
inline Vec3<Real> drag_and_lift(const Real& d, const Real& rho, const Vec3<Real>& W,
                                const Vec3<Real>& n, const Real& C_D, const Real& C_L) {
  const Real scale = detail::lanes_of<Real>(std::numbers::pi / 8) * rho * d * d;
  const Real slip2 = dot(W, W);
  return W * (scale * C_D * sqrt(slip2)) + lift_direction(n, W) * (scale * C_L * slip2);
}

/// Which axis turns: both kinds turn the long direction across the flow.
enum class AxisKind { Long, Short };  // rods; discs

/// Pitching torque T = (rho/2) C_T (pi d^3/8) |W|^2 [N m], about sgn(n.W) (W x n) for rods and
/// sgn(n.W) (n x W) for discs.
template <class Real>
inline Vec3<Real> pitching_torque(const Real& d, const Real& rho, const Vec3<Real>& W,
                                  const Vec3<Real>& n, const Real& C_T, AxisKind kind) {
  const Vec3<Real> e = cross(W, n);
  const Real none(0), along = dot(n, W), length = sqrt(max(dot(e, e), smallest<Real>()));
  const Real sign = select(along > none, Real(1), select(along < none, Real(-1), none));
  const Real scale =
      detail::lanes_of<Real>((kind == AxisKind::Long ? 1 : -1) * std::numbers::pi / 16);
  return e * (scale * rho * C_T * d * d * d * dot(W, W) * sign / length);
}

}  // namespace silt
