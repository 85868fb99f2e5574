// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/coupling/drag/laws.hpp>

namespace fluidised {

/// A user-defined drag law: Ergun's equation with the constants measured for a column of these
/// grains (here 180 and 1.8: I. F. Macdonald et al., Ind. Eng. Chem. Fundam. 18 (1979) 199;
/// recalled), Wen and Yu's law in dilute regions.
struct OwnDrag {
  double viscous = 180, inertial = 1.8;  // [-]

  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    const Real packed =
        (Real(viscous / 18) * (Real(1) - eps) + Real(inertial / 18) * Re) / (eps * eps);
    return silt::select(eps < Real(0.8), packed, silt::WenYu{}.normalised(eps, Re));
  }
};

/// The law selected by --drag. One type, to compile the bed once; `law` is the same for all grains,
/// so an `if` on it is allowed in batches too.
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
