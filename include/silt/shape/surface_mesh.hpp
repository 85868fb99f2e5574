// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>

namespace silt::inline SILT_TARGET {

/// Triangles to display a shape, outward side in front, in its own frame.
struct SurfaceMesh {
  DynArray<Vec3d> points;  // [m]
  DynArray<std::array<std::uint32_t, 3>> triangles;
};

namespace detail {

/// The cube from -1 to 1 with a grid of `cells` by `cells` per face, each point moved to
/// place(point).
template <class Place>
SurfaceMesh moved_cube(int cells, const Place& place) {
  require(cells >= 1, "surface_of: cells = ", cells, " [-] must be at least 1");
  SurfaceMesh mesh;
  const int n = cells + 1;
  // Points of the cube, in steps of the grid, that already exist: they are shared by faces.
  DynArray<std::uint32_t> made(static_cast<std::size_t>(n) * n * n, ~0u);
  const auto point = [&](const std::array<int, 3>& at) {
    auto& index = made[(static_cast<std::size_t>(at[0]) * n + at[1]) * n + at[2]];
    if (index == ~0u) {
      index = static_cast<std::uint32_t>(mesh.points.size());
      const auto along = [&](int k) { return std::clamp(2.0 * at[k] / cells - 1, -1.0, 1.0); };
      mesh.points.push_back(place(Vec3d{along(0), along(1), along(2)}));
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

/// Adds another mesh, first rotated, then moved.
inline void append(SurfaceMesh& all, const SurfaceMesh& more, const Vec3d& move,
                   const Quaternion& turn) {
  const auto first = static_cast<std::uint32_t>(all.points.size());
  for (const Vec3d& p : more.points) all.points.push_back(move + rotate(turn, p));
  for (const auto& t : more.triangles)
    all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace detail

/// Surface of a super-ellipsoid on the rays through a grid of `cells` by `cells` on each face of
/// its bounding box; edges and corners of the body are on lines of the grid.
/// Tests: tests/shape/super_ellipsoid.cpp.
inline SurfaceMesh surface_of(const SuperEllipsoid& shape, int cells = 8) {
  return detail::moved_cube(cells, [&](const Vec3d& x) {
    return shape.surface_point({shape.a * x.x, shape.b * x.y, shape.c * x.z});
  });
}
inline SurfaceMesh surface_of(const PolySuperEllipsoid& shape, int cells = 8) {
  return detail::moved_cube(cells, [&](const Vec3d& x) {
    const SuperEllipsoid octant = shape.octant(x);
    return octant.surface_point({octant.a * x.x, octant.b * x.y, octant.c * x.z});
  });
}
inline SurfaceMesh surface_of(const Sphere&, int cells = 8) {
  return surface_of(SuperEllipsoid{1, 1, 1}, cells);
}
inline SurfaceMesh surface_of(const MultiSphere& shape, int cells = 6) {
  SurfaceMesh all;
  for (const Ball& b : shape.balls)
    detail::append(all, surface_of(SuperEllipsoid{b.radius, b.radius, b.radius}, cells), b.centre,
                   {});
  return all;
}
/// Surface of a dilated polyhedron, by its points with normals through the grid.
inline SurfaceMesh surface_of(const Polyhedron& shape, int cells = 24) {
  if (shape.radius() > 0)
    return detail::moved_cube(cells, [&](const Vec3d& x) {
      const Vec3d n = normalised(x);
      return shape.support(n) + shape.radius() * n;
    });
  SurfaceMesh mesh{shape.vertices(), {}};
  for (const auto& face : shape.faces()) {
    const auto corner = shape.loop(face);
    for (std::size_t k = 2; k < corner.size(); ++k)
      mesh.triangles.push_back({corner[0], corner[k - 1], corner[k]});
  }
  return mesh;
}
template <class S>
SurfaceMesh surface_of(const Compound<S>& shape) {
  SurfaceMesh all;
  for (const auto& part : shape.parts)
    detail::append(all, surface_of(part.shape), part.centre, part.axes);
  return all;
}
template <class... Shapes>
SurfaceMesh surface_of(const Mix<Shapes...>& mix) {
  return std::visit([](const auto& form) { return surface_of(form); }, mix.shape);
}

}  // namespace silt
