// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <silt/boundary/mesh_topology.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Corners and faces of a convex body: each face flat, its corners in turn counter-clockwise seen
/// from outside, no face in the plane of its neighbour, no corner amidst an edge or a face.
struct ConvexFaces {
  std::vector<Vec3d> vertices;                    // [m]
  std::vector<std::vector<std::uint32_t>> faces;  // numbers of vertices
};

namespace detail {

/// The hull while it grows: triangles, one point added at a time, the farthest first.
class GrowingHull {
 public:
  GrowingHull(const std::vector<Vec3d>& points, double tolerance)
      : points_(points), tolerance_(tolerance) {
    start();
    for (std::uint32_t p = next(); p != none; p = next()) add(p);
  }
  const std::vector<VertexTriple>& triangles() const { return triangles_; }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  void start() {
    std::array<std::uint32_t, 4> corner{};
    const auto farthest = [&](auto&& measure) {
      std::uint32_t best = 0;
      for (std::uint32_t p = 1; p < points_.size(); ++p)
        if (measure(points_[p]) > measure(points_[best])) best = p;
      require(measure(points_[best]) > tolerance_,
              "convex_hull: the points lie in one plane, on one line or in one place; a body needs "
              "four that do not");
      return best;
    };
    corner[0] = 0;
    const Vec3d a = points_[0];
    corner[1] = farthest([&](const Vec3d& p) { return norm(p - a); });
    const Vec3d along = normalised(points_[corner[1]] - a);
    corner[2] = farthest([&](const Vec3d& p) { return norm(cross(p - a, along)); });
    const Vec3d up = normalised(cross(along, points_[corner[2]] - a));
    corner[3] = farthest([&](const Vec3d& p) { return std::abs(dot(p - a, up)); });
    if (dot(points_[corner[3]] - a, up) > 0) std::swap(corner[1], corner[2]);
    const auto [i, j, k, l] = corner;
    for (const VertexTriple& t : {VertexTriple{i, j, k}, {i, l, j}, {j, l, k}, {k, l, i}}) push(t);
  }

  void push(const VertexTriple& t) {
    const Vec3d& a = points_[t[0]];
    triangles_.push_back(t);
    normals_.push_back(normalised(cross(points_[t[1]] - a, points_[t[2]] - a)));
  }
  double height(std::size_t t, const Vec3d& p) const {
    return dot(p - points_[triangles_[t][0]], normals_[t]);
  }

  /// The point farthest outside of any triangle.
  std::uint32_t next() const {
    std::uint32_t best = none;
    double most = tolerance_;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      for (std::size_t t = 0; t < triangles_.size(); ++t)
        if (const double h = height(t, points_[p]); h > most) best = p, most = h;
    return best;
  }

  /// Replaces the triangles that `p` sees by a fan from their rim to `p`. Those it sees are
  /// gathered across edges from the one it stands highest over, so that the rim is one loop.
  void add(std::uint32_t p) {
    std::vector<char> seen(triangles_.size(), 0);
    std::size_t top = 0;
    for (std::size_t t = 1; t < triangles_.size(); ++t)
      if (height(t, points_[p]) > height(top, points_[p])) top = t;
    seen[top] = 1;
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t t = 0; t < triangles_.size(); ++t)
        if (!seen[t] && height(t, points_[p]) > 0.5 * tolerance_ && touches_seen(t, seen))
          seen[t] = 1, grown = true;
    }
    std::vector<VertexTriple> fan, kept;
    std::vector<Vec3d> kept_normals;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!seen[t]) kept.push_back(triangles_[t]), kept_normals.push_back(normals_[t]);
      for (std::size_t k = 0; seen[t] && k < 3; ++k) {
        const auto a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        if (!seen[across(a, b)]) fan.push_back({a, b, p});
      }
    }
    triangles_ = std::move(kept), normals_ = std::move(kept_normals);
    for (const auto& t : fan) push(t);
  }

  bool touches_seen(std::size_t t, const std::vector<char>& seen) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (seen[across(triangles_[t][k], triangles_[t][(k + 1) % 3])]) return true;
    return false;
  }
  /// The triangle on the other side of the edge a b of a triangle.
  std::size_t across(std::uint32_t a, std::uint32_t b) const {
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (triangles_[t][k] == b && triangles_[t][(k + 1) % 3] == a) return t;
    throw InputError(
        "convex_hull: the points are too many for their distances; leave out points "
        "that nearly lie in one place or one plane");
  }

  const std::vector<Vec3d>& points_;
  double tolerance_;  // [m] above a plane that counts as in it
  std::vector<VertexTriple> triangles_;
  std::vector<Vec3d> normals_;
};

/// Joins triangles of one plane to faces, and drops corners that no longer bend anything.
class FaceMerger {
 public:
  FaceMerger(const std::vector<Vec3d>& points, const std::vector<VertexTriple>& triangles,
             double tolerance)
      : points_(points), triangles_(triangles), tolerance_(tolerance), group_(triangles.size()) {
    for (std::uint32_t t = 0; t < group_.size(); ++t) group_[t] = t;
    join();
  }

