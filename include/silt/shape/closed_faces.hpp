// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/convex_hull.hpp>

/// Checks that given corners and faces bound one convex body.
/// Tests: tests/shape/closed_faces.cpp (each refusal)

namespace silt::inline SILT_TARGET::detail {

/// Directed edges of faces, each with the face on its left.
class FaceWays {
 public:
  struct Way {
    std::uint32_t from, to;
    std::uint32_t before;  // predecessor of `from` in the loop of the face
    auto key() const { return std::uint64_t{from} << 32 | to; }
  };

  explicit FaceWays(const ConvexFaces& body) {
    for (const auto& loop : body.faces)
      for (std::size_t k = 0, n = loop.size(); k < n; ++k)
        ways_.push_back({loop[k], loop[(k + 1) % n], loop[(k + n - 1) % n]});
    std::sort(ways_.begin(), ways_.end(),
              [](const Way& a, const Way& b) { return a.key() < b.key(); });
  }
  const DynArray<Way>& all() const { return ways_; }
  /// Null if no face has this directed edge.
  const Way* find(std::uint32_t from, std::uint32_t to) const {
    const Way wanted{from, to, 0};
    const auto at = std::lower_bound(ways_.begin(), ways_.end(), wanted,
                                     [](const Way& a, const Way& b) { return a.key() < b.key(); });
    return at != ways_.end() && at->key() == wanted.key() ? &*at : nullptr;
  }

 private:
  DynArray<Way> ways_;  // sorted by their start
};

inline void check_loops(const ConvexFaces& body) {
  const std::size_t corners = body.vertices.size();
  require(corners >= 4 && body.faces.size() >= 4, "Polyhedron: ", corners, " corners and ",
          body.faces.size(), " faces; a body has 4 of each at least");
  for (std::size_t v = 0; v < corners; ++v)
    require(is_finite(body.vertices[v]), "Polyhedron: corner ", v, " is ", body.vertices[v],
            " [m]; corners must be finite");
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    auto loop = body.faces[f];
    require(loop.size() >= 3, "Polyhedron: face ", f, " has ", loop.size(),
            " corners; three are the least");
    std::sort(loop.begin(), loop.end());
    require(loop.back() < corners, "Polyhedron: face ", f, " has corner ", loop.back(), " of ",
            corners);
    require(std::adjacent_find(loop.begin(), loop.end()) == loop.end(), "Polyhedron: face ", f,
            " has a corner twice");
  }
}

/// One closed surface without handles, with all faces oriented the same way.
inline void check_closed(const ConvexFaces& body) {
  const std::size_t corners = body.vertices.size();
  const FaceWays ways(body);
  DynArray<std::uint32_t> around(corners, 0), group(corners);
  std::iota(group.begin(), group.end(), 0u);
  const auto group_of = [&](std::uint32_t v) {
    while (group[v] != v) v = group[v] = group[group[v]];
    return v;
  };
  for (std::size_t k = 1; k < ways.all().size(); ++k)
    require(ways.all()[k - 1].key() != ways.all()[k].key(), "Polyhedron: two faces have the edge ",
            "from corner ", ways.all()[k].from, " to ", ways.all()[k].to, " the same way round");
  for (const auto& way : ways.all()) {
    require(ways.find(way.to, way.from) != nullptr, "Polyhedron: only one face has the edge ",
            "from corner ", way.from, " to ", way.to, ": the faces do not close");
    ++around[way.from], group[group_of(way.from)] = group_of(way.to);
  }
  for (std::uint32_t v = 0; v < corners; ++v)
    require(around[v] >= 3 && group_of(v) == group_of(0), "Polyhedron: corner ", v, " is in ",
            around[v], " faces, or not joined to the others by edges; a corner is in three at ",
            "least, and all are joined");
  // Goes from face to face around each corner: the walk must visit all of them.
  for (std::size_t first = 0; first < ways.all().size(); first += around[ways.all()[first].from]) {
    const auto& start = ways.all()[first];
    std::uint32_t turns = 0;
    const auto* at = &start;
    do at = ways.find(start.from, at->before), ++turns;
    while (at != &start && turns <= around[start.from]);
    require(turns == around[start.from], "Polyhedron: the faces touch in corner ", start.from,
            " alone");
  }
  require(corners + body.faces.size() == 2 + ways.all().size() / 2,
          "Polyhedron: the faces have a handle: ", corners, " corners, ", ways.all().size() / 2,
          " edges and ", body.faces.size(), " faces");
}

/// Every face is flat and convex, and all corners are below it, to `slack` [m].
inline void check_convex(const ConvexFaces& body, double slack) {
  double six_volumes = 0;
  for (std::size_t f = 0; f < body.faces.size(); ++f) {
    const auto& loop = body.faces[f];
    const auto corner = [&](std::size_t k) { return body.vertices[loop[k % loop.size()]]; };
    const Vec3d origin = corner(0);
    Vec3d twice_area{0, 0, 0};
    for (std::size_t k = 1; k + 1 < loop.size(); ++k)
      twice_area += cross(corner(k) - origin, corner(k + 1) - origin);
    const double size = norm(twice_area);
    require(size > 0 && std::isfinite(size), "Polyhedron: face ", f, " has no area");
    const Vec3d normal = (1 / size) * twice_area;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      require(std::abs(dot(corner(k) - origin, normal)) <= slack, "Polyhedron: face ", f,
              " is not flat");
      const Vec3d edge = corner(k + 1) - corner(k);
      require(dot(edge, edge) > 0, "Polyhedron: two corners of face ", f, " are one place");
      const Vec3d inwards = (1 / norm(edge)) * cross(normal, edge);
      for (std::size_t n = 0; n < loop.size(); ++n)
        require(dot(corner(n) - corner(k), inwards) >= -slack, "Polyhedron: face ", f,
                " is not convex, or turns clockwise seen from outside");
    }
    for (std::size_t v = 0; v < body.vertices.size(); ++v)
      require(dot(body.vertices[v] - origin, normal) <= slack, "Polyhedron: corner ", v,
              " is outside face ", f, ": the body is not convex, or its faces are reversed");
    six_volumes += dot(origin - body.vertices[0], twice_area);
  }
  require(six_volumes > 0, "Polyhedron: the faces enclose no volume");
}

/// InputError, one sentence, unless they bound a convex body, to 1e-6 of its diagonal.
inline void check_faces(const ConvexFaces& body) {
  check_loops(body);
  check_closed(body);
  Box box;
  for (const Vec3d& v : body.vertices) box.include(v);
  check_convex(body, 1e-6 * norm(box.extent()));
}

}  // namespace silt::detail
