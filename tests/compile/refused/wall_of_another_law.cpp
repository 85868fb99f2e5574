// silt - BSD-3-Clause, see LICENSE
// refused: the material is of another law than that of Contacts<Law>: give a Law::Material
// in at most 24 lines of g++
#include "scene.hpp"

inline void use() {
  silt::Simulation sim{beads, contacts};
#if defined(SILT_MENDED)
  const silt::HertzMindlin::Material steel = glass;
#else
  const silt::LinearSpringFriction::Material steel{.stiffness = 1e4};
#endif
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel, {.name = "floor"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel, silt::translation({0, 0, 1}));
}
