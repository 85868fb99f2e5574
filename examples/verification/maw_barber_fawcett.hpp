// silt - BSD-3-Clause, see LICENSE
#pragma once

namespace verification {

/// Elastic oblique impact with friction in a contact circle that sticks in one part and slips in
/// the other. A law with a single tangential spring cannot represent this: a reference for spring
/// laws.
///
/// The normal motion is Hertz'. At each instant the shear traction is a sum of Hertz-like
/// tractions,
///   q(r) = sum_i q_i sqrt(1 - r^2/a_i^2), r < a_i,
/// on circles a_i = i h, the last one equal to the contact circle. Each displaces the surface (mean
/// over the direction) by
///   u(r) = pi q_i (2 a_i^2 - r^2)/(16 G* a_i)                                        r < a_i  (1)
///   u(r) = q_i [(2 a_i^2 - r^2) asin(a_i/r) + a_i sqrt(r^2 - a_i^2)]/(8 G* a_i)      r > a_i
/// In the middle of each ring there is either stick, du = dx, the relative displacement of the
/// bodies in this instant, or slip, |q| = mu p, against q. The bodies move by the sum of q. The
/// only material parameter is S_t/S_n = 4 G*/E*; friction only scales the speeds.
///
/// Source: N. Maw, J. R. Barber, J. N. Fawcett, Wear 38 (1976) 101; (1) after R. D. Mindlin, J.
///         Appl. Mech. 16 (1949) 259, K. L. Johnson, Contact Mechanics (1985), section 3.7.
/// Valid:  solid spheres, restitution 1, quasi-static elasticity, no coupling of normal and
///         tangential tractions (like bodies; for unlike ones neglected).
/// Checks: from v_s/(mu v_n) = 7 - E*/(4 G*) on there is slip throughout, and the loss is 7,
///         exactly; below, 40 rings are within 0.001 of 80.
///
/// `incidence` = v_s/(mu v_n) >= 0 before the impact; returns that after it.
double maw_barber_fawcett(double stiffness_ratio, double incidence, int rings = 40);

}  // namespace verification
