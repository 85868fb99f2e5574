// silt - BSD-3-Clause, see LICENSE
// refused: a flow given to Simulation is not coupled with the particles: wrap it in
// silt::CoupledFlow
#include <silt/fluid.hpp>

#include "scene.hpp"

inline auto simulate([[maybe_unused]] const silt::FlowSolver& flow) {
#if defined(SILT_MENDED)
  return silt::Simulation{beads, contacts,
                          silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow}};
#else
  return silt::Simulation{beads, contacts, flow};
#endif
}
