// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/symmetric3.hpp>
#include <silt/shape/narrow/super_ellipsoids.hpp>

namespace silt::inline SILT_TARGET {

/// Estimated covariance of a contact region of super-ellipsoids across its normal: the width of the
/// contact for friction and damping (SolidContact::spread).
///
/// In a cap of depth d at the point p with the outward normal m, the surface at x from p along the
/// tangent plane is below that plane by (f(p + x) - 1)/|grad f|, with f of super_ellipsoid.hpp.
/// Each axis k contributes a parabola near p, and a power s_k far from it:
///   parabola  x^2 D_k,  D_k = (s_k - 1) m_k p_k/(2 d p_k^2)                                   (1)
///   power     x^2 D_k,  D_k = 1/(a_k^2 e^(2/s_k)),  e = s_k d/(m . p)                          (2)
/// Each reaches the depth d where x^2 D_k = 1. Both are added: D = sum_k (D_k/K_k) n_k n_k^T; for
/// two bodies both D, with the overlap as d. The covariance is the inverse of D in the tangent
/// plane.
///   K_k = (1 - 16/s_k^4) (1 - 1.75/s_k + 1.5/s_k^2)/3                                         (3)
/// The second factor approximates the Beta functions of a cap weighted by its depth within 3 %: 1/6
/// of the half width squared for a paraboloid, 1/3 for a flat square. The first factor leaves round
/// surfaces to rolling models: contacts of ellipsoids count as points, like those of spheres.
/// A face across z has the outline of a super-ellipse with the exponent s2, and the depth falls
/// with the power s1 of the distance from its centre. Where s1 and s2 differ, as in tablets, the
/// covariance of x and y there, exact for a flat face, is
///   K = (1 - 16/s1^4) c(s2) (s1 + 2)/(s1 + 4),
///   c = Gamma(3/s2) Gamma(1 + 2/s2)/(Gamma(1/s2) Gamma(1 + 4/s2))                             (4)
/// with c within 1 % as (1 - 0.312/s2 - 0.376/s2^2)/3: 1/4 for a disc, 1/3 for a square. Between
/// face and side, 1/K is interpolated by the square of the normal's component along z.
/// Accuracy: of the width 7 % at faces with s of at least 4, otherwise a factor of 1.8.
/// Source:  silt's own. Tests: tests/shape/contact_spread.cpp.
template <class Real>
struct Spread {
  Real xx, yy, zz, xy, yz, zx;  // [m2]