  ConvexFaces faces() const {
    std::vector<std::vector<std::uint32_t>> loops;
    std::vector<int> uses(points_.size(), 0);
    for (std::uint32_t g = 0; g < group_.size(); ++g)
      if (group_[g] == g) {
        loops.push_back(loop_of(g));
        for (const auto v : loops.back()) ++uses[v];
      }
    ConvexFaces out;
    std::vector<std::uint32_t> number(points_.size());
    for (std::uint32_t v = 0; v < points_.size(); ++v)
      if (uses[v] >= 3) {
        number[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(points_[v]);
      }
    for (const auto& loop : loops) {
      auto& face = out.faces.emplace_back();
      for (const auto v : loop)
        if (uses[v] >= 3) face.push_back(number[v]);
    }
    return out;
  }

 private:
  /// Largest triangles first: their planes are the surest, and thin ones join them.
  void join() {
    std::vector<std::uint32_t> order(triangles_.size());
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    const auto twice_area = [&](std::uint32_t t) {
      const auto& [a, b, c] = triangles_[t];
      return norm(cross(points_[b] - points_[a], points_[c] - points_[a]));
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](auto s, auto t) { return twice_area(s) > twice_area(t); });
    std::vector<char> placed(triangles_.size(), 0);
    const MeshTopology topology(points_, triangles_);
    for (const auto seed : order) {
      if (placed[seed]) continue;
      placed[seed] = 1;
      std::vector<std::uint32_t> open{seed};
      while (!open.empty()) {
        const auto t = open.back();
        open.pop_back();
        for (const auto e : topology.edges_of[t])
          for (const auto o : topology.triangles_at_edge[e])
            if (!placed[o] && in_plane(o, seed)) placed[o] = 1, group_[o] = seed, open.push_back(o);
      }
    }
  }
  bool in_plane(std::uint32_t t, std::uint32_t seed) const {
    const auto& [a, b, c] = triangles_[seed];
    const Vec3d normal = normalised(cross(points_[b] - points_[a], points_[c] - points_[a]));
    for (const auto v : triangles_[t])
      if (std::abs(dot(points_[v] - points_[a], normal)) > tolerance_) return false;
    return true;
  }

  /// The rim of a group: its directed edges whose reverse is not one of its own.
  std::vector<std::uint32_t> loop_of(std::uint32_t g) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (std::uint32_t t = 0; t < group_.size(); ++t)
      for (std::size_t k = 0; group_[t] == g && k < 3; ++k)
        sides.emplace_back(triangles_[t][k], triangles_[t][(k + 1) % 3]);
    const auto inner = [&](const auto& side) {
      return std::count(sides.begin(), sides.end(), std::pair(side.second, side.first)) > 0;
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rim;
    std::copy_if(sides.begin(), sides.end(), std::back_inserter(rim),
                 [&](const auto& side) { return !inner(side); });
    std::vector<std::uint32_t> loop{rim[0].first};
    for (auto at = rim[0].second; at != rim[0].first && loop.size() <= rim.size();) {
      loop.push_back(at);
      at = std::find_if(rim.begin(), rim.end(), [&](const auto& s) {
             return s.first == at;
           })->second;
    }
    require(loop.size() == rim.size(),
            "convex_hull: a face is not one loop; the points are too "
            "near to each other or to one plane");
    return loop;
  }

  const std::vector<Vec3d>& points_;
  const std::vector<VertexTriple>& triangles_;
  double tolerance_;
  std::vector<std::uint32_t> group_;
};

}  // namespace detail

/// The convex hull of points: incremental, the farthest point first (for bodies, not for clouds:
/// quadratic in the number of corners).
///
/// Points within 1e-9 of the diagonal of each other are one; triangles whose corners are within
/// 1e-8 of the diagonal of a larger neighbour's plane are one face with it.
/// Errors: InputError for points not finite, fewer than four, or all in one plane.
/// Tests:  tests/shape/polyhedron.cpp (against all planes of three points; duplicates; grids)
inline ConvexFaces convex_hull(const std::vector<Vec3d>& points) {
  Box box;
  for (std::size_t k = 0; k < points.size(); ++k) {
    require(is_finite(points[k]), "convex_hull: point ", k, " (counted from 0) is ", points[k],
            " [m]; points must be finite");
    box.include(points[k]);
  }
  require(points.size() >= 4, "convex_hull: ", points.size(),
          " points given; a body needs four that do not lie in one plane");
  const double diagonal = norm(box.extent());
  require(diagonal > 0, "convex_hull: all ", points.size(), " points lie in one place");
  detail::VertexWelder welder(points.size(), box.min, 1e-9 * diagonal);
  for (const auto& p : points) welder.add(p);
  const detail::GrowingHull hull(welder.points, 1e-10 * diagonal);
  return detail::FaceMerger(welder.points, hull.triangles(), 1e-8 * diagonal).faces();
}

}  // namespace silt
