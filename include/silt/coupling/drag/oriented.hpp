// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <numbers>

#include <silt/coupling/drag/form_in_flow.hpp>
#include <silt/coupling/drag/zastawny.hpp>
#include <silt/coupling/fluid_force.hpp>

/// Drag, lift and pitching torque of bodies in a CoupledFlow, by their present orientation in the
/// flow.
///
///   silt::CoupledFlow{silt::OrientedDrag{}, silt::Kernel{}, flow, silt::InclinedLift{}}
///
/// In suspensions, F = 3 pi mu d eps Fhat W as in drag/concept.hpp, with d of the sphere of equal
/// volume. With C_D of a single-body law for its silhouette along the slip,
///
///   Fhat = (C_D Re/24) eps^-chi, chi(Re) of Di Felice                                          (1)
///   Fhat = Fhat of a sphere law times C_D over that of a sphere                                (2)
///
/// (1) has been used for beds of ellipsoids; (2) applies if a sphere law is named,
/// OrientedDrag<HoelzerSommerfeld, Beetstra>. Spheres are treated as spheres.
/// Source: R. Di Felice, Int. J. Multiphase Flow 20 (1994) 153; Z. Y. Zhou, D. Pinson, R. P. Zou,
///         A. B. Yu, Chem. Eng. Sci. 66 (2011) 6128 (ellipsoids, Hoelzer-Sommerfeld with (1)).
/// Valid:  as the laws; the effect of neighbours is assumed to be that on a sphere.
/// Tests:  tests/coupling/oriented.cpp.
namespace silt::inline SILT_TARGET {

/// Drag law that depends on the particle: Fhat [-] of drag/concept.hpp, at Re = eps rho |W| d/mu.
/// Optional: `void check_form(const FormInFlow*) const`, which throws for unsuitable forms;
/// nullptr: spheres.
///
/// Units:  SI; Fhat and Re [-].
/// Errors: InputError of check_form() for forms outside the range of a law.
/// Tests:  tests/coupling/oriented.cpp.
template <class L>
concept OrientedDragLaw = requires(const L& law, const InFluid& at, const double& Re) {
  { law.normalised(at, Re) } -> std::same_as<double>;
};

namespace detail {
/// In the frame of the table.
inline Vec3d in_body(const InFluid& at, const Vec3d& v) {
  return rotate(conjugate(at.orientation), v);
}
inline ShapeInFlow<double> seen_along(const InFluid& at, const Vec3d& u) {
  return at.body ? at.body->along(u) : ShapeInFlow<double>{};
}
template <class SphereLaw, class Law>
double among_others(const Law& law, const ShapeInFlow<double>& shape, double eps, double Re) {
  if constexpr (std::is_void_v<SphereLaw>)
    return with_di_felice(law, shape, eps, Re);
  else
    return scaled_by_sphere(SphereLaw(), law, shape, eps, Re);
}
inline double reynolds_of(const InFluid& at) {
  return slip_reynolds(at.voidage, at.density, norm(at.slip), at.diameter, at.viscosity);
}
}  // namespace detail

/// Drag of bodies by their orientation: (1), or with a sphere law (2).
template <LoneBodyLaw Law = HoelzerSommerfeld, class SphereLaw = void>
struct OrientedDrag {
  static constexpr bool sees_forms = true, needs_spin = false;
  double normalised(const InFluid& at, double Re) const {
    const double W = norm(at.slip);
    const Vec3d u = W > 0 ? detail::in_body(at, at.slip * (1 / W)) : Vec3d{0, 0, 1};
    return detail::among_others<SphereLaw>(Law(), detail::seen_along(at, u), at.voidage, Re);
  }
};

/// Lift of an inclined body: with Fhat_i of the body for a flow along its principal axis e_i,
///
///   L = the part across W of 3 pi mu d eps sum_i Fhat_i (W.e_i) e_i                            (3)
///
/// For a body of revolution C_L = (C_D90 - C_D0) sin alpha |cos alpha| (drag/orientation.hpp).
/// Exact in Stokes flow if the law is, as the Fhat_i are constant there; an interpolation beyond.
/// Use the law and the sphere law of the drag.
/// Source: J. Happel, H. Brenner, Low Reynolds Number Hydrodynamics (1965), ch. 5.
template <LoneBodyLaw Law = HoelzerSommerfeld, class SphereLaw = void>
struct InclinedLift {
  static constexpr bool sees_forms = true, needs_spin = false;
  Vec3d force_on(const InFluid& at) const {
    const double W2 = dot(at.slip, at.slip);
    if (!at.body || at.body->seen.empty() || W2 == 0) return {0, 0, 0};
    const double Re = detail::reynolds_of(at);
    const auto along = [&](const Vec3d& e) {
      return detail::among_others<SphereLaw>(Law(), at.body->along(e), at.voidage, Re);
    };
    const Vec3d W = detail::in_body(at, at.slip);
    const Vec3d F{along({1, 0, 0}) * W.x, along({0, 1, 0}) * W.y, along({0, 0, 1}) * W.z};
    const double scale = 3 * std::numbers::pi * at.viscosity * at.diameter * at.voidage;
    return rotate(at.orientation, scale * (F - W * (dot(F, W) / W2)));
  }
};

/// Exact force on a single ellipsoid in slow flow; other bodies as the ellipsoid with their moments
/// and volume. It is a drag law and, given also as a force, adds the lift:
///
///   silt::CoupledFlow{silt::SlowEllipsoid{}, mode, flow, silt::SlowEllipsoid{}}
///
///   F = 6 pi mu r sum_i k_i (W.e_i) e_i, k_x = (8/3)/(chi + a^2 alpha), a, b, c over r        (4)
///   chi = int_0^inf dl/D, alpha = int_0^inf dl/((a^2 + l) D),
///   D^2 = (a^2 + l)(b^2 + l)(c^2 + l)
///
/// Source: A. Oberbeck, J. reine angew. Math. 81 (1876) 62; Happel and Brenner as above, sec. 5-11.
/// Valid:  Re << 1; without the effect of other particles.
struct SlowEllipsoid {
  static constexpr bool sees_forms = true, needs_spin = false;
  double normalised(const InFluid& at, double) const {
    const double W2 = dot(at.slip, at.slip);
    const Vec3d W = detail::in_body(at, at.slip);
    return (W2 > 0 ? dot(W, over_stokes(at, W)) / W2 : 1) / at.voidage;
  }
  Vec3d force_on(const InFluid& at) const {
    const double W2 = dot(at.slip, at.slip);
    if (W2 == 0) return {0, 0, 0};
    const Vec3d W = detail::in_body(at, at.slip), F = over_stokes(at, W);
    return rotate(at.orientation,
                  3 * std::numbers::pi * at.viscosity * at.diameter * (F - W * (dot(F, W) / W2)));
  }

