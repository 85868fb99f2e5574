// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/convex_hull.hpp>

namespace silt::inline SILT_TARGET {

/// Convex body as a graph with three edges at each vertex, the form that is cut by half-spaces
/// fastest (narrow/clip.hpp). A corner with more edges is a chain of vertices at one point.
///
/// Neighbours are ordered as in a walk with a face on its left: a walk that arrives from neighbour
/// k continues to neighbour k + 1 (mod 3) along the same face.
struct ClipVertex {
  Vec3d at;  // [m]
  std::uint16_t neighbour[3];
  std::uint16_t face[3];  // left of the edge to neighbour k
};

namespace detail {

/// Neighbours of each vertex in order, and the face left of the edge to each.
struct Fan {
  DynArray<std::uint32_t> neighbour, face;

  std::size_t slot_of(std::uint32_t other) const {
    std::size_t k = 0;
    while (neighbour[k] != other) ++k;
    return k;
  }
};

inline DynArray<Fan> vertex_fans(const ConvexFaces& body) {
  struct Step {
    std::uint32_t from, to, face;
  };
  DynArray<DynArray<Step>> steps(body.vertices.size());  // through each vertex
  for (std::uint32_t f = 0; f < body.faces.size(); ++f) {
    const auto& loop = body.faces[f];
    for (std::size_t k = 0; k < loop.size(); ++k)
      steps[loop[k]].push_back(
          {loop[(k + loop.size() - 1) % loop.size()], loop[(k + 1) % loop.size()], f});
  }
  DynArray<Fan> fans(body.vertices.size());
  for (std::size_t v = 0; v < fans.size(); ++v) {
    auto at = steps[v].front();
    for (std::size_t k = 0; k < steps[v].size(); ++k) {
      fans[v].neighbour.push_back(at.to), fans[v].face.push_back(at.face);
      for (const auto& step : steps[v])
        if (step.from == fans[v].neighbour.back()) {
          at = step;
          break;
        }
    }
    require(fans[v].neighbour.size() >= 3 && at.to == fans[v].neighbour.front(),
            "Polyhedron: the faces around the vertex ", body.vertices[v], " [m] do not close");
  }
  return fans;
}

/// Slot k of a vertex with n edges is at link min(max(k, 1), n - 2) - 1 of its chain of n - 2.
inline DynArray<ClipVertex> clip_graph(const ConvexFaces& body) {
  const auto fans = vertex_fans(body);
  DynArray<std::size_t> first(fans.size() + 1, 0);
  for (std::size_t v = 0; v < fans.size(); ++v)
    first[v + 1] = first[v] + fans[v].neighbour.size() - 2;
  const auto link_of = [&](std::uint32_t v, std::size_t slot) {
    const std::size_t n = fans[v].neighbour.size();
    return static_cast<std::uint16_t>(first[v] + std::min(std::max<std::size_t>(slot, 1), n - 2) -
                                      1);
  };
  DynArray<ClipVertex> graph;
  for (std::uint32_t v = 0; v < fans.size(); ++v) {
    const auto& fan = fans[v];
    const std::size_t n = fan.neighbour.size();
    for (std::size_t link = 0; link < n - 2; ++link) {
      ClipVertex out{body.vertices[v], {}, {}};
      const auto to = [&](std::size_t k, std::size_t slot) {
        const auto other = fan.neighbour[slot];
        out.neighbour[k] = link_of(other, fans[other].slot_of(v));
        out.face[k] = static_cast<std::uint16_t>(fan.face[slot]);
      };
      if (link == 0)
        to(0, 0);
      else  // back along the chain: on the left is the face from the last neighbour to the first
        out.neighbour[0] = static_cast<std::uint16_t>(graph.size() - 1),
        out.face[0] = static_cast<std::uint16_t>(fan.face[0]);
      to(1, link + 1);
      if (link + 3 == n)
        to(2, n - 1);
      else
        out.neighbour[2] = static_cast<std::uint16_t>(graph.size() + 1),
        out.face[2] = static_cast<std::uint16_t>(fan.face[link + 2]);
      graph.push_back(out);
    }
  }
  return graph;
}

}  // namespace detail

}  // namespace silt
