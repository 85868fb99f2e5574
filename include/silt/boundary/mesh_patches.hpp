// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>

/// Fourth part of TriangleMesh: its patches.

namespace silt::inline SILT_TARGET {

/// Divides the mesh into patches: connected triangles whose normals are within 60 degrees of that
/// of the first triangle, or of its opposite. Floor and walls of a box are separate patches; rough
/// ground is one. Each patch starts at the largest remaining triangle. Surfaces without common
/// vertices are connected where the middle of a free side lies on another triangle.
inline DynArray<std::uint32_t> TriangleMesh::find_patches() const {
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  constexpr double least_cosine = 0.5;
  const auto count = static_cast<std::uint32_t>(triangles_.size());

  // Neighbours across free sides, in both directions.
  DynArray<std::array<std::uint32_t, 2>> seams;
  DynArray<std::uint32_t> near;
  for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
    const auto sharing = topology_.triangles_at_edge[static_cast<std::uint32_t>(e)];
    if (sharing.size() != 1) continue;
    const auto& edge = topology_.edges[e];
    const Vec3d middle = 0.5 * (vertices_[edge.from] + vertices_[edge.to]);
    triangles_near(middle, 2 * plane_tolerance_, near);
    for (const auto other : near)
      if (other != sharing[0])
        seams.push_back({sharing[0], other}), seams.push_back({other, sharing[0]});
  }
  std::sort(seams.begin(), seams.end());

  DynArray<double> area(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = triangles_[t];
    const Vec3d& at = vertices_[a];
    // Rounded, so that triangles of the same size have the same, wherever the mesh is.
    area[t] = static_cast<float>(norm(cross(vertices_[b] - at, vertices_[c] - at)));
  }
  DynArray<std::uint32_t> largest_first(count);
  std::iota(largest_first.begin(), largest_first.end(), 0u);
  std::stable_sort(largest_first.begin(), largest_first.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return area[a] > area[b]; });

  DynArray<std::uint32_t> patch(count, none), open;
  std::uint32_t patches = 0;
  for (const auto seed : largest_first) {
    if (patch[seed] != none) continue;
    const auto visit = [&](std::uint32_t t) {
      if (patch[t] != none || std::abs(dot(normals_[t], normals_[seed])) < least_cosine) return;
      patch[t] = patches;
      open.push_back(t);
    };
    visit(seed);
    while (!open.empty()) {
      const auto t = open.back();
      open.pop_back();
      for (const auto edge : topology_.edges_of[t])
        for (const auto other : topology_.triangles_at_edge[edge]) visit(other);
      const std::array<std::uint32_t, 2> from{t, 0};
      for (auto s = std::lower_bound(seams.begin(), seams.end(), from);
           s != seams.end() && (*s)[0] == t; ++s)
        visit((*s)[1]);
    }
    ++patches;
  }
  return patch;
}

}  // namespace silt
