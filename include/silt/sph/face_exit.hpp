// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

inline Vec3d absolute(const Vec3d& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

/// The order in which faces of equal distance are taken: by nearness of the normal to the x axis,
/// then y; then by side.
inline bool comes_first(const Vec3d& a, const Vec3d& b) {
  const Vec3d p = absolute(a), q = absolute(b);
  for (const auto d : {&Vec3d::x, &Vec3d::y, &Vec3d::z})
    if (std::abs(p.*d - q.*d) > 1e-6) return p.*d > q.*d;
  for (const auto d : {&Vec3d::x, &Vec3d::y, &Vec3d::z})
    if (std::abs(a.*d - b.*d) > 1e-6) return a.*d > b.*d;
  return false;
}

/// The way [m] out of a closed surface from a point x at a `depth` [m] behind several faces that
/// are equally near; none if one face is nearest. Rounding must not choose one of them: the
/// particles of a symmetric body would turn it. It leads through the face whose normal is nearest
/// to the x axis, then y, which keeps symmetry to both; for two that are mirror images of each
/// other to their common edge; for opposite ones to the first. `side`: 1 if the normals of the
/// triangles point to where the way leads, else -1.
inline std::optional<Vec3d> way_out(const TriangleMesh& surface, const Vec3d& x, double depth,
                                    double side) {
  const double slack = 1e-6 * depth;
  DynArray<std::uint32_t> near;
  surface.triangles_near(x, depth + slack, near);
  DynArray<Vec3d> normals;  // of the faces, each once
  for (const std::uint32_t t : near) {
    const Vec3d n = side * surface.normals()[t];
    const Vec3d to = surface.vertices()[surface.triangles()[t][0]] - x;
    const auto is_same = [&](const Vec3d& other) { return dot(n, other) > 1 - 1e-6; };
    if (std::abs(dot(n, to) - depth) < slack && surface.distance_to(t, x) < depth + slack &&
        std::none_of(normals.begin(), normals.end(), is_same))
      normals.push_back(n);
  }
  if (normals.size() < 2) return std::nullopt;
  std::sort(normals.begin(), normals.end(), comes_first);
  const Vec3d sum = normals[0] + normals[1];
  // Mirror images: neither comes first by the size of its components.
  if (norm(sum) > 0.1 && !comes_first(absolute(normals[0]), absolute(normals[1])))
    return depth * 2 / dot(sum, sum) * sum;  // n + m over 1 + n.m
  return depth * normals[0];
}

}  // namespace silt::detail
