// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/di_felice.hpp>
#include <silt/coupling/drag/lone_sphere.hpp>

namespace silt::inline SILT_TARGET {

/// Numbers of a body's shape for drag laws, in the direction of the flow; all are 1 for a sphere. d
/// [m] is the diameter of the sphere of equal volume, S [m2] the body's surface. Computed by
/// shape_in_flow() of coupling/drag/silhouette.hpp.
template <class Real>
struct ShapeInFlow {
  Real sphericity = Real(1);   // [-] phi = pi d^2/S
  Real crosswise = Real(1);    // [-] phi_perp = (pi d^2/4)/A, A the projected area along the flow
  Real lengthwise = Real(1);   // [-] phi_par = (pi d^2/4)/(S/2 - mean projected area across it)
  Real circularity = Real(1);  // [-] c = pi dA/perimeter of A, A = pi dA^2/4

  Real diameter_ratio() const { return Real(1) / sqrt(crosswise); }  // dA/d
};

/// Drag of a single body: F = (pi/8) rho C_D d^2 |W| W, Re = rho d |W|/mu. A law gives C_D Re/24,
/// the drag over the Stokes drag of the sphere, which is finite at Re = 0:
///   template <class Real> Real over_stokes(const ShapeInFlow<Real>&, const Real& Re) const
///
/// Units:  SI; numbers of shape, Re and the result [-]. Shapes: Real = double, float or a batch.
/// Errors: none.
/// Tests:  tests/coupling/non_spherical.cpp.
template <class L>
concept LoneBodyLaw = requires(const L& law, const ShapeInFlow<double>& shape, const double& Re) {
  { law.over_stokes(shape, Re) } -> std::same_as<double>;
};

/// C_D [-] for Re > 0.
template <class Law, class Real>
inline Real lone_body_drag(const Law& law, const ShapeInFlow<Real>& shape, const Real& Re) {
  return Real(24) / Re * law.over_stokes(shape, Re);
}

namespace detail {
/// -log10 of a sphericity, slightly above 0 at 1.
template <class Real>
inline Real roughness(const Real& phi) {
  return max(lanes_of<Real>(-0.30102999566398120) * exact_log2(phi), smallest<Real>());
}
/// 10^x.
template <class Real>
inline Real ten_to(const Real& x) {
  return exact_exp2(Real(lanes_of<Real>(3.3219280948873623) * x));
}
}  // namespace detail

/// Drag of isometric bodies, from the sphericity only:
///   C_D = 24/Re (1 + A1 Re^A2) + A3/(1 + A4/Re)
///   A1 = exp(2.3288 - 6.4581 phi + 2.4486 phi^2), A2 = 0.0964 + 0.5565 phi,
///   A3 = exp(4.905 - 13.8944 phi + 18.4222 phi^2 - 10.2599 phi^3),
///   A4 = exp(1.4681 + 12.2584 phi - 20.7322 phi^2 + 15.8855 phi^3)
/// Source: A. Haider, O. Levenspiel, Powder Technol. 58 (1989) 63.
/// Valid:  Re < 2.6e5, phi >= 0.67 (discs: to 0.03).
struct HaiderLevenspiel {
  template <class Real>
  Real over_stokes(const ShapeInFlow<Real>& shape, const Real& Re) const {
    using detail::lanes_of;
    const Real phi = shape.sphericity;
    const auto cubic = [&](double a, double b, double c, double e) {
      return exponential(
          Real(lanes_of<Real>(a) +
               phi * (lanes_of<Real>(b) + phi * (lanes_of<Real>(c) + phi * lanes_of<Real>(e)))));
    };
    const Real A1 = cubic(2.3288, -6.4581, 2.4486, 0);
    const Real A2 = lanes_of<Real>(0.0964) + lanes_of<Real>(0.5565) * phi;
    const Real A3 = cubic(4.905, -13.8944, 18.4222, -10.2599);
    const Real A4 = cubic(1.4681, 12.2584, -20.7322, 15.8855);
    return Real(1) + A1 * power(detail::guarded(Re), A2) +
           lanes_of<Real>(1.0 / 24) * A3 * Re * Re / (Re + A4);
  }
};

/// Drag from the sphericity and, unless isometric, the projected area along the flow:
///   C_D = K2 {24/r (1 + 0.1118 r^0.6567) + 0.4305/(1 + 3305/r)}, r = Re K1 K2,
///   K1 = 1/[dn/(3 d) + (2/3)/sqrt(phi)], K2 = 10^(1.8148 (-log10 phi)^0.5743);
///   isometric: dn = d, otherwise dn = dA
/// Source: G. H. Ganser, Powder Technol. 77 (1993) 143; read in table 2 of H. Ma et al., Powder
///         Technol. 412 (2022) 117972. FALL3D and MFIX have the same numbers.
/// Valid:  r <= 1e5 and phi up to 0.95. It is a fit for bodies with edges: K2 has an infinite slope
///         at phi = 1, where C_D is below the drag of a sphere by 0.3 % at Re 0.5, 12 % at 10, 25 %
///         at 50, 27 % at 200, 19 % at 1000 and 7 % at 2500. For bodies near a sphere use
///         HaiderLevenspiel (at most 7 % above).
/// Tests:  tests/coupling/non_spherical.cpp: the standard drag curve of spheres, and Pettyjohn and
///         Christiansen's measurements of isometric bodies at both ends of Re.
template <bool Isometric>
struct BasicGanser {
  template <class Real>
  Real over_stokes(const ShapeInFlow<Real>& shape, const Real& Re) const {
    using detail::lanes_of;
    Real dn(1);
    if constexpr (!Isometric) dn = shape.diameter_ratio();
    const Real inverse_K1 =
        lanes_of<Real>(1.0 / 3) * dn + lanes_of<Real>(2.0 / 3) / sqrt(shape.sphericity);
    const Real K2 =
        detail::ten_to(Real(lanes_of<Real>(1.8148) *
                            power(detail::roughness(shape.sphericity), lanes_of<Real>(0.5743))));
    const Real r = Re * K2 / inverse_K1;
    return inverse_K1 * (Real(1) + lanes_of<Real>(0.1118) *
                                       power(detail::guarded(r), lanes_of<Real>(0.6567))) +
           lanes_of<Real>(0.4305 / 24) * K2 * Re * r / (r + Real(3305));
  }
};
using Ganser = BasicGanser<true>;
/// BasicGanser for isometric bodies, and with the projected area along the flow.
using GanserInFlow = BasicGanser<false>;

/// Drag in slow flow, from sphericity and projected area along the flow:
///   C_D = (8/Re)/sqrt(phi_perp) + (16/Re)/sqrt(phi)
/// Source: D. Leith, Aerosol Sci. Technol. 6 (1987) 153. Valid: Re << 1.
struct Leith {
  template <class Real>
  Real over_stokes(const ShapeInFlow<Real>& shape, const Real&) const {
    using detail::lanes_of;
    return lanes_of<Real>(1.0 / 3) / sqrt(shape.crosswise) +
           lanes_of<Real>(2.0 / 3) / sqrt(shape.sphericity);
  }
};

/// Drag from the projected area along the flow and the circularity of its outline, q = dA/d:
///   C_D = (24/Re) q [1 + 0.15/sqrt(c) (q Re)^0.687] + 0.42 q^2/(sqrt(c) [1 + 4.25e4 (q Re)^-1.16])
/// Source: S. Tran-Cong, M. Gay, E. E. Michaelides, Powder Technol. 139 (2004) 21. Recalled: the
///         print was not read; for a sphere it is Clift and Gauvin's law, within 4 % of the
///         standard drag curve.
/// Valid:  0.15 < Re < 1500, 0.8 < q < 1.5, 0.4 < c < 1.
struct TranCong {
  template <class Real>
  Real over_stokes(const ShapeInFlow<Real>& shape, const Real& Re) const {
    using detail::lanes_of;
    const Real q = shape.diameter_ratio(), root = sqrt(shape.circularity);
    const Real log_r = exact_log2(detail::guarded(Real(q * Re)));
    return q * (Real(1) +
                lanes_of<Real>(0.15) / root * exact_exp2(Real(lanes_of<Real>(0.687) * log_r))) +
           lanes_of<Real>(0.42 / 24) * q * q * Re /
               (root * (Real(1) +
                        lanes_of<Real>(4.25e4) * exact_exp2(Real(lanes_of<Real>(-1.16) * log_r))));
  }
};

/// Drag of any shape and orientation at any Re:
///   C_D = (8/Re)/sqrt(phi_par) + (16/Re)/sqrt(phi) + (3/sqrt(Re))/phi^(3/4)
///       + 0.42 10^(0.4 (-log10 phi)^0.2)/phi_perp
/// Simplified: phi_perp replaces phi_par.
/// Source: A. Hoelzer, M. Sommerfeld, Powder Technol. 184 (2008) 361.
/// Valid:  up to the critical Re.
template <bool Simplified>
struct BasicHoelzerSommerfeld {
  template <class Real>
  Real over_stokes(const ShapeInFlow<Real>& shape, const Real& Re) const {
    using detail::lanes_of;
    const Real phi = shape.sphericity, root = sqrt(phi);
    const Real along = Simplified ? shape.crosswise : shape.lengthwise;
    const Real newton = detail::ten_to(
        Real(lanes_of<Real>(0.4) * power(detail::roughness(phi), lanes_of<Real>(0.2))));
    return lanes_of<Real>(1.0 / 3) / sqrt(along) + lanes_of<Real>(2.0 / 3) / root +
           lanes_of<Real>(0.125) * sqrt(Re) / (root * sqrt(root)) +
           lanes_of<Real>(0.42 / 24) * newton * Re / shape.crosswise;
  }
};
using HoelzerSommerfeld = BasicHoelzerSommerfeld<false>;
/// The full form, and the one with phi_perp in place of phi_par.
using HoelzerSommerfeldSimplified = BasicHoelzerSommerfeld<true>;

static_assert(LoneBodyLaw<HaiderLevenspiel> && LoneBodyLaw<Ganser> && LoneBodyLaw<GanserInFlow> &&
              LoneBodyLaw<Leith> && LoneBodyLaw<TranCong> && LoneBodyLaw<HoelzerSommerfeld> &&
              LoneBodyLaw<HoelzerSommerfeldSimplified>);

/// @name Among other particles: Fhat of drag/concept.hpp, Re = eps rho |W| d/mu
/// @{

/// Fhat of a sphere law times C_D of the body over that of the sphere (Schiller-Naumann), at the
/// same Re.
template <class SphereLaw, class Law, class Real>
inline Real scaled_by_sphere(const SphereLaw& sphere, const Law& law,
                             const ShapeInFlow<Real>& shape, const Real& eps, const Real& Re) {
  return sphere.normalised(eps, Re) * law.over_stokes(shape, Re) / schiller_naumann(Re);
}

/// With Di Felice's void fraction function, F_d = (pi/8) rho C_D d^2 |W| W eps^(2 - chi).
template <class Law, class Real>
inline Real with_di_felice(const Law& law, const ShapeInFlow<Real>& shape, const Real& eps,
                           const Real& Re) {
  return law.over_stokes(shape, Re) * power(eps, Real(-di_felice_exponent(Re)));
}
/// @}

/// One body in one orientation as a drag law: NonSpherical{Ganser(), shape} with Di Felice's void
/// fraction function, NonSpherical<Ganser, Beetstra>{{}, shape} scaled from a sphere law.
/// Source: as its laws.
/// Valid:  as its laws; one orientation for all particles.
template <class Law, class SphereLaw = void>
struct NonSpherical {
  Law law;
  ShapeInFlow<double> shape;

  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const ShapeInFlow<Real> body{lanes_of<Real>(shape.sphericity), lanes_of<Real>(shape.crosswise),
                                 lanes_of<Real>(shape.lengthwise),
                                 lanes_of<Real>(shape.circularity)};
    if constexpr (std::is_void_v<SphereLaw>)
      return with_di_felice(law, body, eps, Re);
    else
      return scaled_by_sphere(SphereLaw(), law, body, eps, Re);
  }
};
template <class Law>
NonSpherical(Law, ShapeInFlow<double>) -> NonSpherical<Law>;

static_assert(DragLaw<NonSpherical<Ganser>>);

}  // namespace silt
