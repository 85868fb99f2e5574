// silt - BSD-3-Clause, see LICENSE
// refused: declare it with `auto` in place of `const auto`
// in at most 40 lines of g++
#include "scene.hpp"

inline void watch() {
  silt::Simulation sim{beads, contacts};
#if !defined(SILT_MENDED)
  const
#endif
      auto look = silt::at(silt::every(0.1), [](const auto&) {});
  sim.run(1.0, look);
}
