// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/super_ellipsoid_cap.hpp>

namespace silt::inline SILT_TARGET {

/// Two placed convex bodies: j's centre is at `between` [m] from i's.
template <class FormI, class FormJ>
struct PosedPair {
  using Real = typename FormI::Real;
  FormI i;
  FormJ j;
  BodyAxes<Real> turn_i, turn_j;
  Vec3<Real> between;
};

template <class FormI, class FormJ, class Real>
PosedPair(const FormI&, const FormJ&, const BodyAxes<Real>&, const BodyAxes<Real>&,
          const Vec3<Real>&) -> PosedPair<FormI, FormJ>;

/// Depth along the direction m (unit, from i to j), and its derivatives with m in its tangent
/// plane:
///
///   F(m) = h_i(m) + h_j(-m) - m . d                                                            (1)
///   grad F = p_i - p_j (their tangential part),  Hess F = T_i + T_j - F 1                      (2)
///
/// F < 0 for any m proves that the bodies are apart. If they touch, the overlap is the minimum of
/// F. There p_i - p_j is along m: force, lever arms and angular momentum are consistent, and -m is
/// the gradient of the overlap with respect to the position of i.
template <class Real>
struct Depth {
  Real F;                 // [m]
  Real slope_s, slope_t;  // [m]
  Symmetric2<Real> hess;  // [m]
  Vec3<Real> s, t;        // tangents, in space
  Cap<Real> i, j;
};

/// F(m) along the direction m, with its slope and curvature.
template <class FormI, class FormJ, class Real = typename FormI::Real>
SILT_INLINE Depth<Real> depth_along(const PosedPair<FormI, FormJ>& pair, const Vec3<Real>& m) {
  Depth<Real> D;
  tangents(m, D.s, D.t);
  const auto &Ri = pair.turn_i, &Rj = pair.turn_j;
  D.i = cap_at(pair.i, Ri.to_body(m), Ri.to_body(D.s), Ri.to_body(D.t));
  D.j = cap_at(pair.j, -Rj.to_body(m), Rj.to_body(D.s), Rj.to_body(D.t));
  D.F = D.i.height + D.j.height - dot(m, pair.between);
  D.slope_s = D.i.along_s - D.j.along_s - dot(D.s, pair.between);
  D.slope_t = D.i.along_t - D.j.along_t - dot(D.t, pair.between);
  D.hess = {D.i.radii.xx + D.j.radii.xx - D.F, D.i.radii.xy + D.j.radii.xy,
            D.i.radii.yy + D.j.radii.yy - D.F};
  return D;
}

/// Newton's step for the smallest depth, with error estimates.
///
/// The error of the normal is the relative change of the radii over the step (pace) times the step.
/// The error of a body's point is its radii times that, plus its own change over the step times its
/// own pace. In the flatter body both are large. The point of the other body is as good for the
/// contact, and its error is used.
template <class Real>
struct NormalStep {
  Real s, t;            // [-] change of m along the tangents
  Mask<Real> downhill;  // the Hessian is positive: the step leads to a minimum
  Real pace;            // [-] largest relative change of the radii
  Real turn_error;      // [-] estimated error of m after the step
  Real residual;        // [m] estimated error of the contact point after the step
  Mask<Real> by_i;      // the point of i is the more accurate one
};

/// Newton's step towards the direction of the smallest F.
template <class Real>
SILT_INLINE NormalStep<Real> newton_step(const Depth<Real>& D) {
  const auto& H = D.hess;
  const Real det = H.xx * H.yy - H.xy * H.xy, trace = H.xx + H.yy;
  const Mask<Real> downhill = (det > Real(1e-12) * trace * trace) && (trace > Real(0));
  const Real over = Real(-1) / select(downhill, det, Real(1));
  const Real s = over * (H.yy * D.slope_s - H.xy * D.slope_t);
  const Real t = over * (H.xx * D.slope_t - H.xy * D.slope_s);
  const Real pace2_i = D.i.pace.form(s, t), pace2_j = D.j.pace.form(s, t), step2 = s * s + t * t;
  const Real pace = sqrt(pace2_i + pace2_j + step2), turn_error = pace * sqrt(step2);
  const auto missed = [&](const Symmetric2<Real>& T, const Real& pace2) {
    const Real us = T.xx * s + T.xy * t, ut = T.xy * s + T.yy * t;
    return sqrt(pace2 * (us * us + ut * ut)) + (T.xx + T.yy) * turn_error;
  };
  const Real i = missed(D.i.radii, pace2_i), j = missed(D.j.radii, pace2_j);
  return {s, t, downhill, pace, Real(2) * turn_error, Real(2) * min(i, j), i < j};
}

/// Radius of curvature [m] for Hertz' law: from the mean curvature, at most the bounding radius
/// (faces), at least 0.05 radii of the sphere of equal volume (edges and corners).
template <class Form, class Real = typename Form::Real>
SILT_INLINE Real contact_radius(const Form& form, const Cap<Real>& cap) {
  const auto& T = cap.radii;
  const Real det = T.xx * T.yy - T.xy * T.xy;
  const Real R = Real(2) * det / max(T.xx + T.yy, smallest<Real>());
  return min(max(R, Real(0.05) * form.size), form.bound);
}

}  // namespace silt
