// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Drag fitted to lattice-Boltzmann results, p = 1 - eps:
///   Fhat = eps (F0 + F3 Re/2),  F3 = 0.0673 + 0.212 p + 0.0232/eps^5
///   F0 = [1 + 3 sqrt(p/2) + (135/64) p ln p + 16.14 p]/[1 + 0.681 p - 8.48 p^2 + 8.16 p^3] below
///        p = 0.4, 10 p/eps^3 from there on
/// The force in the source includes the mean pressure gradient; the factor eps removes it.
/// Source: D. L. Koch, R. J. Hill, Annu. Rev. Fluid Mech. 33 (2001) 619; R. J. Hill, D. L. Koch,
///         A. J. C. Ladd, J. Fluid Mech. 448 (2001) 213 and 243.
/// Valid:  Re from about 40 on, or slow flow; the transition between (Re^2) is left out.
struct KochHill {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const Real p = max(Real(1) - eps, Real(0)), eps2 = eps * eps;
    const Real logarithm = natural_log(Real(max(p, lanes_of<Real>(1e-30))));
    const Real above = Real(1) + lanes_of<Real>(2.1213203435596424) * sqrt(p) +
                       p * (lanes_of<Real>(135.0 / 64) * logarithm + lanes_of<Real>(16.14));
    const Real below = Real(1) + p * (lanes_of<Real>(0.681) +
                                      p * (lanes_of<Real>(-8.48) + lanes_of<Real>(8.16) * p));
    const Real F0 = select(p < lanes_of<Real>(0.4), above / below, Real(10) * p / (eps2 * eps));
    const Real F3 = lanes_of<Real>(0.0673) + lanes_of<Real>(0.212) * p +
                    lanes_of<Real>(0.0232) / (eps2 * eps2 * eps);
    return eps * (F0 + lanes_of<Real>(0.5) * F3 * Re);
  }
};

static_assert(DragLaw<KochHill>);

}  // namespace silt
