// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/penetration.hpp>
#include <silt/shape/narrow/placed.hpp>
#include <silt/shape/narrow/super_ellipsoids.hpp>

namespace silt::inline SILT_TARGET {

/// Common normal of a smooth convex body and a polyhedron: the smallest depth over all directions m
/// from the smooth body to the polyhedron. The corners of the latter are at c_v from the smooth
/// body's centre; it is dilated by r,
///
///   F(m) = h(m) + r - min_v m . c_v                                                            (1)
///
/// the maximum of as many smooth functions as there are corners. With n = m + s, s in the tangent
/// plane, all are linear in s except h, which is common to all. A step is the minimum of
///
///   1/2 s.H s + max_v (a_v + g_v . s),  a_v = h - m . c_v,  g_v = (grad h - c_v) in the plane  (2)
///
/// H = T - (F - r) 1 (normal_search.hpp), with its eigenvalues made positive (along an edge H
/// itself, if it is positive there). The minimum is determined by one corner (a vertex touches:
/// Newton's step), two (an edge: the normal stays across it), or three (a face: the normal is the
/// face's). They are found like the nearest simplex in GJK, by adding the corner that protrudes
/// most and removing those without weight; sum_v weight_v c_v is the point of the polyhedron. Near
/// the end a step is exact for edges and faces, and of second order where the normal is free;
/// before, F must decrease (backtracking).
///
/// Ends in a local minimum. It is the only one if the cores are apart or the overlap is smaller
/// than the smallest radius of curvature of the smooth body.
/// Tests:  tests/shape/solid_pairs.cpp.
struct CornerNormal {
  Vec3d direction{0, 0, 1};   // m, in the axes of the polyhedron
  double depth = 0;           // [m] F(m); negative: proved apart
  Vec3d corner{0, 0, 0};      // [m] point of the core, in the axes of the polyhedron
  int held = 0;               // 1: by a vertex; 2: by an edge; 3: by a face
  int evaluations = 0;        // number of evaluations of F
  bool settled = false;       // minimum reached within point_tolerance and turn_tolerance, or apart
  double contact_radius = 0;  // [m] of the smooth body there
};

namespace detail {

/// a_v + g_v . s of (2), and the corner in the axes of the polyhedron.
struct LinearCorner {
  double a, gs, gt;
  Vec3d at;

  double value(double s, double t) const { return a + gs * s + gt * t; }
};

/// Minimum of (2) over some corners: the corners that determine it, and their weights.
struct HeldStep {
  LinearCorner by[3];
  double weight[3] = {1, 0, 0};
  int size = 0;
  double s = 0, t = 0;
  double value = -std::numeric_limits<double>::infinity();  // [m] of (2)

  double level() const { return by[0].value(s, t); }  // [m] max_v (...)
  Vec3d corner() const {
    Vec3d q = weight[0] * by[0].at;
    for (int k = 1; k < size; ++k) q += weight[k] * by[k].at;
    return q;
  }
};

/// (2) on the smallest sets of corners. Each is a lower bound of the minimum over all corners if
/// its weights are positive; the largest counts.
class HeldStepSearch {
 public:
  explicit HeldStepSearch(const Symmetric2<double>& H) : H_(H) {
    const double scale = 1 / (H.xx * H.yy - H.xy * H.xy);
    inverse_ = {scale * H.yy, -scale * H.xy, scale * H.xx};
  }
  const HeldStep& best() const { return best_; }

  /// With the corners that determine it and one more; false if that leads no higher.
  bool add(const LinearCorner& c) {
    const HeldStep before = best_;
    const auto* by = before.by;
    of_one(c);
    for (int k = 0; k < before.size; ++k) of_two(c, by[k]);
    for (int k = 1; k < before.size; ++k)
      for (int l = 0; l < k; ++l) of_three(c, by[k], by[l]);
    return best_.value > before.value;
  }

