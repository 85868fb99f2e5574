// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>

/// Checks that a triangle mesh is the surface of one solid, and that this solid is convex.
/// Tests: tests/shape/polyhedron.cpp (each refusal)

namespace silt::inline SILT_TARGET {

namespace detail {

/// True if the segment from `p` to `q` passes through the inside of the triangle, by more than
/// `slack` [m] from its rim and its plane.
inline bool pierces(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle,
                    double slack) {
  const auto& [a, b, c] = triangle;
  const Vec3d up = cross(b - a, c - a);
  const double scale = norm(up), hp = dot(p - a, up), hq = dot(q - a, up);
  if (!(std::min(hp, hq) < -slack * scale && std::max(hp, hq) > slack * scale)) return false;
  const Vec3d at = p + (hp / (hp - hq)) * (q - p);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &from = triangle[k], side = triangle[(k + 1) % 3] - from;
    if (!(dot(cross(side, at - from), up) > slack * scale * norm(side))) return false;
  }
  return true;
}

inline void check_manifold(const MeshTopology& topology, std::size_t triangles,
                           const DynArray<Vec3d>& vertices) {
  for (std::uint32_t e = 0; e < topology.edges.size(); ++e)
    require(topology.triangles_at_edge[e].size() == 2,
            "Polyhedron: the mesh touches itself: ", topology.triangles_at_edge[e].size(),
            " triangles share the edge from ", vertices[topology.edges[e].from], " to ",
            vertices[topology.edges[e].to], " [m]; a solid has two at each edge");
  DynArray<char> seen(triangles, 0);
  for (std::uint32_t v = 0; v + 1 < topology.triangles_at_vertex.begin.size(); ++v) {
    const auto around = topology.triangles_at_vertex[v];
    if (around.empty()) continue;
    DynArray<std::uint32_t> fan{around[0]};
    seen[around[0]] = 1;
    for (std::size_t k = 0; k < fan.size(); ++k)
      for (const auto e : topology.edges_of[fan[k]]) {
        if (topology.edges[e].from != v && topology.edges[e].to != v) continue;
        for (const auto t : topology.triangles_at_edge[e])
          if (!seen[t]) seen[t] = 1, fan.push_back(t);
      }
    for (const auto t : fan) seen[t] = 0;
    require(fan.size() == around.size(), "Polyhedron: the mesh touches itself at the vertex ",
            vertices[v], " [m], where two of its parts meet in one point");
  }
}

inline void check_apart(const TriangleMesh& mesh, const MeshTopology& topology, double slack) {
  const auto corners = [&](std::uint32_t t) {
    const auto& [i, j, k] = mesh.triangles()[t];
    return std::array{mesh.vertices()[i], mesh.vertices()[j], mesh.vertices()[k]};
  };
  DynArray<std::uint32_t> near;
  for (const auto& edge : topology.edges) {
    const Vec3d &p = mesh.vertices()[edge.from], &q = mesh.vertices()[edge.to];
    mesh.triangles_near(0.5 * (p + q), 0.5 * edge.length + slack, near);
    for (const auto t : near)
      require(!pierces(p, q, corners(t), slack),
              "Polyhedron: the mesh passes through itself: the "
              "edge from ",
              p, " to ", q, " [m] pierces triangle ", t, " (counted from 0)");
  }
}

}  // namespace detail

/// InputError, with one sentence, unless the triangles bound one solid: closed, oriented outwards,
/// two triangles at each edge, one fan at each vertex, no edge through a triangle.
inline TriangleMesh solid_mesh(const DynArray<std::array<Vec3d, 3>>& triangles) {
  TriangleMesh mesh(triangles);
  require(mesh.is_closed(),
          "Polyhedron: the mesh is open or its triangles are not oriented the same "
          "way; close its gaps and order each triangle counter-clockwise seen from outside");
  require(mesh.volume() > 0, "Polyhedron: the mesh is inside out (its volume is ", mesh.volume(),
          " [m3]); order its triangles counter-clockwise seen from outside");
  const detail::MeshTopology topology(mesh.vertices(), mesh.triangles());
  detail::check_manifold(topology, mesh.triangles().size(), mesh.vertices());
  detail::check_apart(mesh, topology, 1e-9 * norm(mesh.bounds().extent()));
  return mesh;
}

/// Largest height [m] of a vertex above the plane of a triangle: 0 to rounding for a convex solid.
inline double largest_dent(const TriangleMesh& mesh) {
  double dent = 0;
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vec3d& a = mesh.vertices()[i];
    const Vec3d up = normalised(cross(mesh.vertices()[j] - a, mesh.vertices()[k] - a));
    for (const auto& v : mesh.vertices()) dent = std::max(dent, dot(v - a, up));
  }
  return dent;
}

}  // namespace silt
