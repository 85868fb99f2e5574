// silt - BSD-3-Clause, see LICENSE
// refused: a module's check() does not fit
#include "scene.hpp"

// A check() that would never be called: it takes the simulation.
struct Checked {
  double power = -1;  // [W]
  silt::Vec3d force(const silt::Seen&) const { return {power, 0, 0}; }
#if defined(SILT_MENDED)
  void check(const auto&) const { silt::require(power > 0, "Checked.power must be positive"); }
#else
  void check() const { silt::require(power > 0, "Checked.power must be positive"); }
#endif
};

inline void run() {
  silt::Simulation sim{beads, contacts, Checked{}};
  sim.run(1);
}
