// silt - BSD-3-Clause, see LICENSE
// refused: a drag law's normalised() does not fit
#include <silt/fluid.hpp>

/// A law with a branch, of a particle in the fluid.
struct BranchedDrag {
#if defined(SILT_MENDED)
  double normalised(const silt::InFluid& at, double Re) const {
    return (Re < 1 ? 1 : 2) / at.voidage;
  }
#else
  double normalised(const silt::InFluid& at) const { return 1 / at.voidage; }
#endif
};

inline auto fluid([[maybe_unused]] const silt::FlowSolver& flow) {
  return silt::CoupledFlow{BranchedDrag{}, silt::Kernel{}, flow};
}
