// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstring>

#include <silt/core/powers.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/shape/poly_super_ellipsoid.hpp>

namespace silt::inline SILT_TARGET {

/// Surface of a convex body near the point with a given normal n: the height h of the tangent plane
/// above the centre, the position of the point in that plane, and its derivative with the normal.
/// In lanes; with + - * / sqrt, logarithm and power.
///
///   w_k = (a_k n_k)^2 + e^2,  W_k = w_k^(p_k/2)                                                (1)
///   A = W_x + W_y - e^p2,  B = A^(p1/p2) - e^p1 + W_z - e^p1,  h = B^(1/p1)                    (2)
///   l_k = d(ln h)/d n_k = {A^(p1/p2 - 1) or 1} W_k a_k^2 n_k / (w_k B)                         (3)
///   H/h = diag(D) + (1 - p1) l l' + (p1 - p2) B A^(-p1/p2) m m',  m = (l_x, l_y, 0)            (4)
///   D_k = {...} W_k a_k^2 (p - 1 + (2 - p) e^2/w_k) / (w_k B)
///
/// With e = 0 this is the closed form of super_ellipsoid.hpp. There a face with s > 2 has no radius
/// of curvature: all its points have nearly the same normal, and a rotation of 1e-12 moves the
/// contact across the face. With e = smallest semi-axis * face_rounding^(1/p) the radius in the
/// middle of a face is about a face_rounding^((p-2)/p): 100 a at s = 4, 1000 a at 8, 6000 a at 40,
/// and everything is smooth. The body shrinks by less than 3 face_rounding smallest semi-axes; an
/// ellipsoid not at all.
///
/// The matrix of radii T (its eigenvalues are the principal radii of curvature) is, in the tangent
/// plane, H - (h l . n - h) 1: the Hessian of h extended homogeneously of degree one.
/// Tests:  tests/shape/super_ellipsoid_contact.cpp.

/// Exponents of the bodies of a block: all 2, and equal axes; all 2; s1 = s2; any. Chosen at
/// compile time.
enum class Exponents { Ball, Two, Equal, Any };

/// A super-ellipsoid for the kernels: plain Reals.
template <class R, Exponents E = Exponents::Any>
struct SuperForm {
  using Real = R;
  template <class Other>
  using With = SuperForm<Other, E>;
  template <class Other, Exponents Kernel>
  using Of = SuperForm<Other, Kernel>;
  Vec3<R> axes2;  // [m2] a^2, b^2, c^2
  R e2;           // [m2] e^2
  R p1, p2;       // [-] dual exponents s/(s - 1)
  R e_p1, e_p2;   // e^p1, e^p2
  R ratio;        // [-] p1/p2
  R one_over_p1;  // [-]
  R size;         // [m] radius of the sphere of equal volume
  R bound;        // [m] bounding radius

  SILT_INLINE Vec3<R> axes2_towards(const Vec3<R>&) const { return axes2; }
};

/// A poly-super-ellipsoid.
template <class R, Exponents E = Exponents::Any>
struct PolyForm : SuperForm<R, E> {
  template <class Other>
  using With = PolyForm<Other, E>;
  template <class Other, Exponents Kernel>
  using Of = PolyForm<Other, Kernel>;
  Vec3<R> minus2;  // [m2] of the sides towards -x, -y, -z; axes2 has the others

