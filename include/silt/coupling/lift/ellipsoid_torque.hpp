// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/coupling/drag/oriented.hpp>

namespace silt::inline SILT_TARGET {

/// Torque of a sheared and rotating fluid on an ellipsoid, which causes Jeffery's orbits, including
/// the resistance to its rotation. In the principal frame, with semi-axes a, b, c,
///
///   T_x = 16 pi mu/(3 (b^2 beta + c^2 gamma)) [(b^2 - c^2) e_yz + (b^2 + c^2)(w_x/2 - omega_x)]
///   beta = int_0^inf dl/((b^2 + l) sqrt((a^2 + l)(b^2 + l)(c^2 + l))), and so on       (1)
///
/// e rates of strain and w curl [1/s] of the fluid's velocity, omega [rad/s] of the body. (1) is C
/// (omega* - omega), with omega* the rotation without torque. It is integrated exactly over the
/// step with constant C, about each axis: T = (I/dt)(1 - exp(-C dt/I))(omega* - omega), and does
/// not limit the step. Beyond Stokes flow C increases as that of a sphere (rotational_drag() at rho
/// d^2 |omega* - omega|/mu). Bodies other than ellipsoids are replaced by the ellipsoid with their
/// moments and volume; spheres are treated as spheres.
///
/// Source: G. B. Jeffery, Proc. R. Soc. Lond. A 102 (1922) 161.
/// Valid:  (1) for slow flow around the body, rho d^2 |e|/mu << 1. Single bodies.
/// Tests:  tests/coupling/oriented.cpp (period of the orbit).
///
/// Units:  SI.
/// Errors: none.
struct EllipsoidTorque {
  static constexpr bool sees_forms = true, needs_strain = true, needs_spin = true;

  Vec3d torque_on(const InFluid& at) const {
    if (!std::isfinite(at.mass)) return {0, 0, 0};
    static const FormInFlow sphere;
    const FormInFlow& form = at.body ? *at.body : sphere;
    const Quaternion& q = at.orientation;
    const Vec3d e[] = {rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})};
    const auto rate = [&](int i, int j) {  // of strain, in the principal frame
      const Vec3d &s = at.strain, &b = e[j];
      const Vec3d Eb{at.stretch.x * b.x + s.z * b.y + s.y * b.z,
                     s.z * b.x + at.stretch.y * b.y + s.x * b.z,
                     s.y * b.x + s.x * b.y + at.stretch.z * b.z};
      return dot(e[i], Eb);
    };
    const Vec3d spin = 0.5 * at.curl - at.angular_velocity;
    const Vec3d& share = form.strain_share;
    const double Omega[] = {dot(e[0], spin) + share.x * rate(1, 2),
                            dot(e[1], spin) + share.y * rate(2, 0),
                            dot(e[2], spin) + share.z * rate(0, 1)};
    const double d = at.diameter, size = std::hypot(Omega[0], Omega[1], Omega[2]);
    const double more = rotational_drag(at.density * d * d * size / at.viscosity);
    const double stokes = std::numbers::pi * at.viscosity * d * d * d * more;
    const double C[] = {stokes * form.spin_resistance.x, stokes * form.spin_resistance.y,
                        stokes * form.spin_resistance.z};
    const double mr2 = 0.25 * at.mass * d * d;
    const double I[] = {mr2 * form.inertia.x, mr2 * form.inertia.y, mr2 * form.inertia.z};
    Vec3d torque{0, 0, 0};
    for (int k = 0; k < 3; ++k)
      torque += (-std::expm1(-C[k] * at.dt / I[k]) * I[k] / at.dt * Omega[k]) * e[k];
    return torque;
  }
};

static_assert(FluidForce<EllipsoidTorque>);

}  // namespace silt
