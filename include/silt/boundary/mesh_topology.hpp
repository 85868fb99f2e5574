// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

using VertexTriple = std::array<std::uint32_t, 3>;

/// Numbers points; points equal within a tolerance get one number. Numbers follow first occurrence.
class VertexWelder {
 public:
  /// For up to `count` points not below `origin` in any coordinate.
  VertexWelder(std::size_t count, const Vec3d& origin, double tolerance)
      : first_(std::bit_ceil(2 * count + 1), none),
        origin_(origin),
        tolerance_(tolerance),
        per_cell_(1 / (16 * tolerance)) {}

  /// The nearest earlier point within the tolerance, else a new point.
  std::uint32_t add(const Vec3d& point) {
    const Vec3d margin{tolerance_, tolerance_, tolerance_};
    const Cell low = cell(point - margin), high = cell(point + margin);
    std::uint32_t best = none;
    double best_square = tolerance_ * tolerance_;
    for (auto x = low[0]; x <= high[0]; ++x)
      for (auto y = low[1]; y <= high[1]; ++y)
        for (auto z = low[2]; z <= high[2]; ++z)
          for (auto v = first_[slot({x, y, z})]; v != none; v = next_[v]) {
            const Vec3d gap = points[v] - point;
            const double square = dot(gap, gap);
            if (square < best_square || (square == best_square && v < best))
              best = v, best_square = square;
          }
    return best == none ? insert(point) : best;
  }

  DynArray<Vec3d> points;  // [m]

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Cell cell(const Vec3d& p) const {
    const Vec3d at = (p - origin_) * per_cell_;
    return {static_cast<std::int64_t>(std::floor(at.x)),
            static_cast<std::int64_t>(std::floor(at.y)),
            static_cast<std::int64_t>(std::floor(at.z))};
  }
  std::size_t slot(const Cell& c) const {
    std::uint64_t h = 0;
    for (const auto k : c) {
      h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 29;
    }
    return h & (first_.size() - 1);
  }
  std::uint32_t insert(const Vec3d& point) {
    const auto number = static_cast<std::uint32_t>(points.size());
    auto& head = first_[slot(cell(point))];
    points.push_back(point);
    next_.push_back(head);
    head = number;
    return number;
  }

  DynArray<std::uint32_t> first_, next_;  // chains of points whose cells share a slot
  Vec3d origin_;
  double tolerance_, per_cell_;
};

/// Lists of numbers, one per key, in one array; `list[key]` is a span.
struct ListOfLists {
  DynArray<std::uint32_t> begin{0}, items;

  std::span<const std::uint32_t> operator[](std::uint32_t key) const {
    return {items.data() + begin[key], items.data() + begin[key + 1]};
  }
};

/// Edge of a welded mesh, from its lower to its higher vertex. The triangles that share it use the
/// same numbers, bit for bit.
struct MeshEdge {
  std::uint32_t from, to;
  Vec3d direction;  // [-] unit
  double length;    // [m]
};

/// Side of a triangle as an undirected edge.
struct EdgeUse {
  std::uint32_t low, high;
  std::uint32_t triangle, corner;  // runs from this corner of the triangle to the next
  bool forward;                    // from low to high

  friend bool operator<(const EdgeUse& a, const EdgeUse& b) {
    return std::array{a.low, a.high, a.triangle, a.corner} <
           std::array{b.low, b.high, b.triangle, b.corner};
  }
  bool same_edge(const EdgeUse& b) const { return low == b.low && high == b.high; }
};

/// All triangle sides, sorted so that the uses of an edge follow each other.
inline DynArray<EdgeUse> sorted_edge_uses(const DynArray<VertexTriple>& triangles) {
  DynArray<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  std::sort(uses.begin(), uses.end());
  return uses;
}

/// Number of triangles that have the corners of an earlier one, in the same order of turning.
inline std::size_t repeated_triangles(const DynArray<VertexTriple>& triangles) {
  DynArray<VertexTriple> turned;
  for (VertexTriple t : triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    turned.push_back(t);
  }
  std::sort(turned.begin(), turned.end());
  std::size_t repeated = 0;
  for (std::size_t k = 1; k < turned.size(); ++k) repeated += turned[k] == turned[k - 1];
  return repeated;
}
/// InputError if triangles are given twice: the volume within them would count twice.
inline void require_single(const char* of, const DynArray<VertexTriple>& triangles) {
  const std::size_t repeated = repeated_triangles(triangles);
  require(repeated == 0, of, ": the mesh holds ", repeated,
          " triangles twice, and what they enclose would count twice; remove the copies (a program "
          "for CAD or meshes calls this removing duplicate faces)");
}

/// True if every edge is traversed as often forwards as backwards: the triangles are consistently
/// oriented and leave no gap. Solids that share an edge (four triangles there) are closed too.
inline bool without_boundary(const DynArray<VertexTriple>& triangles) {
  const auto uses = sorted_edge_uses(triangles);
  int balance = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (i > 0 && !uses[i].same_edge(uses[i - 1]) && std::exchange(balance, 0) != 0) return false;
    balance += uses[i].forward ? 1 : -1;
  }
  return balance == 0;
}

/// Unique edges of triangles with three different vertices, and the triangles at each edge and
/// vertex.
struct MeshTopology {
  DynArray<MeshEdge> edges;
  DynArray<VertexTriple> edges_of;  // of each triangle: from corner k to corner k + 1
  ListOfLists triangles_at_edge, triangles_at_vertex;

  MeshTopology() = default;
  MeshTopology(const DynArray<Vec3d>& vertices, const DynArray<VertexTriple>& triangles)
      : edges_of(triangles.size()) {
    auto& at_edge = triangles_at_edge;
    const auto uses = sorted_edge_uses(triangles);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const auto& use = uses[i];
      if (i == 0 || !use.same_edge(uses[i - 1])) {
        const Vec3d span = vertices[use.high] - vertices[use.low];
        const double length = norm(span);
        edges.push_back({use.low, use.high, span * (1 / length), length});
        at_edge.begin.push_back(at_edge.begin.back());
      }
      edges_of[use.triangle][use.corner] = static_cast<std::uint32_t>(edges.size() - 1);
      at_edge.items.push_back(use.triangle);
      ++at_edge.begin.back();
    }
    sort_by_vertex(vertices.size(), triangles);
  }

 private:
  void sort_by_vertex(std::size_t count, const DynArray<VertexTriple>& triangles) {
    auto& [begin, items] = triangles_at_vertex;
    begin.assign(count + 1, 0);
    for (const auto& triangle : triangles)
      for (const auto v : triangle) ++begin[v + 1];
    for (std::size_t v = 0; v < count; ++v) begin[v + 1] += begin[v];
    items.resize(begin.back());
    auto end = begin;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (const auto v : triangles[t]) items[end[v]++] = t;
  }
};

}  // namespace silt::detail