 private:
  void keep(HeldStep step, double level) {
    step.value = 0.5 * H_.form(step.s, step.t) + level;
    if (step.value > best_.value) best_ = step;
  }
  void move_against(HeldStep& step, double gs, double gt) const {
    step.s = -(inverse_.xx * gs + inverse_.xy * gt),
    step.t = -(inverse_.xy * gs + inverse_.yy * gt);
  }
  void of_one(const LinearCorner& u) {
    HeldStep step;
    step.by[0] = u, step.size = 1;
    move_against(step, u.gs, u.gt);
    keep(step, u.value(step.s, step.t));
  }
  void of_two(const LinearCorner& u, const LinearCorner& v) {
    const double es = v.gs - u.gs, et = v.gt - u.gt, square = inverse_.form(es, et);
    HeldStep step;
    move_against(step, es, et);  // s.g below: -e H^-1 g
    const double part = (v.a - u.a + step.s * u.gs + step.t * u.gt) / square;
    if (!(part > 0 && part < 1)) return;
    step.by[0] = u, step.by[1] = v, step.size = 2;
    step.weight[0] = 1 - part, step.weight[1] = part;
    move_against(step, u.gs + part * es, u.gt + part * et);
    keep(step, u.value(step.s, step.t));
  }
  void of_three(const LinearCorner& u, const LinearCorner& v, const LinearCorner& w) {
    const double es = v.gs - u.gs, et = v.gt - u.gt, fs = w.gs - u.gs, ft = w.gt - u.gt;
    const double area = es * ft - et * fs;
    if (!(std::abs(area) > 1e-13 * (es * es + et * et + fs * fs + ft * ft))) return;
    HeldStep step;
    const double e = u.a - v.a, f = u.a - w.a;
    step.s = (e * ft - f * et) / area, step.t = (es * f - fs * e) / area;
    const double gs = -(H_.xx * step.s + H_.xy * step.t) - u.gs;
    const double gt = -(H_.xy * step.s + H_.yy * step.t) - u.gt;
    const double of_v = (gs * ft - gt * fs) / area, of_w = (es * gt - et * gs) / area;
    if (!(of_v > 0 && of_w > 0 && of_v + of_w < 1)) return;
    step.by[0] = u, step.by[1] = v, step.by[2] = w, step.size = 3;
    step.weight[0] = 1 - of_v - of_w, step.weight[1] = of_v, step.weight[2] = of_w;
    keep(step, u.value(step.s, step.t));
  }

  Symmetric2<double> H_, inverse_;
  HeldStep best_;
};

/// The matrix with the absolute values of its eigenvalues, at least `least`.
inline Symmetric2<double> made_positive(const Symmetric2<double>& H, double least) {
  const double det = H.xx * H.yy - H.xy * H.xy, trace = H.xx + H.yy;
  if (trace > 0 && det > least * trace) return H;
  const double mean = 0.5 * trace, half = 0.5 * (H.xx - H.yy), spread = std::hypot(half, H.xy);
  const double large = std::max(std::abs(mean + spread), least),
               small = std::max(std::abs(mean - spread), least);
  const double c = spread > 0 ? half / spread : 1, s = spread > 0 ? H.xy / spread : 0;
  const double middle = 0.5 * (large + small), off = 0.5 * (large - small);
  return {middle + off * c, off * s, middle - off * c};
}

/// Step along an edge with H itself, which is positive there though not in all directions; false if
/// an end of the edge determines it.
inline bool along_edge(const Symmetric2<double>& H, HeldStep& step) {
  const auto &u = step.by[0], &v = step.by[1];
  const double es = v.gs - u.gs, et = v.gt - u.gt, square = es * es + et * et;
  const double across = (u.a - v.a) / square, curve = H.form(-et, es);
  if (!(curve > 0)) return false;
  const auto slope = [&](double s, double t) {  // grad of (2) in the direction u
    return std::array{H.xx * s + H.xy * t + u.gs, H.xy * s + H.yy * t + u.gt};
  };
  const auto before = slope(across * es, across * et);
  const double along = (before[0] * et - before[1] * es) / curve;
  const double s = across * es - along * et, t = across * et + along * es;
  const auto after = slope(s, t);
  const double part = -(after[0] * es + after[1] * et) / square;
  if (!(part > 0 && part < 1)) return false;
  step.s = s, step.t = t, step.weight[0] = 1 - part, step.weight[1] = part;
  step.value = 0.5 * H.form(s, t) + step.level();
  return true;
}

/// The search, in the axes of the polyhedron.
template <class Form>
class CornerSearch {
 public:
  CornerSearch(const PlacedSuper<Form>& smooth, const PlacedPolyhedron& body)
      : shape_(*body.shape),
        smooth_{smooth.form,
                {body.pose.turn.back(smooth.axes.x), body.pose.turn.back(smooth.axes.y),
                 body.pose.turn.back(smooth.axes.z)},
                body.pose.to_body(smooth.position)},
        size_(std::min(smooth.form.size, shape_.equal_volume_radius())) {}

