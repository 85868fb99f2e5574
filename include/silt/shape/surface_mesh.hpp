// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <silt/shape/super_ellipsoid.hpp>

namespace silt::inline SILT_TARGET {

/// Triangles that show a shape, outward side to the front, in its own frame.
struct SurfaceMesh {
  std::vector<Vec3d> points;  // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The surface of a super-ellipsoid on the rays through a grid of `cells` by `cells` on each face
/// of the box around it; edges and corners of the body lie on lines of the grid.
/// Tests: tests/shape/super_ellipsoid.cpp.
inline SurfaceMesh surface_of(const SuperEllipsoid& shape, int cells = 8) {
  require(cells >= 1, "surface_of: cells = ", cells, " [-] must be at least 1");
  SurfaceMesh mesh;
  const int n = cells + 1;
  // Places on the box, in steps of the grid, that a point has been made for: shared by faces.
  std::vector<std::uint32_t> made(static_cast<std::size_t>(n) * n * n, ~0u);
  const auto point = [&](const std::array<int, 3>& at) {
    auto& index = made[(static_cast<std::size_t>(at[0]) * n + at[1]) * n + at[2]];
    if (index == ~0u) {
      index = static_cast<std::uint32_t>(mesh.points.size());
      const auto along = [&](int k) { return std::clamp(2.0 * at[k] / cells - 1, -1.0, 1.0); };
      mesh.points.push_back(
          shape.surface_point({shape.a * along(0), shape.b * along(1), shape.c * along(2)}));
    }
    return index;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, cells})
      for (int u = 0; u < cells; ++u)
        for (int v = 0; v < cells; ++v) {
          const auto corner = [&](int du, int dv) {
            std::array<int, 3> at{};
            at[axis] = side, at[(axis + 1) % 3] = u + du, at[(axis + 2) % 3] = v + dv;
            return point(at);
          };
          const std::uint32_t p = corner(0, 0), q = corner(1, 0), r = corner(1, 1),
                              s = corner(0, 1);
          if (side == 0)
            mesh.triangles.push_back({p, r, q}), mesh.triangles.push_back({p, s, r});
          else
            mesh.triangles.push_back({p, q, r}), mesh.triangles.push_back({p, r, s});
        }
  return mesh;
}

}  // namespace silt
