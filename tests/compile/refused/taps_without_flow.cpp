// silt - BSD-3-Clause, see LICENSE
// refused: observers of a flow (flow_probes, pressure_taps, flow_profile, flow_average) need a
// simulation
#include <silt/fluid.hpp>

#include "scene.hpp"

inline void measure() {
#if defined(SILT_MENDED)
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2}), {1.2, 1.8e-5});
  silt::Simulation sim{beads, contacts,
                       silt::CoupledFlow{silt::Ergun{}, silt::Kernel{}, std::move(flow)}};
#else
  silt::Simulation sim{beads, contacts};
#endif
  sim.run(1.0, silt::pressure_taps("taps.csv", {{"low", {0.5, 0.5, 0.5}}}, silt::every(0.1)));
}
