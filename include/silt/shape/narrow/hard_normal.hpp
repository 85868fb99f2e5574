// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/normal_search.hpp>

namespace silt::inline SILT_TARGET {

/// Common normal of one pair, by methods that always converge; for pairs without a last normal, and
/// for those that Newton's method in lanes does not solve.
///
///   least_depth    Newton on the sphere of directions with a positive Hessian and backtracking:
///                  ends in a minimum of F from any start
///   ray_normal     minimum of (h_i(n) + h_j(-n)) over planes n . d = |d|: where a ray from one
///                  centre to the other leaves the sum of the bodies. Convex, with a single
///                  minimum, which is at least |d| exactly where the bodies touch. Also the
///                  direction of the midway point for equal exponents (smallest scale at which
///                  both bodies meet).
///   rounded        either, first for bodies with much more rounded faces, then with less rounding
///                  down to the actual one (continuation)
///
/// Source: convexity of support functions; continuation in place of the homotopy in the exponent of
///         Podlozhnyuk et al., Comput. Part. Mech. 4 (2017) 101.
/// Tests:  tests/shape/super_ellipsoid_contact.cpp.
struct CommonNormal {
  Vec3d direction{0, 0, 1};  // m, from i to j
  double depth = 0;          // [m] F(m); negative: proved apart
  double residual = 0;       // [m] final |grad F|; without meaning when apart
  int evaluations = 0;       // number of evaluations of F
  bool solved = false;       // apart, or the residual is below tolerance * size
};

/// |grad F| over the smaller size below which a contact counts as solved.
inline constexpr double normal_tolerance = 1e-8;

namespace detail {

/// e over the smallest semi-axis.
template <Exponents E, template <class, Exponents> class Form>
double rounding_of(const Form<double, E>& form) {
  const auto &p = form.axes2, m = form.axes2_towards({-1, -1, -1});
  return std::sqrt(form.e2 / std::min({p.x, p.y, p.z, m.x, m.y, m.z}));
}
inline double rounding_of(const SphereForm<double>&) { return 0; }

/// The same body with faces rounded with e of at least `rounding` smallest semi-axes.
template <Exponents E, template <class, Exponents> class Form>
Form<double, E> rounded(Form<double, E> form, double rounding) {
  const double own = rounding_of(form), factor = own > 0 ? std::max(rounding / own, 1.0) : 1;
  form.e2 *= factor * factor;
  form.e_p1 *= std::pow(factor, form.p1), form.e_p2 *= std::pow(factor, form.p2);
  return form;
}
inline SphereForm<double> rounded(SphereForm<double> form, double) { return form; }

template <class FormI, class FormJ>
PosedPair<FormI, FormJ> rounded(const PosedPair<FormI, FormJ>& pair, double rounding) {
  auto out = pair;
  out.i = rounded(pair.i, rounding), out.j = rounded(pair.j, rounding);
  return out;
}

template <class FormI, class FormJ>
double smaller_size(const PosedPair<FormI, FormJ>& pair) {
  return std::min(pair.i.size, pair.j.size);
}

/// Step -|H|^-1 g: Newton's with the eigenvalues of H made positive.
inline std::array<double, 2> downhill_step(const Symmetric2<double>& H, double gs, double gt,
                                           double least) {
  const double mean = 0.5 * (H.xx + H.yy), half = 0.5 * (H.xx - H.yy);
  const double spread = std::hypot(half, H.xy);
  const double angle = 0.5 * std::atan2(H.xy, half), c = std::cos(angle), s = std::sin(angle);
  const double large = std::max(std::abs(mean + spread), least);
  const double small = std::max(std::abs(mean - spread), least);
  const double u = -(c * gs + s * gt) / large, v = -(c * gt - s * gs) / small;
  return {c * u - s * v, s * u + c * v};
}

inline double slope_of(const Depth<double>& D) { return std::hypot(D.slope_s, D.slope_t); }

/// Descends in F from m. Stops where F < 0 if `stop_apart`.
template <class FormI, class FormJ>
CommonNormal least_depth(const PosedPair<FormI, FormJ>& pair, const Vec3d& from, int most,
                         bool stop_apart, double tolerance) {
  const double size = smaller_size(pair);
  CommonNormal at{from};
  auto D = depth_along(pair, from);
  for (at.evaluations = 1;;) {
    at.depth = D.F, at.residual = slope_of(D);
    at.solved = at.residual <= tolerance * size || (stop_apart && D.F < 0);
    if (at.solved || at.evaluations >= most) return at;
    auto step = downhill_step(D.hess, D.slope_s, D.slope_t, 1e-9 * size);
    const double length = std::hypot(step[0], step[1]);
    double part = length > 0.5 ? 0.5 / length : 1;
    for (bool lower = false; !lower; part *= 0.5) {
      const Vec3d m = normalised(at.direction + D.s * (part * step[0]) + D.t * (part * step[1]));
      const auto next = depth_along(pair, m);
      ++at.evaluations;
      // Near the end differences of F are lost in rounding: there a smaller slope is accepted.
      lower = next.F < D.F - 1e-13 * size ||
              (next.F < D.F + 1e-13 * size && slope_of(next) < at.residual);
      if (lower) at.direction = m, D = next;
      if (!lower && part < 1e-10) return at;
      if (at.evaluations >= most) break;
    }
  }
}

/// The plane n . ray = 1 that touches the sum of the bodies nearest on the ray.
template <class FormI, class FormJ>
CommonNormal ray_normal(const PosedPair<FormI, FormJ>& pair, const Vec3d& ray, const Vec3d& from,
                        int most, bool stop_apart, double tolerance) {
  const double size = smaller_size(pair);
  Vec3d u, v;
  tangents(ray, u, v);
  CommonNormal at{from};
  double cosine = dot(at.direction, ray);
  auto D = depth_along(pair, at.direction);
  for (at.evaluations = 1;;) {
    // The point p_i - p_j of the sum, its distance from the ray, and the rotation of the plane.
    const double S = D.i.height + D.j.height;
    const Vec3d p =
        S * at.direction + (D.i.along_s - D.j.along_s) * D.s + (D.i.along_t - D.j.along_t) * D.t;
    const double gu = dot(p, u), gv = dot(p, v), us = dot(u, D.s), ut = dot(u, D.t),
                 vs = dot(v, D.s), vt = dot(v, D.t);
    const Symmetric2<double> T{D.hess.xx + D.F, D.hess.xy, D.hess.yy + D.F};
    const Symmetric2<double> H{
        cosine * T.form(us, ut),
        cosine * (T.xx * us * vs + T.xy * (us * vt + ut * vs) + T.yy * ut * vt),
        cosine * T.form(vs, vt)};
    at.depth = D.F, at.residual = std::hypot(gu, gv);
    at.solved = at.residual <= tolerance * size || (stop_apart && D.F < 0);
    if (at.solved || at.evaluations >= most) return at;
    const auto step = downhill_step(H, gu, gv, 1e-14 * size);
    double part = 1;
    for (bool lower = false; !lower; part *= 0.5) {
      const Vec3d n = at.direction * (1 / cosine) + u * (part * step[0]) + v * (part * step[1]);
      const Vec3d m = normalised(n);
      const auto next = depth_along(pair, m);
      ++at.evaluations;
      const double G = S / cosine, next_G = (next.i.height + next.j.height) / dot(m, ray);
      const Vec3d q = (next.i.along_s - next.j.along_s) * next.s +
                      (next.i.along_t - next.j.along_t) * next.t +
                      (next.i.height + next.j.height) * m;
      lower = next_G < G - 1e-13 * size ||
              (next_G < G + 1e-13 * size && std::hypot(dot(q, u), dot(q, v)) < at.residual);
      if (lower) at.direction = m, D = next, cosine = dot(m, ray);
      if (!lower && part < 1e-12) return at;
      if (at.evaluations >= most) break;
    }
  }
}

/// Calls `search(pair, start, last)` with decreasing rounding of faces; the first calls need no
/// precision.
template <class FormI, class FormJ, class Search>
CommonNormal with_continuation(const PosedPair<FormI, FormJ>& pair, Vec3d start,
                               const Search& search) {
  const double a = rounding_of(pair.i), b = rounding_of(pair.j);
  const double least = a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);  // 0: nothing to round
  int evaluations = 0;
  if (least > 0)
    for (double rounding = 0.3; rounding > 2 * least; rounding *= 0.25) {
      const auto near = search(rounded(pair, rounding), start, false);
      start = near.direction, evaluations += near.evaluations;
    }
  auto found = search(pair, start, true);
  found.evaluations += evaluations;
  return found;
}

}  // namespace detail

