// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <engine/support.hpp>

#include <cmath>

#include <silt/core/random.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/simulation/contact_check.hpp>

namespace deforming_box_test {

using namespace engine_test;
using silt::Deformation;
using silt::DeformingBox;

/// n^3 spheres of 1 mm, displaced at random from a grid of this spacing [m], in the order of ids.
inline silt::Particles<Sphere> cloud(int n, double spacing, double speed = 0.1,
                                     const Vec3d& shift = {0, 0, 0}) {
  silt::Particles<Sphere> all;
  silt::Random random(7);
  const auto any = [&] { return 2 * random.uniform() - 1; };
  for (int k = 0; k < n * n * n; ++k) {
    const Vec3d cell{k % n + 0.5, k / n % n + 0.5, k / (n * n) + 0.5};
    const double x = any(), y = any(), z = any(), u = any(), v = any(), w = any();
    all.add({.position = spacing * cell + 0.5 * (spacing - 1e-3) * Vec3d{x, y, z} + shift,
             .radius = 0.5e-3,
             .density = 2500,
             .velocity = speed * Vec3d{u, v, w}});
  }
  return all;
}
inline DeformingBox cube(double length, const Deformation& how = {}) {
  return DeformingBox({{0, 0, 0}, {length, length, length}}, how);
}
template <class... More>
auto sheared(const silt::Particles<Sphere>& of, const DeformingBox& box, const More&... more) {
  return silt::Simulation{of, silt::Contacts<HertzMindlin>{rubber}, box, more...};
}

}  // namespace deforming_box_test
