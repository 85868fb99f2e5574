// silt - BSD-3-Clause, see LICENSE
// refused: an observer must be callable with the simulation
// in at most 40 lines of g++
#include "scene.hpp"

inline void schedule_alone() {
  silt::Simulation sim{beads, contacts};
#if defined(SILT_MENDED)
  sim.run(1.0, silt::at(silt::every(0.1), [](const auto&) {}));
#else
  sim.run(1.0, silt::every(0.1));
#endif
}
