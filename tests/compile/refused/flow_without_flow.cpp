// silt - BSD-3-Clause, see LICENSE
// refused: CoupledFlow needs the flow: give one silt::FlowSolver
#include <silt/fluid.hpp>

inline auto fluid([[maybe_unused]] const silt::FlowSolver& flow) {
#if defined(SILT_MENDED)
  return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow};
#else
  return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}};
#endif
}
