// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Tree of bounding boxes of triangles, for queries near a point.
///
/// A tree is used instead of a uniform grid because CAD surfaces mix facets of very different
/// sizes. Its memory is about one node for two triangles for any sizes, and a query visits few
/// nodes.
class TriangleTree {
 public:
  TriangleTree() = default;
  explicit TriangleTree(const DynArray<Box>& boxes) : order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
  }

  const Box& bounds() const { return nodes_.front().box; }

  /// Calls `visit(triangle)` for the triangles of every leaf within `reach` of `point`.
  template <class Visit>
  void for_each_near(const Vec3d& point, double reach, Visit&& visit) const {
    for_each([&](const Box& box) { return squared_distance(box, point) <= reach * reach; }, visit);
  }

  /// The same, nearest boxes first; `visit` may lower `reach`.
  template <class Visit>
  void for_each_nearer(const Vec3d& point, const double& reach, Visit&& visit) const {
    struct Due {
      std::uint32_t node;
      double square;
    };
    DynArray<Due> due{{0, squared_distance(nodes_.front().box, point)}};
    while (!due.empty()) {
      const Due now = due.back();
      due.pop_back();
      if (now.square > reach * reach) continue;
      const Node& node = nodes_[now.node];
      for (auto k = node.first; k < node.last; ++k) visit(order_[k]);
      if (node.first < node.last) continue;
      const auto left = now.node + 1, right = nodes_[left].skip_to;
      Due near{left, squared_distance(nodes_[left].box, point)},
          far{right, squared_distance(nodes_[right].box, point)};
      if (far.square < near.square) std::swap(near, far);
      due.push_back(far), due.push_back(near);
    }
  }

  /// Calls `visit(triangle)` for the triangles of every leaf for which `meets` accepts its box and
  /// all boxes around it.
  template <class Meets, class Visit>
  void for_each(Meets&& meets, Visit&& visit) const {
    for (std::size_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      if (!meets(node.box)) {
        i = node.skip_to;
        continue;
      }
      for (auto k = node.first; k < node.last; ++k) visit(order_[k]);
      ++i;
    }
  }

 private:
  /// Depth-first: the subtree of node i is [i, skip_to). Only leaves hold triangles.
  struct Node {
    Box box;
    std::uint32_t first, last, skip_to;
  };
  static constexpr std::uint32_t leaf_size = 4;

  void build(const DynArray<Box>& boxes, std::uint32_t first, std::uint32_t last) {
    const auto at = nodes_.size();
    Box around, centres;
    for (auto k = first; k < last; ++k) {
      const Box& box = boxes[order_[k]];
      around.include(box.min), around.include(box.max);
      centres.include(box.centre());
    }
    const bool leaf = last - first <= leaf_size;
    nodes_.push_back({around, first, leaf ? last : first, 0});
    if (!leaf) {
      const auto middle = first + (last - first) / 2;
      const auto along = longest_axis(centres.extent());
      std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                       [&](std::uint32_t a, std::uint32_t b) {
                         return boxes[a].centre().*along < boxes[b].centre().*along;
                       });
      build(boxes, first, middle);
      build(boxes, middle, last);
    }
    nodes_[at].skip_to = static_cast<std::uint32_t>(nodes_.size());
  }

  static double Vec3d::*longest_axis(const Vec3d& e) {
    return e.x >= e.y && e.x >= e.z ? &Vec3d::x : e.y >= e.z ? &Vec3d::y : &Vec3d::z;
  }

  static double squared_distance(const Box& box, const Vec3d& p) {
    const double x = std::max({box.min.x - p.x, 0.0, p.x - box.max.x});
    const double y = std::max({box.min.y - p.y, 0.0, p.y - box.max.y});
    const double z = std::max({box.min.z - p.z, 0.0, p.z - box.max.z});
    return x * x + y * y + z * z;
  }

  DynArray<std::uint32_t> order_;
  DynArray<Node> nodes_;
};

}  // namespace silt::detail
