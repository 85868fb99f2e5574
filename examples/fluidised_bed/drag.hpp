// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/laws.hpp>

namespace fluidised {

/// A drag law of one's own: Ergun's equation with the constants that a column of these grains gave
/// (here 180 and 1.8: I. F. Macdonald et al., Ind. Eng. Chem. Fundam. 18 (1979) 199; recalled), Wen
/// and Yu's law where grains are few.
struct OwnDrag {
  double viscous = 180, inertial = 1.8;  // [-]

  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    const Real packed =
        (Real(viscous / 18) * (Real(1) - eps) + Real(inertial / 18) * Re) / (eps * eps);
    return silt::select(eps < Real(0.8), packed, silt::WenYu{}.normalised(eps, Re));
  }
};

/// The law of --drag. One type, so that the bed is compiled once; `law` is the same for all grains,
/// an `if` on it is right on lanes, too.
struct BedDrag {
  enum class Law { Ergun, Gidaspow, Syamlal, Own } law;
  silt::SyamlalOBrien syamlal{};

  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    if (law == Law::Ergun) return silt::Ergun{}.normalised(eps, Re);
    if (law == Law::Syamlal) return syamlal.normalised(eps, Re);
    if (law == Law::Own) return OwnDrag{}.normalised(eps, Re);
    return silt::Gidaspow{}.normalised(eps, Re);
  }
};

}  // namespace fluidised
