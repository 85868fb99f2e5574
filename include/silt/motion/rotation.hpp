// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET {

/// How rigid bodies turn: a policy of Simulation for particles that are no spheres. A body has an
/// orientation q (body axes to space), principal moments I [kg m2], and an angular momentum L
/// [kg m2/s] in body axes. A step is
///   kick(L, T, I, time)       by the torque T [N m] in body axes
///   drift(q, L, I, time)      without torque
/// Tests: tests/physics/rotation.cpp.
template <class R>
concept RotationIntegrator = requires(Quaternion q, Vec3d momentum, const Vec3d torque,
                                      const Vec3d inertia) {
  requires R::is_rotation;
  R::kick(momentum, torque, inertia, 0.0);
  R::drift(q, momentum, inertia, 0.0);
};

/// The default: free motion as exact turns about the body axes 3 2 1 2 3. Second order, symplectic
/// and reversible; energy errs by a bounded amount, the angular momentum in space and the length of
/// q not at all.
/// Source: T. F. Miller et al., J. Chem. Phys. 116 (2002) 8649 (NO_SQUISH).
struct NoSquish {
  static constexpr bool is_rotation = true;

  static void kick(Vec3d& momentum, const Vec3d& torque, const Vec3d&, double time) {
    momentum += torque * time;
  }
  static void drift(Quaternion& q, Vec3d& momentum, const Vec3d& inertia, double time) {
    const double half = 0.5 * time;
    about_z(q, momentum, half * momentum.z / inertia.z);
    about_y(q, momentum, half * momentum.y / inertia.y);
    about_x(q, momentum, time * momentum.x / inertia.x);
    about_y(q, momentum, half * momentum.y / inertia.y);
    about_z(q, momentum, half * momentum.z / inertia.z);
  }

 private:
  /// Cosine and sine of half an angle, of unit length to rounding.
  struct HalfTurn {
    double c, s;
    explicit HalfTurn(double angle) {
      if (std::abs(angle) > 0.1) {
        c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
        return;
      }
      // By the tangent of a quarter of the angle; its series errs by less than 1e-16.
      const double x = 0.25 * angle, x2 = x * x;
      const double t = x * (1 + x2 * (1.0 / 3 + x2 * (2.0 / 15 + x2 * (17.0 / 315))));
      const double per = 1 / (1 + t * t);
      c = (1 - t * t) * per, s = 2 * t * per;
    }
    double cosine() const { return c * c - s * s; }
    double sine() const { return 2 * c * s; }
  };
  // q <- q exp(angle e/2); the momentum stays in space, so that it turns back in the body.
  static void about_x(Quaternion& q, Vec3d& m, double angle) {
    const HalfTurn h(angle);
    q = {h.c * q.w - h.s * q.x, h.c * q.x + h.s * q.w, h.c * q.y + h.s * q.z,
         h.c * q.z - h.s * q.y};
    m = {m.x, h.cosine() * m.y + h.sine() * m.z, h.cosine() * m.z - h.sine() * m.y};
  }
  static void about_y(Quaternion& q, Vec3d& m, double angle) {
    const HalfTurn h(angle);
    q = {h.c * q.w - h.s * q.y, h.c * q.x - h.s * q.z, h.c * q.y + h.s * q.w,
         h.c * q.z + h.s * q.x};
    m = {h.cosine() * m.x - h.sine() * m.z, m.y, h.cosine() * m.z + h.sine() * m.x};
  }
  static void about_z(Quaternion& q, Vec3d& m, double angle) {
    const HalfTurn h(angle);
    q = {h.c * q.w - h.s * q.z, h.c * q.x + h.s * q.y, h.c * q.y - h.s * q.x,
         h.c * q.z + h.s * q.w};
    m = {h.cosine() * m.x + h.sine() * m.y, h.cosine() * m.y - h.sine() * m.x, m.z};
  }
};

/// Angular velocity by a third-order Runge-Kutta step of Euler's equations, orientation by the
/// exact turn that it makes. Second order in the orientation, more accurate than NoSquish at the
/// same step; but the energy of a free body slowly drifts. For scenes that dissipate.
/// Source: C. A. del Valle et al., Comput. Phys. Commun. 297 (2024) 109077 (SPIRAL, leapfrog form).
struct Spiral {
  static constexpr bool is_rotation = true;

  static void kick(Vec3d& momentum, const Vec3d& torque, const Vec3d& inertia, double time) {
    const auto rate = [&](const Vec3d& w) {  // [rad/s2] times time
      const Vec3d l{inertia.x * w.x, inertia.y * w.y, inertia.z * w.z};
      return over(torque - cross(w, l), inertia) * time;
    };
    const Vec3d w = over(momentum, inertia);
    const Vec3d a = rate(w), b = rate(w + a), c = rate(w + 0.25 * (a + b));
    const Vec3d next = w + (1.0 / 6) * (a + b + 4.0 * c);
    momentum = {inertia.x * next.x, inertia.y * next.y, inertia.z * next.z};
  }
  static void drift(Quaternion& q, Vec3d& momentum, const Vec3d& inertia, double time) {
    const Vec3d w = over(momentum, inertia);
    const double rate = norm(w);
    if (rate > 0) q = q * rotation_about(w * (1 / rate), rate * time);
  }

 private:
  static Vec3d over(const Vec3d& a, const Vec3d& b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
};

static_assert(RotationIntegrator<NoSquish> && RotationIntegrator<Spiral>);

}  // namespace silt
