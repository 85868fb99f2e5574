// silt - BSD-3-Clause, see LICENSE
// refused: Simulation needs one contact law: give silt::Contacts<Law>{material}
// in at most 15 lines of g++
#include "scene.hpp"

/// As a first program may look: the lines that follow must not add to what is wrong.
inline void run() {
#if defined(SILT_MENDED)
  silt::Simulation sim{beads, contacts};
#else
  silt::Simulation sim{beads, silt::HertzMindlin{}};
#endif
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.1}), glass);
  sim.run(1.0, silt::vtk_series("out", silt::every(0.01)), silt::progress());
}