/// Where the ray from i's centre to j's leaves the sum of the bodies: decides whether they touch.
template <class FormI, class FormJ>
CommonNormal find_ray_normal(const PosedPair<FormI, FormJ>& pair, bool stop_apart = true) {
  const double distance = norm(pair.between);
  const Vec3d ray =
      distance > 1e-12 * detail::smaller_size(pair) ? pair.between * (1 / distance) : pair.turn_i.z;
  const auto straight = detail::ray_normal(pair, ray, ray, 30, stop_apart, normal_tolerance);
  if (straight.solved) return straight;
  const auto search = [&](const auto& rounded, const Vec3d& start, bool last) {
    return detail::ray_normal(rounded, ray, start, last ? 200 : 40, last && stop_apart,
                              last ? normal_tolerance : 1e-3);
  };
  auto found = detail::with_continuation(pair, ray, search);
  found.evaluations += straight.evaluations;
  return found;
}

/// Common normal near `last`, or of a pair without one if that is zero.
template <class FormI, class FormJ>
CommonNormal find_common_normal(const PosedPair<FormI, FormJ>& pair, const Vec3d& last) {
  CommonNormal best;
  int evaluations = 0;
  if (dot(last, last) > 0) {
    best = detail::least_depth(pair, last, 40, true, normal_tolerance);
    if (best.solved) return best;
    evaluations = best.evaluations;
  }
  const auto out = find_ray_normal(pair);
  evaluations += out.evaluations;
  if (!(out.solved && out.depth < 0)) {
    best = detail::least_depth(pair, out.direction, 60, true, normal_tolerance);
    evaluations += best.evaluations;
    if (!best.solved) {
      const auto search = [&](const auto& rounded, const Vec3d& start, bool end) {
        return detail::least_depth(rounded, start, end ? 300 : 40, end,
                                   end ? normal_tolerance : 1e-3);
      };
      const auto slow = detail::with_continuation(pair, out.direction, search);
      evaluations += slow.evaluations;
      if (slow.solved || slow.residual < best.residual) best = slow;
    }
  } else {
    best = out;
  }
  best.evaluations = evaluations;
  return best;
}

}  // namespace silt
