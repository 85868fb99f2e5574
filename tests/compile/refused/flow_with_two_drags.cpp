// silt - BSD-3-Clause, see LICENSE
// refused: an argument of CoupledFlow is of a wrong type, or there is one too many
#include <silt/fluid.hpp>

inline auto fluid([[maybe_unused]] const silt::FlowSolver& flow) {
#if defined(SILT_MENDED)
  return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow};
#else
  return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow, silt::DiFelice{}};
#endif
}
