// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
#include <silt/fluid.hpp>

/// Two ranges of Re, told apart by a branch.
struct TwoRanges {
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
#if defined(SILT_MENDED)
    return silt::select(Re < Real(1), Real(1), Real(1) + Real(0.1f) * Re) / eps;
#else
    if (Re < Real(1)) return Real(1) / eps;
    return (Real(1) + Real(0.1f) * Re) / eps;
#endif
  }
};

using Fluid = silt::CoupledFlow<TwoRanges, silt::Kernel>;
static_assert(Fluid::active);
