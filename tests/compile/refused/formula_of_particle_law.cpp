// silt - BSD-3-Clause, see LICENSE
// refused: take a drag law of void fraction and Reynolds number
#include <silt/fluid.hpp>

/// A law of a particle in the fluid has no Reynolds number of balance of its own.
struct ParticleDrag {
#if defined(SILT_MENDED)
  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return Real(1) / eps;
  }
#else
  double normalised(const silt::InFluid& at, double) const { return 1 / at.voidage; }
#endif
};

inline double reynolds() { return silt::balance_reynolds(ParticleDrag{}, 0.5, 1e-3); }