  SILT_INLINE Vec3<Real> times(const Vec3<Real>& v) const {
    return {xx * v.x + xy * v.y + zx * v.z, xy * v.x + yy * v.y + yz * v.z,
            zx * v.x + yz * v.y + zz * v.z};
  }
  friend SILT_INLINE Spread operator+(const Spread& a, const Spread& b) {
    return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
  }
};
/// The same numbers as a symmetric tensor.
inline Symmetric3 symmetric(const Spread<double>& s) {
  return {s.xx, s.yy, s.zz, s.xy, s.yz, s.zx};
}

namespace detail {

/// e^(2/s), and the factors of parabola and power over K.
template <class Real>
struct PowerOf {
  Real power, parabola, far;
};
/// (3) without its first factor, by 1/s.
template <class Real>
SILT_INLINE Real share_of_cap(const Real& o) {
  return Real(1.0 / 3) * (Real(1) - Real(1.75) * o + Real(1.5) * o * o);
}
/// (4) without its first factor, by 1/s1 and 1/s2.
template <class Real>
SILT_INLINE Real share_of_face(const Real& o1, const Real& o2) {
  const Real outline = Real(1.0 / 3) * (Real(1) - (Real(0.312) + Real(0.376) * o2) * o2);
  return outline * (Real(1) + Real(2) * o1) / (Real(1) + Real(4) * o1);
}
/// By 1/s; `depth` [-] d/(m . p); `share` K without its first factor.
template <class Real>
SILT_INLINE PowerOf<Real> power_of(const Real& over_s, const Real& depth, const Real& share) {
  const Real one(1), o = over_s, o2 = o * o;
  const Real flat = max(one - Real(16) * o2 * o2, Real(1e-4));
  const Real power = rough_exp2(Real(2) * o * rough_log2(max(depth / o, Real(1e-30))));
  const Real q = one / (share * o * flat);
  return {power, q * (one - o), q * o};
}

/// D [1/m2] of a body at p [m] from its centre, with the outward unit normal m.
template <class Form, class Real = typename Form::Real>
SILT_INLINE Spread<Real> sharpness(const Form& form, const BodyAxes<Real>& axes,
                                   const Vec3<Real>& p_space, const Vec3<Real>& m_space,
                                   const Real& overlap) {
  const Real one(1);
  const Vec3<Real> m = axes.to_body(m_space), p = axes.to_body(p_space);
  const Vec3<Real> a2 = form.axes2_towards(m);
  const Real least = Real(1e-12) * form.size * form.size;
  const Real height = max(dot(m, p), Real(1e-3) * form.size);
  const Real d = max(overlap, Real(1e-12) * form.size), twice = Real(2) * d;
  // 1/s = 1 - 1/p. For x and y: a face across z has s1, others s2.
  const Real over1 = one - form.one_over_p1, depth = d / height;
  const PowerOf<Real> along_z = power_of(over1, depth, share_of_cap(over1));
  PowerOf<Real> across_z = along_z;
  if constexpr (!std::is_same_v<Form, typename Form::template Of<Real, Exponents::Equal>>) {
    const Real over2 = one - form.ratio * form.one_over_p1;
    const Real facing = m.z * m.z, o = over2 + (over1 - over2) * facing;
    const Real side = share_of_cap(o), face = share_of_face(over1, over2);
    across_z = power_of(o, depth, side * face / (face + facing * (side - face)));
  }
  Real top[3], bottom[3];
  const auto of_axis = [&](int k, const PowerOf<Real>& s, const Real& mk, const Real& pk,
                           const Real& square) {
    const Real p2 = pk * pk + least, reach = square * s.power;
    top[k] = s.parabola * max(mk * pk, Real(0)) * reach + s.far * twice * p2;
    bottom[k] = twice * p2 * reach;
  };
  of_axis(0, across_z, m.x, p.x, a2.x), of_axis(1, across_z, m.y, p.y, a2.y),
      of_axis(2, along_z, m.z, p.z, a2.z);
  const Real yz = bottom[1] * bottom[2], over = one / (bottom[0] * yz);
  const Real x = top[0] * yz * over, y = top[1] * bottom[0] * bottom[2] * over,
             z = top[2] * bottom[0] * bottom[1] * over;
  const Vec3<Real>&u = axes.x, &v = axes.y, &w = axes.z;
  const Vec3<Real> xu = x * u, yv = y * v, zw = z * w;
  return {xu.x * u.x + yv.x * v.x + zw.x * w.x, xu.y * u.y + yv.y * v.y + zw.y * w.y,
          xu.z * u.z + yv.z * v.z + zw.z * w.z, xu.x * u.y + yv.x * v.y + zw.x * w.y,
          xu.y * u.z + yv.y * v.z + zw.y * w.z, xu.z * u.x + yv.z * v.x + zw.z * w.x};
}

/// Inverse of D in the plane across n.
template <class Real>
SILT_INLINE Spread<Real> inverse_across(const Spread<Real>& D, const Vec3<Real>& n) {
  Vec3<Real> s, t;
  tangents(n, s, t);
  const Vec3<Real> of_s = D.times(s);
  const Real ss = dot(s, of_s), st = dot(t, of_s), tt = dot(t, D.times(t));
  const Real over = Real(1) / max(ss * tt - st * st, smallest<Real>());
  const Vec3<Real> a = over * (tt * s - st * t), b = over * (ss * t - st * s);
  return {a.x * s.x + b.x * t.x, a.y * s.y + b.y * t.y, a.z * s.z + b.z * t.z,
          a.x * s.y + b.x * t.y, a.y * s.z + b.y * t.z, a.z * s.x + b.z * t.x};
}

}  // namespace detail

/// For two super-ellipsoids.
template <class FormI, class FormJ, class Real = typename FormI::Real>
SILT_INLINE Spread<Real> spread_of(const PosedPair<FormI, FormJ>& pair,
                                   const BodyContact<Real>& found) {
  const Vec3<Real>&n = found.normal, half = (Real(0.5) * found.overlap) * n;
  const auto i = detail::sharpness(pair.i, pair.turn_i, found.point - half, -n, found.overlap);
  const auto j =
      detail::sharpness(pair.j, pair.turn_j, found.point + half - pair.between, n, found.overlap);
  return detail::inverse_across(i + j, n);
}
/// For one and a flat wall, n the wall's normal; `point` [m] from the body's centre.
template <class Form, class Real = typename Form::Real>
SILT_INLINE Spread<Real> spread_of(const Form& form, const BodyAxes<Real>& axes,
                                   const Vec3<Real>& n, const Vec3<Real>& point,
                                   const Real& overlap) {
  const Vec3<Real> p = point - (Real(0.5) * overlap) * n;
  return detail::inverse_across(detail::sharpness(form, axes, p, -n, overlap), n);
}

}  // namespace silt
