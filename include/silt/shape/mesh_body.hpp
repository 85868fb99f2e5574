// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/boundary/wall_drive.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/shape/triangle_moments.hpp>

namespace silt::inline SILT_TARGET {

/// Closed mesh as a rigid body of this density [kg/m3]: mass, centre and inertia of its interior,
/// for either orientation of its triangles. Velocities are 0 until set.
///   silt::FreeBody body = silt::free_body(mesh, 7800);
/// Shells within shells, and parts of shells that overlap, count as often as they enclose a place.
/// Errors: InputError for a mesh that is not closed or holds triangles twice, and a density that is not positive.
/// Tests:  tests/engine/free_walls.cpp
inline FreeBody free_body(const TriangleMesh& mesh, double density) {
  require_positive("free_body: density", density, "kg/m3");
  require(mesh.is_closed(),
          "free_body: the mesh is not closed and encloses no volume; close "
          "it, or give mass, inertia and centre of a FreeBody");
  detail::require_single("free_body", mesh.triangles());
  DynArray<std::array<Vec3d, 3>> soup;
  const bool outwards = mesh.volume() > 0;
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vec3d &a = mesh.vertices()[i], &b = mesh.vertices()[j], &c = mesh.vertices()[k];
    soup.push_back(outwards ? std::array{a, b, c} : std::array{a, c, b});
  }
  const MassProperties m = mass_properties(soup);
  // R diag(I) R^T
  const Vec3d x = rotate(m.axes, {1, 0, 0}), y = rotate(m.axes, {0, 1, 0}),
              z = rotate(m.axes, {0, 0, 1});
  Symmetric3 inertia = (density * m.inertia.x) * outer(x);
  inertia += (density * m.inertia.y) * outer(y), inertia += (density * m.inertia.z) * outer(z);
  return {.mass = density * m.volume, .inertia = inertia, .centre = m.centroid};
}

}  // namespace silt
