// silt - BSD-3-Clause, see LICENSE
// refused: the drag law compiles for double and float, but not for a pack of lanes
#include <silt/fluid.hpp>

/// For scalars alone.
struct ScalarDrag {
#if defined(SILT_MENDED)
  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return Real(1) / eps;
  }
#else
  double normalised(const double& eps, const double&) const { return 1 / eps; }
  float normalised(const float& eps, const float&) const { return 1 / eps; }
#endif
};

using Fluid = silt::CoupledFlow<ScalarDrag, silt::Kernel>;
static_assert(Fluid::active);
