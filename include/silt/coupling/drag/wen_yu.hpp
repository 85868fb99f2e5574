// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/lone_sphere.hpp>

namespace silt::inline SILT_TARGET {

/// Drag in fluidised beds, especially dilute ones: Fhat = (C_D Re/24) eps^-3.65, C_D of
/// schiller_naumann().
/// Source: C. Y. Wen, Y. H. Yu, Chem. Eng. Prog. Symp. Ser. 62 (1966) 100.
/// Valid:  eps from 0.7 (for measurements of beds 0.4) to 1.
/// Tests:  tests/coupling/drag.cpp, as all sphere laws.
struct WenYu {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    return schiller_naumann(Re) * power(eps, detail::lanes_of<Real>(-3.65));
  }
};

static_assert(DragLaw<WenYu>);

}  // namespace silt
