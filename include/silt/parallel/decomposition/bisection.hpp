// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/parallel/decomposition/find_cuts.hpp>

namespace silt::inline SILT_TARGET {

/// Recursive coordinate bisection for any number of ranks: all points are cut across the longest
/// side of their bounding box such that the work on both sides is in proportion to the number of
/// ranks there, and then each side again. Points in the plane of a cut are ordered by their other
/// coordinates, so that a lattice is divided as well as random points. Needs no other library.
///
/// Source: Berger, Bokhari, IEEE Transactions on Computers C-36 (1987) 570-580 (recalled), with
///         weights and with sides for any number of ranks.
/// Tests:  tests/parallel/decompositions.cpp (work within 1.14 of one point's weight of the mean).
/// Valid:  any number of ranks and any positions of the points.
/// Units:  [m]; work in units of the weights.
/// Errors: none.
struct Bisection {
  /// Points at `cut` or before it along the axis belong to `left`. Children are nodes, or ~rank.
  struct Node {
    int axis;
    int left, right;
    detail::PlaceKey cut;
  };
  std::vector<Node> nodes = {};  // the first is the root; none: rank 0 owns all

  static constexpr bool by_place = true;

  template <Communicator C>
  std::vector<int> partition(const C& comm, std::span<const Vec3d> points,
                             std::span<const double> weights) {
    const detail::WholeWeights whole(comm, points, weights);
    const auto before = std::exchange(nodes, {});  // the tree of ranks never changes
    // Nodes of one level at a time: ranks first ... first + ranks - 1, and all of their points.
    struct Part {
      int first, ranks;
      std::int64_t weight;  // of all ranks
      std::vector<std::size_t> members;
      int parent;
      bool is_left;
    };
    std::vector<Part> level{{0, comm.size(), whole.total, {}, -1, false}};
    for (std::size_t k = 0; k < points.size(); ++k)
      if (is_finite(points[k])) level[0].members.push_back(k);
    while (!level.empty()) {
      // A part of one rank is a leaf.
      std::vector<Part> divided;
      for (auto& part : level) {
        const int child = part.ranks == 1 ? ~part.first : static_cast<int>(nodes.size());
        if (part.parent >= 0) {
          auto& parent = nodes[static_cast<std::size_t>(part.parent)];
          (part.is_left ? parent.left : parent.right) = child;
        }
        if (part.ranks == 1) continue;
        nodes.push_back({0, 0, 0, detail::PlaceKey::before_all()});
        divided.push_back(std::move(part));
      }
      level.clear();
      if (divided.empty()) break;
      const auto boxes = boxes_of(comm, points, divided);
      const std::size_t first_node = nodes.size() - divided.size();
      std::vector<detail::SortedGroup> groups;
      std::vector<detail::Cut> cuts;
      for (std::size_t g = 0; g < divided.size(); ++g) {
        const auto& part = divided[g];
        const std::size_t node = first_node + g;
        const int axis = axis_for(boxes[g], node < before.size() ? before[node].axis : -1);
        nodes[node].axis = axis;
        groups.emplace_back(points, whole.weights, part.members, axis);
        cuts.push_back(
            {g, detail::share_of(part.weight, part.ranks / 2, part.ranks), axis, boxes[g]});
      }
      detail::find_cuts(comm, groups, cuts);
      for (std::size_t g = 0; g < divided.size(); ++g) {
        auto& part = divided[g];
        auto& node = nodes[first_node + g];
        node.cut = cuts[g].cut;
        const int half = part.ranks / 2, parent = static_cast<int>(first_node + g);
        Part left{part.first, half, cuts[g].left, {}, parent, true};
        Part right{
            part.first + half, part.ranks - half, part.weight - cuts[g].left, {}, parent, false};
        for (const auto k : part.members)
          (detail::PlaceKey::of(points[k], node.axis) <= node.cut ? left : right)
              .members.push_back(k);
        level.push_back(std::move(left));
        level.push_back(std::move(right));
      }
    }
    std::vector<int> owner;
    owner.reserve(points.size());
    for (const auto& p : points) owner.push_back(is_finite(p) ? rank_of(p) : comm.rank());
    return owner;
  }

  int rank_of(const Vec3d& place) const {
    int k = nodes.empty() ? ~0 : 0;
    while (k >= 0) {
      const auto& node = nodes[static_cast<std::size_t>(k)];
      k = detail::PlaceKey::of(place, node.axis) <= node.cut ? node.left : node.right;
    }
    return ~k;
  }
  template <class Visit>
  void for_each_state(Visit& visit) {
    visit(nodes);
  }

 private:
  /// Collective: the bounding box of each part's points; empty where there are none.
  template <Communicator C, class Parts>
  static std::vector<Box> boxes_of(const C& comm, std::span<const Vec3d> points,
                                   const Parts& parts) {
    std::vector<Box> boxes;
    std::vector<double> most;
    for (const auto& part : parts) {
      Box box;
      for (const auto k : part.members) box.include(points[k]);
      for (const double x : {-box.min.x, -box.min.y, -box.min.z, box.max.x, box.max.y, box.max.z})
        most.push_back(x);
    }
    comm.max_of(most);
    for (std::size_t k = 0; k < most.size(); k += 6)
      boxes.push_back(
          {{-most[k], -most[k + 1], -most[k + 2]}, {most[k + 3], most[k + 4], most[k + 5]}});
    return boxes;
  }

  /// The axis of the longest side; the previous axis is kept while its side is nearly as long,
  /// because a change of axis moves all points of a part.
  static int axis_for(const Box& box, int before) {
    const auto e = box.extent();
    const std::array<double, 3> side{e.x, e.y, e.z};
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const auto at = [&](int d) { return side[static_cast<std::size_t>(d)]; };
    return before >= 0 && 1.25 * at(before) >= at(axis) ? before : axis;
  }
};
static_assert(Decomposition<Bisection, NoRanks>);

}  // namespace silt
