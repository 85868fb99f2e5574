// silt - BSD-3-Clause, see LICENSE
// refused: work for any type of number: double, float and packs of them, one lane a particle
#include <silt/fluid.hpp>

/// For double alone.
struct DoubleDrag {
#if defined(SILT_MENDED)
  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return Real(1) / eps;
  }
#else
  double normalised(double eps, double) const { return 1 / eps; }
#endif
};

inline auto fluid(const silt::FlowSolver& flow) {
  return silt::CoupledFlow{DoubleDrag{}, silt::Kernel{}, flow};
}
