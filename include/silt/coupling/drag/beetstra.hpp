// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Drag fitted to lattice-Boltzmann results for random arrays, p = 1 - eps:
///   Fhat = 10 p/eps^2 + eps^2 (1 + 1.5 sqrt p)
///        + (0.413 Re/(24 eps^2)) [1/eps + 3 eps p + 8.4 Re^-0.343]/[1 + 10^(3p) Re^-(1 + 4p)/2]
/// Source: R. Beetstra, M. A. van der Hoef, J. A. M. Kuipers, AIChE J. 53 (2007) 489.
/// Valid:  Re < 1000, p < 0.6.
struct Beetstra {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const Real p = max(Real(1) - eps, Real(0)), eps2 = eps * eps;
    const Real log_Re = exact_log2(detail::guarded(Re));
    const Real above = Real(1) / eps + Real(3) * eps * p +
                       lanes_of<Real>(8.4) * exact_exp2(Real(lanes_of<Real>(-0.343) * log_Re));
    const Real below = Real(1) + exact_exp2(Real(lanes_of<Real>(3 * 3.3219280948873623) * p -
                                                 (lanes_of<Real>(0.5) + Real(2) * p) * log_Re));
    return Real(10) * p / eps2 + eps2 * (Real(1) + lanes_of<Real>(1.5) * sqrt(p)) +
           lanes_of<Real>(0.413 / 24) * Re * above / (eps2 * below);
  }
};

/// Fhat of one size in a mixture over Fhat(eps, Re) of its mean size, y = d_i/<d>, <d> the Sauter
/// mean, sum n d^3/sum n d^2, and Re with <d>:
///   y + 0.064 y^3
/// The factor of the whole force, of model B, is eps y + (1 - eps) y^2 + 0.064 eps y^3, both forces
/// over 3 pi mu d_i eps W. The part (1 - eps) y^2 is the pressure gradient on the volume, which the
/// drag of model A does not contain; the rest is eps times the factor above. Apart from 0.064 y^3,
/// the drag of all sizes is that of <d> at any eps. With y = 1 the factor is 1.064: use it only for
/// mixtures, and for laws of Beetstra's kind.
/// Source: M. A. van der Hoef, R. Beetstra, J. A. M. Kuipers, J. Fluid Mech. 528 (2005) 233;
///         Beetstra 2007 as above, with erratum. Recalled: the print was not read. The source of
///         CFDEMcoupling-PFM (BeetstraDragPoly) has the factor above; that of MFIX (drag_gs.f) has
///         the factor of model B and, for model A, only y.
template <class Real>
inline Real polydisperse_factor(const Real& y) {
  return y * (Real(1) + detail::lanes_of<Real>(0.064) * y * y);
}

static_assert(DragLaw<Beetstra>);

}  // namespace silt
