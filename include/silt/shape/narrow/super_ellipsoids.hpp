// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/hard_normal.hpp>

namespace silt::inline SILT_TARGET {

/// Contact of two super-ellipsoids, or of one with a sphere, in lanes: common normal, one Newton
/// step per time step if the pair moves little.
///
///   overlap = min over unit m of F(m), F(m) = h_i(m) + h_j(-m) - m . d                         (1)
///   normal = -m (from j to i), point = (p_i + p_j) / 2, p_i = x_i + grad h_i(m)                (2)
///   1/R_eff = 1/R_i + 1/R_j, R = 1/kappa_m clamped (contact_radius)                            (3)
///
/// The gradient of the overlap with respect to the position of i is minus the normal; minus its
/// derivative with respect to the rotation of i is the couple of the unit force along the normal at
/// p_i, which is with p_j on the line of the force. Therefore any law F(overlap) along the normal
/// conserves energy to the order of the integrator, if R_eff is constant:
/// ContactRadius::AtFirstTouch keeps that of the first touch for the duration of the contact;
/// ContactRadius::Local uses the local one, whose change during rolling violates energy
/// conservation. The midway point (minimum of f_i + f_j on f_i = f_j; LIGGGHTS, SuperDEM) is
/// another choice. It is equal for spheres and to first order in the overlap; otherwise it
/// overestimates (1), its normal differs by 0.1 to 0.6 degrees on average at 1 % overlap, and its
/// overlap times normal is not a gradient. find_ray_normal() gives its direction for bodies of
/// equal exponents.
///
/// Memory: a pair that touched or nearly touched starts from its last direction, which is stored in
///         the axes of the body with the flatter surface there. A lane ends Newton's method when F
///         < 0 for any m (proved apart), or when the step changes the point by less than
///         point_tolerance * size and the normal by less than turn_tolerance, by a conservative
///         estimate. Lanes that do neither in `most_steps`, and new ones, go to
///         find_common_normal(), which always ends; `residual` is the error reached. Faces are
///         rounded, see super_ellipsoid_cap.hpp; the point of two faces therefore moves
///         continuously when they tilt through zero, over an angle of about face_rounding^(1/p).
///         The search is local: a touching pair follows its minimum. With an overlap beyond the
///         radius of curvature (edges, corners) that minimum may end; then the direction jumps to
///         the next one.
///
/// Source: C. Wellmann et al., Eng. Comput. 25 (2008) 432 (common normal); A. Donev et al., J.
///         Comput. Phys. 202 (2005) 765 (overlap potentials).
/// Valid:  forms that passed check(); overlap below half the smallest semi-axis.
/// Shapes: Real = double or a pack of doubles, lane = pair. Memory: 5 Reals.
/// Tests:  tests/shape/super_ellipsoid_contact.cpp.
enum class ContactRadius { AtFirstTouch, Local };

/// Memory of a pair: 5 numbers, 0 at first and for a pair whose bounding spheres are apart.
template <class Real>
struct NormalMemory {
  Vec3<Real> direction{Real(0), Real(0), Real(0)};  // m, in the axes of the body it follows
  Real follows = Real(0);                           // 1: i, -1: j, 0: none; 2, -2: by faces
  Real R_eff = Real(0);                             // [m] of the first touch; 0 while apart
};

/// Contact of two super-ellipsoids, one per lane.
template <class Real>
struct BodyContact {
  Mask<Real> touches;
  Vec3<Real> normal;  // [-] from j to i
  Vec3<Real> point;   // [m] from i's centre
  Real overlap;       // [m]; minus a lower bound of the gap if the bodies do not touch
  Real R_eff;         // [m]
  Real residual;      // [m] estimated error of the point, 0 if apart
  Mask<Real> solved;  // proved apart, or the residual is below point_tolerance * size
};

/// Accepted errors of the point, over the smaller size, and of the normal [rad] for Newton's method
/// in lanes.
inline constexpr double point_tolerance = 1e-7, turn_tolerance = 1e-7;

/// Overlap [-, of the smaller size] that two bodies which were apart one step ago cannot have. A
/// larger one shows that the minimum found from their last direction, which may be old, is not the
/// smallest.
inline constexpr double deepest_first_touch = 1e-3;

/// Newton steps in lanes before a lane is taken out.
inline constexpr int most_steps = 6;

namespace detail {

template <class Real>
SILT_INLINE Mask<Real> no_lane() {
  return Mask<Real>(false);
}

/// The last direction in space.
template <class FormI, class FormJ, class Real>
SILT_INLINE Vec3<Real> last_direction(const PosedPair<FormI, FormJ>& pair,
                                      const NormalMemory<Real>& memory) {
  const Mask<Real> with_i = memory.follows > Real(0);
  const auto &I = pair.turn_i, &J = pair.turn_j;
  const BodyAxes<Real> turn{select(with_i, I.x, J.x), select(with_i, I.y, J.y),
                            select(with_i, I.z, J.z)};
  return turn.to_space(memory.direction);
}

template <class FormI, class FormJ, class Real>
SILT_INLINE void keep_direction(const PosedPair<FormI, FormJ>& pair, const Vec3<Real>& m,
                                const Real& flatness_i, const Real& flatness_j,
                                const Mask<Real>& where, NormalMemory<Real>& memory) {
  const Mask<Real> with_i = flatness_j < flatness_i;
  const auto &I = pair.turn_i, &J = pair.turn_j;
  const BodyAxes<Real> turn{select(with_i, I.x, J.x), select(with_i, I.y, J.y),
                            select(with_i, I.z, J.z)};
  memory.direction = select(where, turn.to_body(m), memory.direction);
  memory.follows = select(where, select(with_i, Real(1), Real(-1)), memory.follows);
}

/// Contact at the minimum a step (s, t) from the point of D: points to first order in the step,
/// overlap to second order.
template <class FormI, class FormJ, class Real>
SILT_INLINE void contact_after(const PosedPair<FormI, FormJ>& pair, const Depth<Real>& D,
                               const Vec3<Real>& m, const NormalStep<Real>& step,
                               BodyContact<Real>& out) {
  const Real half(0.5), s = step.s, t = step.t;
  const auto &Ti = D.i.radii, &Tj = D.j.radii;
  out.overlap = D.F + half * (D.slope_s * s + D.slope_t * t);
  const Real along = half * (D.i.height - D.j.height + dot(m, pair.between));
  const Real back = half * out.overlap;  // from either point to the middle, along the new normal
  const Real by_i_s = D.i.along_s + (Ti.xx - back) * s + Ti.xy * t;
  const Real by_i_t = D.i.along_t + Ti.xy * s + (Ti.yy - back) * t;
  const Real by_j_s = D.j.along_s + dot(D.s, pair.between) - (Tj.xx - back) * s - Tj.xy * t;
  const Real by_j_t = D.j.along_t + dot(D.t, pair.between) - Tj.xy * s - (Tj.yy - back) * t;
  const Real along_s = select(step.by_i, by_i_s, by_j_s);
  const Real along_t = select(step.by_i, by_i_t, by_j_t);
  out.point = m * along + D.s * along_s + D.t * along_t;
  out.residual = step.residual;
}

template <class FormI, class FormJ, class Real>
SILT_INLINE Real effective_radius_at(const PosedPair<FormI, FormJ>& pair, const Depth<Real>& D) {
  const Real Ri = contact_radius(pair.i, D.i), Rj = contact_radius(pair.j, D.j);
  return Ri * Rj / (Ri + Rj);
}

template <class Real>
SILT_INLINE void take_lanes(const Mask<Real>& where, const BodyContact<Real>& from,
                            const Mask<Real>& touches, BodyContact<Real>& to) {
  to.touches = (where && touches) || (!where && to.touches);
  to.normal = select(where, from.normal, to.normal);
  to.point = select(where, from.point, to.point);
  to.overlap = select(where, from.overlap, to.overlap);
  to.residual = select(where, from.residual, to.residual);
  to.solved = to.solved || where;
}

/// One pair by the robust methods: result and memory.
template <class FormI, class FormJ>
inline BodyContact<double> solve_hard(const PosedPair<FormI, FormJ>& pair,
                                      NormalMemory<double>& memory) {
  const Vec3d last = memory.follows == 0 ? Vec3d{0, 0, 0} : last_direction(pair, memory);
  auto found = find_common_normal(pair, last);
  const double size = std::min(pair.i.size, pair.j.size);
  if (memory.R_eff == 0 && memory.follows != 0 && found.depth > deepest_first_touch * size)
    found = find_common_normal(pair, {0, 0, 0});
  const auto D = depth_along(pair, found.direction);
  BodyContact<double> out{};
  const bool flatter_j = D.i.radii.xx + D.i.radii.yy < D.j.radii.xx + D.j.radii.yy;
  contact_after(pair, D, found.direction, {0, 0, true, 0, 0, found.residual, flatter_j}, out);
  out.R_eff = effective_radius_at(pair, D);
  out.normal = -found.direction;
  out.touches = found.depth > 0, out.solved = found.solved;
  if (!out.touches) out.residual = 0;
  keep_direction(pair, found.direction, D.i.radii.xx + D.i.radii.yy, D.j.radii.xx + D.j.radii.yy,
                 true, memory);
  return out;
}

/// The lanes of `which` by solve_hard().
template <class FormI, class FormJ, class Real>
[[gnu::noinline]] void solve_hard_lanes(const PosedPair<FormI, FormJ>& pair, std::uint64_t which,
                                        NormalMemory<Real>& memory, BodyContact<Real>& out) {
  using I = typename FormI::template With<double>;
  using J = typename FormJ::template With<double>;
  constexpr std::size_t W = sizeof(Real) / sizeof(double);
  alignas(64) double touches[W], solved[W];
  store(touches, select(out.touches, Real(1), Real(0)));
  store(solved, select(out.solved, Real(1), Real(0)));
  for (std::size_t k = 0; k < W; ++k) {
    if (!(which >> k & 1)) continue;
    auto kept = one_lane<NormalMemory<double>>(memory, k);
    const auto one = solve_hard(one_lane<PosedPair<I, J>>(pair, k), kept);
    set_lane(memory, kept, k);
    touches[k] = one.touches ? 1 : 0, solved[k] = one.solved ? 1 : 0;
    set_lane(out.normal, one.normal, k), set_lane(out.point, one.point, k);
    set_lane(out.overlap, one.overlap, k), set_lane(out.R_eff, one.R_eff, k);
    set_lane(out.residual, one.residual, k);
  }
  out.touches = load<Real>(touches) > Real(0), out.solved = load<Real>(solved) > Real(0);
}

}  // namespace detail

/// Cheap lower bound [m] of the gap; values <= 0 prove nothing. By bounding spheres; then, along
/// the last direction, by the bodies themselves with rough powers, minus a margin of 1e-5 of their
/// size. (Boxes around the bodies along that direction prove less, and a pack is done only when all
/// of its lanes are.)
template <class FormI, class FormJ, class Real = typename FormI::Real>
SILT_INLINE Real least_gap(const PosedPair<FormI, FormJ>& pair, const NormalMemory<Real>& memory) {
  const Real reach = pair.i.bound + pair.j.bound;
  const Real by_spheres = sqrt(dot(pair.between, pair.between)) - reach;
  const Mask<Real> known = memory.follows != Real(0);
  if (!any(known && !(by_spheres > Real(0)))) return by_spheres;
  const Vec3<Real> m = detail::last_direction(pair, memory);
  const Vec3<Real> ni = pair.turn_i.to_body(m), nj = -pair.turn_j.to_body(m);
  const Real heights = rough_height(pair.i, ni) + rough_height(pair.j, nj);
  const Real along = dot(m, pair.between) - heights - Real(1e-5) * reach;
  return max(by_spheres, select(known, along, by_spheres));
}

/// Proved apart by least_gap(). The other lanes need touch().
template <class FormI, class FormJ, class Real = typename FormI::Real>
SILT_INLINE Mask<Real> apart(const PosedPair<FormI, FormJ>& pair,
                             const NormalMemory<Real>& memory) {
  return least_gap(pair, memory) > Real(0);
}

namespace detail {
template <class FormI, class FormJ>
inline constexpr bool are_balls = false;
template <class R>
inline constexpr bool are_balls<SphereForm<R>, SphereForm<R>> = true;
template <class R>
inline constexpr bool are_balls<SuperForm<R, Exponents::Ball>, SuperForm<R, Exponents::Ball>> =
    true;

/// Contact of two balls of any form types; the direction is stored in the axes of i.
template <class Form, class Real>
SILT_INLINE BodyContact<Real> touch_balls(const PosedPair<Form, Form>& pair,
                                          NormalMemory<Real>& memory) {
  const Real a = pair.i.bound, b = pair.j.bound, zero(0);
  const Real distance = sqrt(max(dot(pair.between, pair.between), smallest<Real>()));
  const Vec3<Real> m = pair.between * (Real(1) / distance);
  BodyContact<Real> out;
  out.overlap = a + b - distance;
  out.touches = out.overlap > zero;
  out.normal = -m;
  out.point = m * (a - Real(0.5) * out.overlap);
  out.R_eff = a * b / (a + b);
  out.residual = zero;
  out.solved = distance == distance;
  memory.direction = pair.turn_i.to_body(m);
  memory.follows = Real(1), memory.R_eff = select(out.touches, out.R_eff, zero);
  return out;
}

/// touch() with a first direction `from` if the memory follows a body. Without `Whole` only one
/// step: lanes that do not converge are not solved, and their normal is minus the direction to
/// continue from.
template <ContactRadius Radius, bool Whole, class FormI, class FormJ,
          class Real = typename FormI::Real>
inline BodyContact<Real> touch_from(const PosedPair<FormI, FormJ>& pair, const Vec3<Real>& from,
                                    NormalMemory<Real>& memory) {
  const Real zero(0), reach = pair.i.bound + pair.j.bound;
  const Real size = min(pair.i.size, pair.j.size), tolerance = Real(point_tolerance) * size;
  const Real distance2 = dot(pair.between, pair.between);
  const Mask<Real> far = distance2 > reach * reach;
  const Mask<Real> start = !far && (memory.follows != zero);
  BodyContact<Real> out{no_lane<Real>(),
                        {zero, zero, Real(1)},
                        {zero, zero, zero},
                        reach - sqrt(distance2),
                        Real(1),
                        zero,
                        far};
  Mask<Real> open = start;  // lanes that are still iterating
  Vec3<Real> m = select(start, from, out.normal);
  for (int k = 0; k < (Whole ? most_steps : 1) && any(open); ++k) {
    const auto D = depth_along(pair, m);
    auto step = newton_step(D);
    const Mask<Real> apart = D.F < zero;
    const Mask<Real> settled = step.downhill && (step.residual <= tolerance) &&
                               (step.turn_error <= Real(turn_tolerance)) &&
                               (step.pace <= Real(0.25));
    const Mask<Real> done = open && (apart || settled);
    Real damp(1);
    if (any(step.pace > Real(1))) damp = Real(1) / max(step.pace, Real(1));  // of w_k: doubled
    const Vec3<Real> next = unit(m + D.s * (damp * step.s) + D.t * (damp * step.t));
    if (any(done)) {
      BodyContact<Real> now;
      contact_after(pair, D, m, step, now);
      now.normal = -next;
      now.overlap = select(apart, D.F, now.overlap);
      now.residual = select(apart, zero, now.residual);
      take_lanes(done, now, done && !apart, out);
      if (Radius == ContactRadius::Local || any(done && !apart && memory.R_eff == zero))
        out.R_eff = select(done, effective_radius_at(pair, D), out.R_eff);
      const auto &Ti = D.i.radii, &Tj = D.j.radii;
      keep_direction(pair, select(apart, m, next), Ti.xx + Ti.yy, Tj.xx + Tj.yy, done, memory);
    }
    open = open && !done && step.downhill;
    m = select(open, next, m);
  }
  const Mask<Real> wrong = start && out.solved && out.touches && (memory.R_eff == zero) &&
                           (out.overlap > Real(deepest_first_touch) * size);
  // restarts without a direction
  if (any(wrong)) memory.follows = select(wrong, zero, memory.follows);
  const Mask<Real> hard = !out.solved || wrong;
  if constexpr (Whole) {
    if (any(hard)) solve_hard_lanes(pair, lane_bits(hard), memory, out);
  } else {
    out.solved = !hard;
    out.normal = select(hard, -m, out.normal);
  }
  if constexpr (Radius == ContactRadius::AtFirstTouch)
    out.R_eff = select(memory.R_eff > zero, memory.R_eff, out.R_eff);
  memory.R_eff =
      select(out.solved || Mask<Real>(Whole), select(out.touches, out.R_eff, zero), memory.R_eff);
  memory.follows = select(far, zero, memory.follows);
  return out;
}

}  // namespace detail

template <class Real>
SILT_INLINE BodyContact<Real> touch(
    const PosedPair<SuperForm<Real, Exponents::Ball>, SuperForm<Real, Exponents::Ball>>& pair,
    NormalMemory<Real>& memory) {
  return detail::touch_balls(pair, memory);
}
template <class Real>
SILT_INLINE BodyContact<Real> touch(const PosedPair<SphereForm<Real>, SphereForm<Real>>& pair,
                                    NormalMemory<Real>& memory) {
  return detail::touch_balls(pair, memory);
}

/// Contact of each lane's pair; `memory` is read and written. Padding lanes should be far apart.
template <ContactRadius Radius = ContactRadius::AtFirstTouch, class FormI, class FormJ,
          class Real = typename FormI::Real>
inline BodyContact<Real> touch(const PosedPair<FormI, FormJ>& pair, NormalMemory<Real>& memory) {
  return detail::touch_from<Radius, true>(pair, detail::last_direction(pair, memory), memory);
}

}  // namespace silt