  const PlacedSuper<Form>& smooth() const { return smooth_; }

  /// Descends from a unit direction. Ends at once if a direction separates the bodies; one found on
  /// the way is improved while that is worth a step.
  CornerNormal from(const Vec3d& start, int most) {
    At at = take(start);
    CornerNormal out;
    const double r = shape_.radius(),
                 rounding = 1e-14 * (smooth_.form.bound + norm(smooth_.position));
    for (out.evaluations = 1;;) {
      out.direction = at.m, out.depth = at.core_depth + r, out.corner = at.corner;
      if (out.depth < 0 && out.evaluations == 1) return apart(out);
      const auto& T = at.cap.radii;
      const Symmetric2<double> true_H{T.xx - at.core_depth, T.xy, T.yy - at.core_depth};
      const auto H = made_positive(true_H, 1e-9 * size_);
      HeldStep step = best_step(at, H, rounding);
      const bool made = H.xx != true_H.xx || H.yy != true_H.yy;  // positive
      const bool minimum = !made || step.size == 3 || (step.size == 2 && along_edge(true_H, step));
      const double s = step.s, t = step.t, length2 = s * s + t * t;
      const double depth =
          r + (0.5 * T.form(s, t) + step.level()) / std::sqrt(1 + length2);  // after the step
      if (out.depth < 0 && depth > 1.5 * out.depth) return apart(out);
      const double pace = std::sqrt(at.cap.pace.form(s, t) + length2);
      // On a face H is used only for the weights, and not where the step is 0.
      const bool ends = minimum && is_precise(at.cap, step, made && step.size == 3 ? 1 : pace);
      if (ends && (depth > 0 || at.core_depth + r - depth < rounding)) {
        out.depth = std::max(depth, 0.0), out.settled = true;
        out.direction = normalised(at.m + s * at.s + t * at.t);
        out.corner = step.corner(), out.held = step.size;
        out.contact_radius = contact_radius(smooth_.form, at.cap);
        return out;
      }
      out.held = step.size, out.contact_radius = contact_radius(smooth_.form, at.cap);
      if (!minimum && length2 < 1e-24) return out;  // a saddle: not for this method
      const double gain = std::min(step.value - at.core_depth, 0.0);
      double part = 1;
      for (bool lower = false; !lower;) {
        if (out.evaluations >= most || part < 1e-9) return out;
        const At next = take(normalised(at.m + (part * s) * at.s + (part * t) * at.t));
        ++out.evaluations;
        lower = next.core_depth <= at.core_depth + 0.1 * part * gain + rounding;
        if (lower)
          at = next;
        else
          part = part == 1 ? std::min(0.5, 1 / pace) : 0.5 * part;
      }
    }
  }

 private:
  struct At {
    Vec3d m, s, t;
    Cap<double> cap;
    Vec3d corner;
    double core_depth;  // [m] F - r
  };

  At take(const Vec3d& m) {
    At at;
    at.m = m;
    tangents(m, at.s, at.t);
    at.cap = smooth_.cap(m, at.s, at.t);
    last_ = shape_.support_vertex(-m, last_);
    at.corner = shape_.vertices()[last_];
    at.core_depth = at.cap.height - dot(m, at.corner - smooth_.position);
    return at;
  }

  LinearCorner seen_from(const At& at, const Vec3d& corner) const {
    const Vec3d c = corner - smooth_.position;
    return {at.cap.height - dot(at.m, c), at.cap.along_s - dot(at.s, c),
            at.cap.along_t - dot(at.t, c), corner};
  }

