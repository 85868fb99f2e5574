// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/orientation.hpp>

namespace silt::inline SILT_TARGET {

/// Coefficients of drag, lift and pitching torque fitted to resolved simulations of four bodies:
///
///   C_D = C_D0 + (C_D90 - C_D0) sin^a0,  C_D0 = a1/Re^a2 + a3/Re^a4,  C_D90 = a5/Re^a6 + a7/Re^a8
///   C_L = (b1/Re^b2 + b3/Re^b4) sin^(b5 + b6 Re^b7) cos^(b8 + b9 Re^b10),  C_T likewise with c
///
/// of alpha in [0, pi/2], the angle between the slip and the long direction: the axis of rods, the
/// plane of discs. C_D90 is thus broadside on for both, and C_L of discs is along -e_L of
/// drag/orientation.hpp. The functions below take sine and cosine of the angle between the slip and
/// the axis of symmetry; d is that of equal volume. drag_and_lift() and pitching_torque() compute
/// the forces.
///
/// Source: M. Zastawny, G. Mallouppas, F. Zhao, B. van Wachem, Int. J. Multiphase Flow 39 (2012)
///         227. The print was not read. All coefficients of both ellipsoids are those of a header
///         for Basilisk, "Utility functions for spheroids" (drag_Zastawny2012 and others); those of
///         5 : 4 : 4 are also in a Fortran solver of channel flow (FLUID_TORQUE_ELLIPSOID). Disc
///         and fibre are recalled, unverified; their drag broadside on is within 10 % of Hoelzer
///         and Sommerfeld's law. That the disc's C_D90 is broadside on follows from the exact drag
///         in slow flow: at Re = 0.1 the fit is 0.73 of it edge on and 0.93 broadside on; with the
///         opposite assignment it would be 0.56 and 1.2.
/// Valid:  0.1 < Re < 300; at Re = 0.1 the ellipsoids' drag is 12 to 18 % below the exact value.
/// Shapes: Real = double, float or a pack. Tests: tests/coupling/non_spherical.cpp.
struct Zastawny {
  double a[9], b[10], c[10];
  AxisKind kind;
  double aspect = 1;  // [-] length along the axis over that across it

  template <class Real>
  Real drag_along(const Real& Re) const {
    return terms(a + (is_long() ? 1 : 5), Re);
  }
  template <class Real>
  Real drag_across(const Real& Re) const {
    return terms(a + (is_long() ? 5 : 1), Re);
  }
  template <class Real>
  Real drag(const Real& Re, const Real& sine, const Real& cosine) const {
    const Real C0 = terms(a + 1, Re), C90 = terms(a + 5, Re);
    return C0 + (C90 - C0) * to(is_long() ? sine : cosine, detail::lanes_of<Real>(a[0]));
  }
  /// Along e_L: positive for rods, negative for discs.
  template <class Real>
  Real lift(const Real& Re, const Real& sine, const Real& cosine) const {
    return is_long() ? of_angle(b, Re, sine, cosine) : Real(0) - of_angle(b, Re, cosine, sine);
  }
  template <class Real>
  Real torque(const Real& Re, const Real& sine, const Real& cosine) const {
    return is_long() ? of_angle(c, Re, sine, cosine) : of_angle(c, Re, cosine, sine);
  }

 private:
  constexpr bool is_long() const { return kind == AxisKind::Long; }
  template <class Real>
  static Real to(const Real& x, const Real& y) {
    return select(x > Real(0), power(max(x, smallest<Real>()), y), Real(0));
  }
  template <class Real>
  static Real of_re(const Real& Re, double exponent) {
    return power(detail::guarded(Re), detail::lanes_of<Real>(exponent));
  }
  template <class Real>
  static Real terms(const double* k, const Real& Re) {
    return detail::lanes_of<Real>(k[0]) * of_re(Re, -k[1]) +
           detail::lanes_of<Real>(k[2]) * of_re(Re, -k[3]);
  }
  template <class Real>
  static Real of_angle(const double* k, const Real& Re, const Real& sine, const Real& cosine) {
    using detail::lanes_of;
    return terms(k, Re) *
           to(sine, Real(lanes_of<Real>(k[4]) + lanes_of<Real>(k[5]) * of_re(Re, k[6]))) *
           to(cosine, Real(lanes_of<Real>(k[7]) + lanes_of<Real>(k[8]) * of_re(Re, k[9])));
  }
};

/// Ellipsoid with axes 5 : 2 : 2.
inline constexpr Zastawny zastawny_ellipsoid_5_2{
    {2.0, 5.1, .48, 15.52, 1.05, 24.68, .98, 3.19, .21},
    {6.079, .898, .704, -.028, 1.067, .0025, .818, 1.049, 0, 0},
    {2.078, .279, .372, .018, .98, 0, 0, 1, 0, 0},
    AxisKind::Long,
    2.5};
/// Ellipsoid with axes 5 : 4 : 4.
inline constexpr Zastawny zastawny_ellipsoid_5_4{
    {1.95, 18.12, 1.023, 4.26, .384, 21.52, .99, 2.86, .26},
    {.083, -.21, 1.582, .851, 1.842, -.802, -.006, .874, .009, .57},
    {.935, .146, -.469, .145, .116, .748, .041, .221, .657, .044},
    AxisKind::Long,
    1.25};
/// Disc, an ellipsoid with axes 1 : 5 : 5. Recalled, unverified.
inline constexpr Zastawny zastawny_disc{
    {1.96, 5.82, .44, 15.56, 1.068, 35.41, .96, 3.63, .05},
    {12.111, 1.036, 3.887, .109, .812, .249, -.198, 5.821, -4.717, .007},
    {3.782, .237, 2.351, .236, -.394, 1.615, -.044, -.537, 1.805, -.037},
    AxisKind::Short,
    0.2};
/// Fibre of length 5 diameters. Recalled, unverified.
inline constexpr Zastawny zastawny_fibre{
    {2.12, 20.35, .98, 2.77, .396, 29.14, .97, 3.66, .16},
    {8.652, .815, .407, -.197, .978, .036, .451, 1.359, -.43, .007},
    {.011, -.656, 8.909, .396, 2.926, -1.28, .037, -15.236, 16.757, -.006},
    AxisKind::Long,
    5};

}  // namespace silt
