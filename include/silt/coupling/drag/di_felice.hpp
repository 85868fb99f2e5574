// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {
/// C_D Re/24 with C_D = (0.63 + 4.8/sqrt(Re))^2: 0.96 in Stokes flow.
template <class Real>
inline Real dalla_valle(const Real& Re) {
  const Real root = lanes_of<Real>(0.63) * sqrt(Re) + lanes_of<Real>(4.8);
  return lanes_of<Real>(1.0 / 24) * root * root;
}
/// exp(-(1.5 - log10 Re)^2/2).
template <class Real>
inline Real bell_of_reynolds(const Real& Re) {
  const Real x =
      lanes_of<Real>(1.5) - lanes_of<Real>(0.30102999566398120) * exact_log2(guarded(Re));
  return exponential(Real(lanes_of<Real>(-0.5) * x * x));
}
}  // namespace detail

/// Exponent chi = 3.7 - 0.65 exp(-(1.5 - log10 Re)^2/2) [-]: 3.7 in the limits of slow and fast
/// flow, 3.05 at Re = 32.
template <class Real>
inline Real di_felice_exponent(const Real& Re) {
  using detail::lanes_of;
  return lanes_of<Real>(3.7) - lanes_of<Real>(0.65) * detail::bell_of_reynolds(Re);
}

/// Drag from packed beds to single spheres by one smooth formula: Fhat = (C_D Re/24) eps^-chi,
///   C_D = (0.63 + 4.8/sqrt(Re))^2 (Dalla Valle); at Re = 0 4 % below Stokes' law
/// Source: R. Di Felice, Int. J. Multiphase Flow 20 (1994) 153.
/// Valid:  0.01 < Re < 1e4, eps from 0.4 to 1.
struct DiFelice {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    return detail::dalla_valle(Re) * power(eps, Real(-di_felice_exponent(Re)));
  }
};

/// Drag of Di Felice's form, fitted to lattice-Boltzmann results for packings:
///   chi = 2.65 (eps + 1) - (5.3 - 3.5 eps) eps^2 exp(-(1.5 - log10 Re)^2/2)
/// Source: L. W. Rong, K. J. Dong, A. B. Yu, Chem. Eng. Sci. 99 (2013) 44.
/// Valid:  packings of spheres, eps and Re as DiFelice; the range in print was not read.
struct Rong {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const Real chi =
        lanes_of<Real>(2.65) * (eps + Real(1)) - (lanes_of<Real>(5.3) - lanes_of<Real>(3.5) * eps) *
                                                     eps * eps * detail::bell_of_reynolds(Re);
    return detail::dalla_valle(Re) * power(eps, Real(-chi));
  }
};

static_assert(DragLaw<DiFelice> && DragLaw<Rong>);

}  // namespace silt
