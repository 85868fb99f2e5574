// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include <silt/boundary/mesh_topology.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Corners and faces of a convex body. Each face is flat, with its corners counter-clockwise seen
/// from outside. Neighbouring faces are not coplanar, and no corner is inside an edge or a face.
struct ConvexFaces {
  DynArray<Vec3d> vertices;                 // [m]
  DynArray<DynArray<std::uint32_t>> faces;  // numbers of vertices
};

namespace detail {

/// Hull during construction: triangles; points are added one at a time, the farthest first. Each
/// point stores the triangle above which it is highest, and a step tests only its new triangles.
class GrowingHull {
 public:
  GrowingHull(const DynArray<Vec3d>& points, double tolerance)
      : points_(points), tolerance_(tolerance), highest_(points.size()), added_(points.size(), 0) {
    start();
    for (std::uint32_t p = next(); p != none; p = next()) add(p);
  }
  DynArray<VertexTriple> triangles() const {
    DynArray<VertexTriple> out;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (!dropped_[t]) out.push_back(triangles_[t]);
    return out;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// The triangle above which a point is highest, and its height [m].
  struct Highest {
    double height = -std::numeric_limits<double>::infinity();
    std::uint32_t triangle = 0;
  };

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
    for (const auto p : corner) added_[p] = 1;
    for (const VertexTriple& t : {VertexTriple{i, j, k}, {i, l, j}, {j, l, k}, {k, l, i}}) push(t);
    look(0);
  }

  void push(const VertexTriple& t) {
    const Vec3d& a = points_[t[0]];
    for (std::size_t k = 0; k < 3; ++k)
      at_edge_[name(t[k], t[(k + 1) % 3])] = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(t), dropped_.push_back(0);
    normals_.push_back(normalised(cross(points_[t[1]] - a, points_[t[2]] - a)));
  }
  void drop(std::uint32_t t) {
    dropped_[t] = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = at_edge_.find(name(triangles_[t][k], triangles_[t][(k + 1) % 3]));
      if (at != at_edge_.end() && at->second == t) at_edge_.erase(at);
    }
  }
  double height(std::size_t t, const Vec3d& p) const {
    return dot(p - points_[triangles_[t][0]], normals_[t]);
  }

  /// Updates `highest_`: triangles from `first` on are new, some others are removed.
  void look(std::uint32_t first) {
    for (std::uint32_t p = 0; p < points_.size(); ++p) {
      std::uint32_t t = first;
      if (dropped_[highest_[p].triangle]) highest_[p] = {}, t = 0;
      for (; t < triangles_.size(); ++t)
        if (!dropped_[t])
          if (const double h = height(t, points_[p]); h > highest_[p].height) highest_[p] = {h, t};
    }
  }

  /// The point farthest outside any triangle. A corner of the hull that is above a very thin
  /// triangle only by rounding is not added again, which would never end.
  std::uint32_t next() const {
    std::uint32_t best = none;
    double most = tolerance_;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (highest_[p].height > most && !added_[p]) best = p, most = highest_[p].height;
    return best;
  }

  /// Replaces the triangles visible from `p` by a fan from their rim to `p`. Visible triangles are
  /// collected across edges, starting at the one above which `p` is highest; the rim is then one
  /// loop.
  void add(std::uint32_t p) {
    added_[p] = 1;
    DynArray<std::uint32_t> seen{highest_[p].triangle};
    DynArray<char> is_seen(triangles_.size(), 0);
    is_seen[seen[0]] = 1;
    const auto beyond = [&](std::uint32_t t, std::size_t k) {
      return across(triangles_[t][k], triangles_[t][(k + 1) % 3]);
    };
    for (std::size_t n = 0; n < seen.size(); ++n)
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto t = beyond(seen[n], k);
            !is_seen[t] && height(t, points_[p]) > 0.5 * tolerance_)
          is_seen[t] = 1, seen.push_back(t);
    std::sort(seen.begin(), seen.end());
    DynArray<VertexTriple> fan;
    for (const auto t : seen)
      for (std::size_t k = 0; k < 3; ++k)
        if (!is_seen[beyond(t, k)])
          fan.push_back({triangles_[t][k], triangles_[t][(k + 1) % 3], p});
    for (const auto t : seen) drop(t);
    const auto first = static_cast<std::uint32_t>(triangles_.size());
    for (const auto& t : fan) push(t);
    look(first);
  }

  static std::uint64_t name(std::uint32_t from, std::uint32_t to) {
    return std::uint64_t{from} << 32 | to;
  }
  /// The triangle across the edge a b of a triangle.
  std::uint32_t across(std::uint32_t a, std::uint32_t b) const {
    const auto at = at_edge_.find(name(b, a));
    if (at != at_edge_.end()) return at->second;
    throw InputError(
        "convex_hull: the points are too many for their distances; leave out points "
        "that nearly lie in one place or one plane");
  }

  const DynArray<Vec3d>& points_;
  double tolerance_;                  // [m] height that counts as in the plane
  DynArray<VertexTriple> triangles_;  // including removed ones
  DynArray<char> dropped_;
  DynArray<Vec3d> normals_;
  DynArray<Highest> highest_;                                 // of each point
  DynArray<char> added_;                                      // whether it is or was a corner
  std::unordered_map<std::uint64_t, std::uint32_t> at_edge_;  // the triangle left of an edge
};

