// silt - BSD-3-Clause, see LICENSE
#pragma once

// The scenes in which the spheres of a file are timed: a bed that rests, a bed that flows against a
// side wall, and the hopper of examples/hopper while it empties.

#include <cmath>
#include <string>
#include <vector>

#include "../bed.hpp"
#include "hopper/scene.hpp"

namespace bench {

inline const silt::Vec3d tilted{9.81 * std::sqrt(0.5), 0, -9.81 * std::sqrt(0.5)};  // [m/s2]

/// The hopper of D. Markauskas et al. (2011) for the spheres of the bed: its upper and its lower
/// box have the width of the bed; the orifice is 14 spheres wide with up to 50 000 of them.
inline hopper::Scene hopper_for(std::size_t n) {
  return {.particles = n,
          .density = 2500,
          .width = width_for(n),
          .orifice = 0.4 * width_for(n),
          .r_min = 1.95e-3,
          .r_max = 2.35e-3};
}

/// Whether `name` is one of level|tilted|hopper.
inline bool is_scene(const std::string& name) {
  return name == "level" || name == "tilted" || name == "hopper";
}

/// Gravity and walls of a scene, for a bed of n spheres.
template <class Sim>
void set_scene(Sim& sim, const std::string& name, std::size_t n) {
  if (name == "tilted") sim.gravity = tilted;
  if (name == "hopper") {
    sim.add_wall(silt::TriangleMesh(hopper::floor_triangles(hopper_for(n))), material);
    sim.guard.max_overlap = 0.5;  // more could pass the mesh unseen
  }
}

}  // namespace bench