  SILT_INLINE Vec3<R> axes2_towards(const Vec3<R>& n) const {
    return {select(n.x < R(0), minus2.x, this->axes2.x),
            select(n.y < R(0), minus2.y, this->axes2.y),
            select(n.z < R(0), minus2.z, this->axes2.z)};
  }
};

/// A sphere as a partner.
template <class R>
struct SphereForm {
  using Real = R;
  template <class Other>
  using With = SphereForm<Other>;
  R size;   // [m] radius
  R bound;  // [m] the same
};

namespace detail {

inline SuperForm<double> super_form(const Vec3d& axes, double smallest, double s1, double s2,
                                    double face_rounding) {
  const double p1 = s1 / (s1 - 1), p2 = s2 / (s2 - 1);
  // Also at s = 2, where e cancels: w must not be 0 for a normal in one of the body's planes.
  const double e = smallest * std::pow(face_rounding, 1 / std::min(p1, p2));
  return {{axes.x * axes.x, axes.y * axes.y, axes.z * axes.z},
          e * e,
          p1,
          p2,
          std::pow(e, p1),
          std::pow(e, p2),
          p1 / p2,
          1 / p1,
          0,
          0};
}

}  // namespace detail

inline SuperForm<double> form_of(const SuperEllipsoid& shape) {
  auto form = detail::super_form({shape.a, shape.b, shape.c}, shape.smallest_axis(), shape.s1,
                                 shape.s2, shape.face_rounding);
  form.size = shape.equal_volume_radius(), form.bound = shape.bounding_radius();
  return form;
}

inline PolyForm<double> form_of(const PolySuperEllipsoid& shape) {
  const Vec3d &p = shape.plus, &m = shape.minus;
  PolyForm<double> form{detail::super_form(p, shape.smallest_octant().smallest_axis(), shape.s1,
                                           shape.s2, shape.face_rounding),
                        {m.x * m.x, m.y * m.y, m.z * m.z}};
  form.size = shape.equal_volume_radius(), form.bound = shape.bounding_radius();
  return form;
}

/// A sphere as a form of the search.
inline SphereForm<double> sphere_form(double radius) { return {radius, radius}; }

/// Kernel for a super-ellipsoid with these exponents.
inline Exponents exponents_of(double s1, double s2) {
  return s1 != s2 ? Exponents::Any : s1 == 2 ? Exponents::Two : Exponents::Equal;
}
inline Exponents exponents_of(const SuperEllipsoid& shape) {
  const Exponents e = exponents_of(shape.s1, shape.s2);
  return e == Exponents::Two && shape.a == shape.b && shape.b == shape.c ? Exponents::Ball : e;
}

/// Converts a plain struct of Reals to another of the same order: one lane of packs, or one value
/// in all lanes. (Forms, rotations, memories.)
template <class To, class From>
inline To one_lane(const From& from, std::size_t lane) {
  constexpr std::size_t n = sizeof(To) / sizeof(double), W = sizeof(From) / sizeof(To);
  static_assert(sizeof(From) == W * sizeof(To));
  double all[n * W], one[n];
  std::memcpy(all, static_cast<const void*>(&from), sizeof all);
  for (std::size_t k = 0; k < n; ++k) one[k] = all[k * W + lane];
  To to;
  std::memcpy(static_cast<void*>(&to), one, sizeof to);
  return to;
}
/// Sets one lane of an aggregate of packs.
template <class To, class From>
inline void set_lane(To& to, const From& from, std::size_t lane) {
  constexpr std::size_t n = sizeof(From) / sizeof(double), W = sizeof(To) / sizeof(From);
  static_assert(sizeof(To) == W * sizeof(From));
  double all[n * W], one[n];
  std::memcpy(all, static_cast<const void*>(&to), sizeof all);
  std::memcpy(one, static_cast<const void*>(&from), sizeof one);
  for (std::size_t k = 0; k < n; ++k) all[k * W + lane] = one[k];
  std::memcpy(static_cast<void*>(&to), all, sizeof to);
}
/// The same numbers in all lanes.
template <class To, class From>
inline To in_all_lanes(const From& from) {
  To to;
  for (std::size_t k = 0; k < sizeof(To) / sizeof(From); ++k) set_lane(to, from, k);
  return to;
}

/// Orientation: the body's axes in space.
template <class Real>
struct BodyAxes {
  Vec3<Real> x, y, z;

  SILT_INLINE Vec3<Real> to_body(const Vec3<Real>& v) const {
    return {dot(x, v), dot(y, v), dot(z, v)};
  }
  SILT_INLINE Vec3<Real> to_space(const Vec3<Real>& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// From a unit quaternion w + (x, y, z).
template <class Real>
SILT_INLINE BodyAxes<Real> body_axes(const Real& w, const Real& x, const Real& y, const Real& z) {
  const Real two(2), one(1);
  return {{one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)},
          {two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)},
          {two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)}};
}
inline BodyAxes<double> body_axes(const Quaternion& q) {
  return body_axes<double>(q.w, q.x, q.y, q.z);
}

/// A symmetric 2 x 2 matrix in the tangent plane.
template <class Real>
struct Symmetric2 {
  Real xx, xy, yy;

  SILT_INLINE Real form(const Real& u, const Real& v) const {
    return xx * u * u + Real(2) * xy * u * v + yy * v * v;
  }
};

/// Two unit vectors that form a right-handed frame with unit m.
/// Source: T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1.
template <class Real>
SILT_INLINE void tangents(const Vec3<Real>& m, Vec3<Real>& s, Vec3<Real>& t) {
  const Real sign = select(m.z < Real(0), Real(-1), Real(1));
  const Real a = Real(-1) / (sign + m.z), b = m.x * m.y * a;
  s = {Real(1) + sign * m.x * m.x * a, sign * b, -(sign * m.x)};
  t = {b, sign + m.y * m.y * a, -m.y};
}

