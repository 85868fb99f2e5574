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

static_assert(DragLaw<Beetstra>);

}  // namespace silt