/// Merges coplanar triangles to faces, and removes corners where no edge bends.
class FaceMerger {
 public:
  FaceMerger(const DynArray<Vec3d>& points, DynArray<VertexTriple> triangles, double tolerance)
      : points_(points),
        triangles_(std::move(triangles)),
        tolerance_(tolerance),
        group_(triangles_.size()),
        members_(triangles_.size()) {
    for (std::uint32_t t = 0; t < group_.size(); ++t) group_[t] = t;
    join();
    for (std::uint32_t t = 0; t < group_.size(); ++t) members_[group_[t]].push_back(t);
  }

  ConvexFaces faces() const {
    DynArray<DynArray<std::uint32_t>> loops;
    DynArray<int> uses(points_.size(), 0);
    for (std::uint32_t g = 0; g < group_.size(); ++g)
      if (group_[g] == g) {
        loops.push_back(loop_of(g));
        for (const auto v : loops.back()) ++uses[v];
      }
    ConvexFaces out;
    DynArray<std::uint32_t> number(points_.size());
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
  /// Largest triangles first: their planes are the most accurate; thin ones are merged into them.
  void join() {
    DynArray<std::uint32_t> order(triangles_.size());
    for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
    const auto twice_area = [&](std::uint32_t t) {
      const auto& [a, b, c] = triangles_[t];
      return norm(cross(points_[b] - points_[a], points_[c] - points_[a]));
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](auto s, auto t) { return twice_area(s) > twice_area(t); });
    DynArray<char> placed(triangles_.size(), 0);
    const MeshTopology topology(points_, triangles_);
    for (const auto seed : order) {
      if (placed[seed]) continue;
      placed[seed] = 1;
      DynArray<std::uint32_t> open{seed};
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

  /// Rim of a group: its directed edges whose reverse is not in the group.
  DynArray<std::uint32_t> loop_of(std::uint32_t g) const {
    DynArray<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const auto t : members_[g])
      for (std::size_t k = 0; k < 3; ++k)
        sides.emplace_back(triangles_[t][k], triangles_[t][(k + 1) % 3]);
    const auto inner = [&](const auto& side) {
      return std::count(sides.begin(), sides.end(), std::pair(side.second, side.first)) > 0;
    };
    DynArray<std::pair<std::uint32_t, std::uint32_t>> rim;
    std::copy_if(sides.begin(), sides.end(), std::back_inserter(rim),
                 [&](const auto& side) { return !inner(side); });
    DynArray<std::uint32_t> loop{rim[0].first};
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

  const DynArray<Vec3d>& points_;
  const DynArray<VertexTriple> triangles_;
  double tolerance_;
  DynArray<std::uint32_t> group_;              // of each triangle: the first of its group
  DynArray<DynArray<std::uint32_t>> members_;  // of each group
};

}  // namespace detail

/// Convex hull of points: incremental, farthest point first. Intended for bodies, not for large
/// point clouds: the time is quadratic in the number of corners.
///
/// Points within 1e-9 of the diagonal of each other are merged. Triangles with corners within 1e-8
/// of the diagonal of a larger neighbour's plane are merged with it to one face.
/// Errors: InputError for points that are not finite, fewer than four points, or coplanar points.
/// Tests:  tests/shape/polyhedron.cpp (against all planes of three points; duplicates; grids)
inline ConvexFaces convex_hull(const DynArray<Vec3d>& points) {
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
  auto triangles = detail::GrowingHull(welder.points, 1e-10 * diagonal).triangles();
  return detail::FaceMerger(welder.points, std::move(triangles), 1e-8 * diagonal).faces();
}

}  // namespace silt