  HeldStep best_step(const At& at, const Symmetric2<double>& H, double rounding) {
    HeldStepSearch search(H);
    search.add(seen_from(at, at.corner));
    for (int k = 0; k < 40; ++k) {
      const auto& best = search.best();
      last_ = shape_.support_vertex(-(at.m + best.s * at.s + best.t * at.t), last_);
      const auto next = seen_from(at, shape_.vertices()[last_]);
      const double allowed = rounding * (1 + std::abs(best.s) + std::abs(best.t));
      if (next.value(best.s, best.t) <= best.level() + allowed || !search.add(next)) break;
    }
    return search.best();
  }

  /// As newton_step(): errors of normal and point after the step. A vertex is exact as a point, a
  /// face as a normal.
  bool is_precise(const Cap<double>& cap, const HeldStep& step, double pace) const {
    const auto& T = cap.radii;
    const double s = step.s, t = step.t;
    const double turn_error = step.size == 3 ? 0 : 2 * pace * std::sqrt(s * s + t * t);
    const double us = T.xx * s + T.xy * t, ut = T.xy * s + T.yy * t;
    const double moved = std::sqrt(us * us + ut * ut);
    const double missed = step.size == 1 ? 0 : 2 * pace * moved + (T.xx + T.yy) * turn_error;
    return (pace <= 0.25 || moved <= 0.1 * point_tolerance * size_) &&
           turn_error <= turn_tolerance && missed <= point_tolerance * size_;
  }

  static CornerNormal apart(CornerNormal out) {
    out.settled = true;
    return out;
  }

  const Polyhedron& shape_;
  PlacedSuper<Form> smooth_;
  double size_;  // [m] the smaller of both
  std::uint32_t last_ = 0;
};

}  // namespace detail

/// From the direction `last` (in the axes of the polyhedron). Without one (zero): also by GJK and
/// the expanding polytope, and the lower of both minima. The same if the search from `last` does
/// not converge, or ends deeper than is possible for bodies that were apart (`touched` is false):
/// `last` may be old, and its minimum not the smallest.
template <class Form>
CornerNormal find_corner_normal(const PlacedSuper<Form>& smooth, const PlacedPolyhedron& body,
                                const Vec3d& last, bool touched = true) {
  detail::CornerSearch<Form> search(smooth, body);
  const bool known = dot(last, last) > 0;
  const Vec3d towards = -search.smooth().position;
  const double distance = norm(towards);
  const Vec3d start = known          ? normalised(last)
                      : distance > 0 ? towards * (1 / distance)
                                     : Vec3d{0, 0, 1};
  CornerNormal best = search.from(start, known ? 20 : 40);
  const double size = std::min(smooth.form.size, body.shape->equal_volume_radius());
  const bool credible = touched || best.depth < deepest_first_touch * size;
  if (best.depth < 0 || (known && best.settled && credible)) return best;
  const auto& turn = body.pose.turn;
  const auto gjk = gjk_distance(smooth, body, -(turn * best.direction));
  CornerNormal robust;
  Vec3d normal = gjk.normal, on_body = gjk.on_b;
  robust.depth = body.shape->radius() - gjk.distance;
  if (gjk.overlapping) {
    const auto deep = penetration(smooth, body, gjk);
    normal = deep.flat ? -(turn * best.direction) : deep.normal, on_body = deep.on_b;
    robust.depth = body.shape->radius() + deep.depth;
  }
  robust.direction = -turn.back(normal), robust.corner = body.pose.to_body(on_body);
  robust.held = 3, robust.contact_radius = contact_radius_at(smooth, -normal);
  auto polished = search.from(robust.direction, 200);
  polished.evaluations += best.evaluations;
  if (polished.settled && (!best.settled || polished.depth < best.depth)) return polished;
  if (best.settled) return best;
  const auto& lower = polished.depth < best.depth ? polished : best;  // both are upper bounds
  return robust.depth < lower.depth ? robust : lower;
}

}  // namespace silt