template <class Real>
SILT_INLINE Vec3<Real> unit(const Vec3<Real>& v) {
  return v * (Real(1) / sqrt(dot(v, v)));
}

/// The surface near the point with normal n; s, t span the tangent plane.
template <class Real>
struct Cap {
  Real height;             // [m] h
  Real along_s, along_t;   // [m] position of the point in the plane
  Symmetric2<Real> radii;  // [m] T
  Symmetric2<Real>
      pace;  // [-] relative change of w_k with the normal, squared: sum a_k^2/w_k dn_k^2
};

namespace detail {

/// a . b with weights.
template <class Real>
SILT_INLINE Real weighted(const Vec3<Real>& w, const Vec3<Real>& a, const Vec3<Real>& b) {
  return w.x * a.x * b.x + w.y * a.y * b.y + w.z * a.z * b.z;
}
template <class Real>
SILT_INLINE Symmetric2<Real> weighted_squares(const Vec3<Real>& w, const Vec3<Real>& s,
                                              const Vec3<Real>& t) {
  const Vec3<Real> ws{w.x * s.x, w.y * s.y, w.z * s.z};
  return {dot(ws, s), dot(ws, t), weighted(w, t, t)};
}

/// Gradient and Hessian of h: hl = h l, hD = h D, `all` and `plane` the factors of l l' and m m'
/// in (4), divided by h.
template <class Real>
struct Height {
  Real h;
  Vec3<Real> hl, hD, a2_over_w;
  Real all, plane;
};

template <class Real>
SILT_INLINE Vec3<Real> times(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// w^(p/2 - 1).
template <class Real>
SILT_INLINE Real less_two(const Real& w, const Real& p) {
  return exact_exp2((Real(0.5) * p - Real(1)) * exact_log2(w));
}

template <class Form, class Real>
SILT_INLINE Height<Real> ellipsoid_height(const Form& f, const Vec3<Real>& n) {
  const Vec3<Real> a2 = f.axes2_towards(n), a2n = times(a2, n);
  const Real w = dot(a2n, n), h = sqrt(w), over_h = Real(1) / h;
  const Vec3<Real> hD = a2 * over_h;
  return {h, a2n * over_h, hD, a2 * (over_h * over_h), -over_h, Real(0)};
}

template <class Form, class Real>
SILT_INLINE Height<Real> equal_height(const Form& f, const Vec3<Real>& n) {
  const Vec3<Real> a2 = f.axes2_towards(n), a2n = times(a2, n), e2{f.e2, f.e2, f.e2};
  const Vec3<Real> w = times(a2n, n) + e2;
  const Vec3<Real> V{less_two(w.x, f.p1), less_two(w.y, f.p1), less_two(w.z, f.p1)};
  const Real B = max(dot(V, w) - Real(3) * f.e_p1, smallest<Real>());
  const Real h_B = exact_exp2((f.one_over_p1 - Real(1)) * exact_log2(B)), h = h_B * B;
  const Vec3<Real> hV = V * h_B, over{Real(1) / w.x, Real(1) / w.y, Real(1) / w.z};
  const Real p = f.p1 - Real(1), q = (Real(2) - f.p1) * f.e2;
  const Vec3<Real> curve{p + q * over.x, p + q * over.y, p + q * over.z};
  return {h, times(hV, a2n), times(times(hV, a2), curve), times(a2, over), -p / h, Real(0)};
}

template <class Form, class Real>
SILT_INLINE Height<Real> any_height(const Form& f, const Vec3<Real>& n) {
  const Vec3<Real> a2 = f.axes2_towards(n), a2n = times(a2, n), e2{f.e2, f.e2, f.e2};
  const Vec3<Real> w = times(a2n, n) + e2;
  Vec3<Real> V{less_two(w.x, f.p2), less_two(w.y, f.p2), less_two(w.z, f.p1)};
  const Real A = max(V.x * w.x + V.y * w.y - f.e_p2, smallest<Real>());
  const Real A_less = exact_exp2((f.ratio - Real(1)) * exact_log2(A)), A_r = A_less * A;
  const Real B = max(A_r + V.z * w.z - Real(2) * f.e_p1, smallest<Real>());
  const Real h_B = exact_exp2((f.one_over_p1 - Real(1)) * exact_log2(B)), h = h_B * B;
  V.x = V.x * A_less, V.y = V.y * A_less;
  const Vec3<Real> hV = V * h_B, over{Real(1) / w.x, Real(1) / w.y, Real(1) / w.z};
  const Real p1 = f.p1 - Real(1), p2 = f.p2 - Real(1);
  const Real q1 = (Real(1) - p1) * f.e2, q2 = (Real(1) - p2) * f.e2;
  const Vec3<Real> curve{p2 + q2 * over.x, p2 + q2 * over.y, p1 + q1 * over.z};
  return {h,       times(hV, a2n),           times(times(hV, a2), curve), times(a2, over),
          -p1 / h, (p1 - p2) * B / (A_r * h)};
}

template <class Form, Exponents E, class Real>
SILT_INLINE Height<Real> height_with(const Form& f, const Vec3<Real>& n) {
  if constexpr (E == Exponents::Two)
    return ellipsoid_height(f, n);
  else if constexpr (E == Exponents::Equal)
    return equal_height(f, n);
  else
    return any_height(f, n);
}

}  // namespace detail

/// The cap of a body at unit normal n, tangents s, t; all in its own axes.
template <class Real, Exponents E, template <class, Exponents> class Form>
SILT_INLINE Cap<Real> cap_at(const Form<Real, E>& form, const Vec3<Real>& n, const Vec3<Real>& s,
                             const Vec3<Real>& t) {
  if constexpr (E == Exponents::Ball) {
    const Real zero(0), one(1);
    return {form.bound, zero, zero, {form.bound, zero, form.bound}, {one, zero, one}};
  }
  const auto at = detail::height_with<Form<Real, E>, E>(form, n);
  const Real ls = dot(at.hl, s), lt = dot(at.hl, t), rest = at.h - dot(at.hl, n);
  auto radii = detail::weighted_squares(at.hD, s, t);
  radii.xx = radii.xx + at.all * ls * ls + rest;
  radii.xy = radii.xy + at.all * ls * lt;
  radii.yy = radii.yy + at.all * lt * lt + rest;
  if constexpr (E == Exponents::Any) {
    const Real ms = at.hl.x * s.x + at.hl.y * s.y, mt = at.hl.x * t.x + at.hl.y * t.y;
    radii.xx = radii.xx + at.plane * ms * ms;
    radii.xy = radii.xy + at.plane * ms * mt;
    radii.yy = radii.yy + at.plane * mt * mt;
  }
  return {at.h, ls, lt, radii, detail::weighted_squares(at.a2_over_w, s, t)};
}
template <class Real>
SILT_INLINE Cap<Real> cap_at(const SphereForm<Real>& form, const Vec3<Real>&, const Vec3<Real>&,
                             const Vec3<Real>&) {
  const Real zero(0), one(1);
  return {form.size, zero, zero, {form.size, zero, form.size}, {one, zero, one}};
}

/// Point of the (rounded) body with the outward unit normal n; in its own axes.
template <class Form>
inline Vec3d support_of(const Form& form, const Vec3d& n) {
  Vec3d s, t;
  tangents(n, s, t);
  const auto cap = cap_at(form, n, s, t);
  return n * cap.height + s * cap.along_s + t * cap.along_t;
}

/// Only h(n), to 1e-6 of the body, by rough powers: for separation tests.
template <class Real, Exponents E, template <class, Exponents> class Form>
SILT_INLINE Real rough_height(const Form<Real, E>& f, const Vec3<Real>& n) {
  if constexpr (E == Exponents::Ball) return f.bound;
  const Vec3<Real> a2 = f.axes2_towards(n);
  const Vec3<Real> w = detail::times(detail::times(a2, n), n) + Vec3<Real>{f.e2, f.e2, f.e2};
  const auto power = [](const Real& x, const Real& y) { return rough_exp2(y * rough_log2(x)); };
  if constexpr (E == Exponents::Two) {
    return sqrt(w.x + w.y + w.z);
  } else {
    const Real half1 = Real(0.5) * f.p1, half2 = Real(0.5) * f.p2;
    Real A = power(w.x, half2) + power(w.y, half2) - f.e_p2;
    if constexpr (E == Exponents::Any) A = power(max(A, smallest<Real>()), f.ratio);
    const Real B = A + power(w.z, half1) - Real(2) * f.e_p1;
    return power(max(B, smallest<Real>()), f.one_over_p1);
  }
}
template <class Real>
SILT_INLINE Real rough_height(const SphereForm<Real>& form, const Vec3<Real>&) {
  return form.size;
}

}  // namespace silt
