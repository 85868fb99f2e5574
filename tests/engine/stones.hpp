// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/polyhedron.hpp>

#include "engine/support.hpp"

namespace engine_test {

inline HertzMindlin::Material stone(double restitution, double friction) {
  return {.youngs_modulus = 1e7,
          .poisson_ratio = 0.3,
          .restitution = restitution,
          .friction = friction};
}

/// Of half edges a, b, c [m].
inline silt::Polyhedron block(double a, double b, double c, double dilation = 0) {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return silt::Polyhedron::from_points(corners, dilation);
}

}  // namespace engine_test
