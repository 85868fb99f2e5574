// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/core/quaternion.hpp>

namespace silt::inline SILT_TARGET {

/// Rotation of rigid bodies: a policy of Simulation for non-spherical particles. A body has an
/// orientation q (body axes to space), principal moments I [kg m2], and an angular momentum L [kg
/// m2/s] in body axes. A step consists of
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

/// Default: free rotation as exact rotations about the body axes 3 2 1 2 3. Second order,
/// symplectic and reversible. The energy error is bounded; the angular momentum in space and the
/// length of q are exact.
/// Source: T. F. Miller et al., J. Chem. Phys. 116 (2002) 8649 (NO_SQUISH).
/// Valid:  bodies of any shape and any rotation within a step.
/// Units:  SI; angular momentum [kg m2/s] in body axes.
/// Errors: none.
/// Tests:  tests/physics/rotation.cpp.
struct NoSquish {
  static constexpr bool is_rotation = true;

  template <class Real>
  static void kick(Vec3<Real>& momentum, const Vec3<Real>& torque, const Vec3<Real>&,
                   const Real& time) {
    momentum += torque * time;
  }
  static void drift(Quaternion& q, Vec3d& momentum, const Vec3d& inertia, double time) {
    double turned[4] = {q.w, q.x, q.y, q.z};
    drift(turned, momentum, inertia, time);
    q = {turned[0], turned[1], turned[2], turned[3]};
  }
  /// The same for q = (w, x, y, z) in lanes. The rotations of one body depend on each other; those
  /// of several bodies run in parallel.
  template <class Real>
  static void drift(Real (&q)[4], Vec3<Real>& L, const Vec3<Real>& inertia, const Real& time) {
    const Real one(1), half = Real(0.5) * time;
    const Vec3<Real> per{one / inertia.x, one / inertia.y, one / inertia.z};
    turn<3>(q, L, half * L.z * per.z);
    turn<2>(q, L, half * L.y * per.y);
    turn<1>(q, L, time * L.x * per.x);
    turn<2>(q, L, half * L.y * per.y);
    turn<3>(q, L, half * L.z * per.z);
  }

 private:
  /// Cosine and sine of half an angle, of unit length to rounding.
  template <class Real>
  struct HalfTurn {
    Real c, s;
    SILT_INLINE explicit HalfTurn(const Real& angle) {
      // By the tangent of a quarter of the angle; the series errs by less than 1e-16.
      const Real one(1), x = Real(0.25) * angle, x2 = x * x;
      const Real t =
          x * (one + x2 * (Real(1.0 / 3) + x2 * (Real(2.0 / 15) + x2 * Real(17.0 / 315))));
      const Real per = one / (one + t * t);
      c = (one - t * t) * per, s = Real(2) * t * per;
      if (any(x2 > Real(0.025 * 0.025))) take_large(angle);
    }

   private:
    /// Lanes with an angle too large for the series.
    void take_large(const Real& angle) {
      constexpr std::size_t W = sizeof(Real) / sizeof(double);
      alignas(64) double angles[W], cosines[W], sines[W];
      store(angles, angle), store(cosines, c), store(sines, s);
      for (std::size_t k = 0; k < W; ++k)
        if (!(std::abs(angles[k]) <= 0.1))
          cosines[k] = std::cos(0.5 * angles[k]), sines[k] = std::sin(0.5 * angles[k]);
      c = load<Real>(cosines), s = load<Real>(sines);
    }
  };
  /// q <- q exp(angle e/2) about axis 1, 2 or 3; the momentum is constant in space and rotates back
  /// in the body.
  template <int axis, class Real>
  static SILT_INLINE void turn(Real (&q)[4], Vec3<Real>& L, const Real& angle) {
    const HalfTurn<Real> h(angle);
    constexpr int i = axis, j = axis % 3 + 1, k = j % 3 + 1;
    const Real w = q[0], qi = q[i], qj = q[j], qk = q[k];
    q[0] = h.c * w - h.s * qi, q[i] = h.c * qi + h.s * w;
    q[j] = h.c * qj + h.s * qk, q[k] = h.c * qk - h.s * qj;
    const Real cosine = h.c * h.c - h.s * h.s, sine = Real(2) * h.c * h.s;
    Real* const l[3] = {&L.x, &L.y, &L.z};
    const Real lj = *l[j - 1], lk = *l[k - 1];
    *l[j - 1] = cosine * lj + sine * lk, *l[k - 1] = cosine * lk - sine * lj;
  }
};

/// SPIRAL: angular velocity by a third-order Runge-Kutta step of Euler's equations, orientation by
/// the exact rotation with it. Second order in the orientation, more accurate than NoSquish at the
/// same step; but the energy of a free body drifts slowly. For dissipative scenes.
/// Source: C. A. del Valle et al., Comput. Phys. Commun. 297 (2024) 109077 (SPIRAL, leapfrog form).
///         Recalled: the print was not read; tests/physics/rotation.cpp confirms its order.
/// Valid:  as NoSquish, in dissipative scenes.
/// Units:  SI; angular momentum [kg m2/s] in body axes.
/// Errors: none.
/// Tests:  tests/physics/rotation.cpp.
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