 private:
  static Vec3d over_stokes(const InFluid& at, const Vec3d& W) {
    if (!at.body) return W;
    const Vec3d& k = at.body->slip_resistance;
    return {k.x * W.x, k.y * W.y, k.z * W.z};
  }
};

/// Drag of one of the four bodies of Zastawny et al., with (1). Below Re = 0.1, the end of the fit,
/// C_D Re is constant. For the verification of the coefficients see drag/zastawny.hpp.
/// Source: as Zastawny (coupling/drag/zastawny.hpp).
/// Valid:  as Zastawny: 0.1 < Re < 300, its four bodies.
struct ZastawnyDrag {
  Zastawny fit;
  static constexpr bool sees_forms = true, needs_spin = false;
  double normalised(const InFluid& at, double Re) const;
  void check_form(const FormInFlow* form) const;
};

/// Lift and pitching torque of these bodies, the latter for a single body: neither depends on the
/// void fraction.
/// Source: as Zastawny (coupling/drag/zastawny.hpp).
/// Valid:  as Zastawny: 0.1 < Re < 300, its four bodies.
struct ZastawnyLift {
  Zastawny fit;
  static constexpr bool sees_forms = true;
  Vec3d force_on(const InFluid& at) const;
  Vec3d torque_on(const InFluid& at) const;
  void check_form(const FormInFlow* form) const;
};

namespace detail {
/// The axis of symmetry in space.
inline Vec3d axis_in_space(const InFluid& at) {
  const int k = at.body->symmetry_axis();
  return rotate(at.orientation, {k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.});
}
struct Inclination {
  Vec3d axis;
  double Re, cosine, sine;  // of the angle between axis and slip, in [0, 1]
};
inline Inclination inclination(const InFluid& at) {
  const Vec3d n = axis_in_space(at);
  const double W = norm(at.slip), c = W > 0 ? std::min(std::abs(dot(n, at.slip)) / W, 1.0) : 1;
  return {n, std::max(at.density * W * at.diameter / at.viscosity, 0.1), c,
          W > 0 ? std::min(norm(cross(n, at.slip)) / W, 1.0) : 0};
}
/// A cylinder has the moments of an ellipsoid longer by 2/sqrt(3).
inline void check_aspect(const char* who, const Zastawny& fit, const FormInFlow* form) {
  require(form, who,
          " is a fit of one body, but these particles are spheres; use a drag law of spheres");
  const double ratio = form->aspect_ratio();
  require(ratio > 0.9 * fit.aspect && ratio < 1.2 * fit.aspect, who, " is a fit of a body ",
          fit.aspect, " times as long as wide, but a form of the particles is (by its moments) ",
          ratio, " times; use OrientedDrag and InclinedLift, or the fit of that form");
}
}  // namespace detail

inline double ZastawnyDrag::normalised(const InFluid& at, double Re) const {
  const auto in = detail::inclination(at);
  const double Re_fit = std::max(Re, 0.1);
  return fit.drag(Re_fit, in.sine, in.cosine) * Re_fit / 24 *
         power(at.voidage, double(-di_felice_exponent(Re)));
}
inline void ZastawnyDrag::check_form(const FormInFlow* form) const {
  detail::check_aspect("ZastawnyDrag", fit, form);
}
inline Vec3d ZastawnyLift::force_on(const InFluid& at) const {
  const auto in = detail::inclination(at);
  return drag_and_lift(at.diameter, at.density, at.slip, in.axis, 0.0,
                       fit.lift(in.Re, in.sine, in.cosine));
}
inline Vec3d ZastawnyLift::torque_on(const InFluid& at) const {
  const auto in = detail::inclination(at);
  return pitching_torque(at.diameter, at.density, at.slip, in.axis,
                         fit.torque(in.Re, in.sine, in.cosine), fit.kind);
}
inline void ZastawnyLift::check_form(const FormInFlow* form) const {
  detail::check_aspect("ZastawnyLift", fit, form);
}

static_assert(OrientedDragLaw<SlowEllipsoid> && FluidForce<SlowEllipsoid>);
static_assert(OrientedDragLaw<OrientedDrag<>> && OrientedDragLaw<ZastawnyDrag>);
static_assert(FluidForce<InclinedLift<>> && FluidForce<ZastawnyLift>);

}  // namespace silt
