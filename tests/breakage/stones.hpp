// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/shape/polyhedron.hpp>

namespace breakage_scene {

/// A convex stone of 14 corners, which lie on a sphere of 1 mm about the origin.
inline silt::Polyhedron stone(std::uint64_t seed = 9) {
  std::vector<silt::Vec3d> corners;
  silt::Random random(seed);
  for (int k = 0; k < 14; ++k) {
    const silt::Vec3d p{random.normal(), random.normal(), random.normal()};
    corners.push_back((1e-3 / norm(p)) * p);
  }
  return silt::Polyhedron::from_points(corners);
}

}  // namespace breakage_scene
