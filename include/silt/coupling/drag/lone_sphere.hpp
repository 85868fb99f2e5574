// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

/// C_D Re/24 of a single sphere by Schiller and Naumann [-]: 1 in Stokes flow.
///   1 + 0.15 Re^0.687 for Re < 1000, 0.44 Re/24 (Newton) above; C_D jumps from 0.438 to 0.44.
/// Source: L. Schiller, A. Naumann, Z. VDI 77 (1933) 318.
template <class Real>
inline Real schiller_naumann(const Real& Re) {
  using detail::lanes_of;
  const Real low =
      Real(1) + lanes_of<Real>(0.15) * power(detail::guarded(Re), lanes_of<Real>(0.687));
  return select(Re < Real(1000), low, lanes_of<Real>(0.44 / 24) * Re);
}

/// Stokes drag of a single sphere, K = 3 pi mu d for any fluid fraction.
/// Source: G. G. Stokes, Trans. Camb. Phil. Soc. 9 (1851) 8 (recalled).
/// Valid:  single spheres, Re << 1.
struct Stokes {
  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return Real(1) / eps;
  }
};

/// Single sphere at any slip: F = (pi/8) rho C_D d^2 |W| W with C_D of schiller_naumann() at rho
/// |W| d/mu = Re/eps, for any fluid fraction.
/// Source: as schiller_naumann().
/// Valid:  single spheres; below Re = 1000 the fit, above Newton's constant.
struct SchillerNaumann {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    return schiller_naumann(Real(Re / eps)) / eps;
  }
};

/// Drag without a void fraction function, for dilute conveying: F = (pi/8) rho C_D d^2 |W| W; the
/// fluid fraction enters only Re = eps rho |W| d/mu.
///   Fhat = (C_D Re/24)/eps^2; C_D = 24/Re below 0.5 (a jump of 9 % there), Schiller-Naumann above
/// Source: EDEM's free-stream drag. Valid: solids below some 1 %.
struct FreeStream {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    const Real C = select(Re < detail::lanes_of<Real>(0.5), Real(1), schiller_naumann(Re));
    return C / (eps * eps);
  }
};

static_assert(DragLaw<Stokes> && DragLaw<SchillerNaumann> && DragLaw<FreeStream>);

}  // namespace silt
