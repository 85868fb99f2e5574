// silt - BSD-3-Clause, see LICENSE
// refused: FluidConvection exchanges heat with a CoupledFlow: give the simulation one
#include <silt/fluid.hpp>

#include "scene.hpp"

inline void run() {
  const silt::Heat grains{silt::HeatConduction{.conductivity = 1, .heat_capacity = 800},
                          silt::FluidConvection<>{}};
#if defined(SILT_MENDED)
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2}), {1.2, 1.8e-5});
  flow.set_heat({.heat_capacity = 1005, .conductivity = 0.026});
  silt::Simulation sim{beads, contacts, grains,
                       silt::CoupledFlow{silt::Ergun{}, silt::Kernel{}, std::move(flow)}};
#else
  silt::Simulation sim{beads, contacts, grains};
#endif
  sim.run(1.0);
}
