// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/lone_sphere.hpp>

namespace silt::inline SILT_TARGET {

/// Drag fitted to particle-resolved simulations of fixed random arrays, p = 1 - eps:
///   Fhat = eps [F_i/eps^3 + 5.81 p/eps^3 + 0.48 p^(1/3)/eps^4
///               + p^3 Re (0.95 + 0.61 p^3/eps^2)],  F_i of schiller_naumann()
/// The force in the source includes the mean pressure gradient; the factor eps removes it.
/// Source: S. Tenneti, R. Garg, S. Subramaniam, Int. J. Multiphase Flow 37 (2011) 1072.
/// Valid:  Re < 300, 0.1 <= p <= 0.5.
struct Tenneti {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const Real p = max(Real(1) - eps, Real(0)), eps2 = eps * eps, p3 = p * p * p;
    const Real root = power(Real(max(p, lanes_of<Real>(1e-30))), lanes_of<Real>(1.0 / 3));
    return (schiller_naumann(Re) + lanes_of<Real>(5.81) * p + lanes_of<Real>(0.48) * root / eps) /
               eps2 +
           eps * p3 * Re * (lanes_of<Real>(0.95) + lanes_of<Real>(0.61) * p3 / eps2);
  }
};

static_assert(DragLaw<Tenneti>);

}  // namespace silt
