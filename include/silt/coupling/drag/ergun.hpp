// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/wen_yu.hpp>

namespace silt::inline SILT_TARGET {

/// Drag in packed beds: Fhat = [150 (1 - eps)/eps + 1.75 Re/eps]/(18 eps).
/// Source: S. Ergun, Chem. Eng. Prog. 48 (1952) 89.
/// Valid:  eps < 0.8; no viscous drag on a single sphere (eps = 1).
struct Ergun {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    return (lanes_of<Real>(150.0 / 18) * (Real(1) - eps) + lanes_of<Real>(1.75 / 18) * Re) /
           (eps * eps);
  }
};

/// Drag by Ergun for eps < 0.8, by Wen-Yu otherwise. It jumps at eps = 0.8: at Re = 100 from 17.8
/// to 10.3.
/// Source: D. Gidaspow, Multiphase Flow and Fluidization (1994), ch. 2.
/// Valid:  as Ergun and WenYu; not where the jump at eps = 0.8 is important.
struct Gidaspow {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    return select(eps < detail::lanes_of<Real>(0.8), Ergun().normalised(eps, Re),
                  WenYu().normalised(eps, Re));
  }
};

/// Gidaspow's law without the jump: (1 - b) Ergun + b Wen-Yu,
///   b = atan(262.5 (0.2 - (1 - eps)))/pi + 1/2
/// Source: L. Huilin, D. Gidaspow, Chem. Eng. Sci. 58 (2003) 3777.
/// Valid:  as Ergun and WenYu.
struct HuilinGidaspow {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    using detail::lanes_of;
    const Real x = lanes_of<Real>(262.5) * (eps - lanes_of<Real>(0.8));
    const Real b = lanes_of<Real>(1 / std::numbers::pi) * arc_tangent(x) + lanes_of<Real>(0.5);
    const Real packed = Ergun().normalised(eps, Re);
    return packed + b * (WenYu().normalised(eps, Re) - packed);
  }
};

static_assert(DragLaw<Ergun> && DragLaw<Gidaspow> && DragLaw<HuilinGidaspow>);

}  // namespace silt
