// silt - BSD-3-Clause, see LICENSE
#pragma once

// Searches for comparison. They are here and not in the library: none of them is ever the best.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#if __has_include(<nanoflann.hpp>)
#include <nanoflann.hpp>
#define BENCH_NANOFLANN 1
#endif

#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>

namespace bench {

using silt::IndexPair;
using silt::SphereSet;
using silt::Team;
using Pairs = std::vector<IndexPair>;

/// All cells of the bounding box, occupied or not: cell starts by counting sort, half stencil.
struct DenseGrid {
  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            Pairs& pairs) {
    const auto& rows = spheres.rows;
    const silt::detail::GridFrame frame(silt::detail::bounds_of(spheres, domain, team),
                                        2 * spheres.largest_radius + reach, domain);
    const auto [nx, ny, nz] = frame.count;
    const auto number = [&, nx = nx, ny = ny](const silt::PositionRow& p) {
      return (frame.along(p.z, 2) * ny + frame.along(p.y, 1)) * nx + frame.along(p.x, 0);
    };
    start.assign(nx * ny * nz + 1, 0), order.resize(rows.size());
    for (const auto& p : rows) ++start[number(p)];
    std::uint32_t place = 0;
    for (auto& s : start) s = place += s;
    for (std::size_t k = rows.size(); k-- > 0;)
      order[--start[number(rows[k])]] = static_cast<std::uint32_t>(k);
    pairs.clear();
    const auto meet = [&](std::uint32_t p, std::size_t from, std::size_t to) {
      for (std::size_t q = from; q < to; ++q)
        if (silt::detail::within_reach(rows[p], rows[order[q]], reach, domain))
          pairs.push_back({p, order[q]});
    };
    for (std::size_t z = 0, c = 0; z < nz; ++z)
      for (std::size_t y = 0; y < ny; ++y)
        for (std::size_t x = 0; x < nx; ++x, ++c)
          for (std::size_t p = start[c]; p < start[c + 1]; ++p) {
            meet(order[p], p + 1, start[x + 1 < nx ? c + 2 : c + 1]);
            for (const auto& [dy, dz] : {std::pair{1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
              if ((dy < 0 && y == 0) || (dy > 0 && y + 1 == ny) || (dz > 0 && z + 1 == nz))
                continue;
              const std::size_t other =
                  c + static_cast<std::size_t>(dz) * ny * nx + static_cast<std::size_t>(dy) * nx;
              meet(order[p], start[x > 0 ? other - 1 : other],
                   start[x + 1 < nx ? other + 2 : other + 1]);
            }
          }
  }
  std::vector<std::uint32_t> start, order;
};

/// Spheres sorted along x; each is tested against those that begin before it ends.
struct SweepAndPrune {
  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team&,
            Pairs& pairs) {
    const auto& rows = spheres.rows;
    order.resize(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto begin = [&](std::uint32_t k) { return rows[k].x - rows[k].r; };
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return begin(a) < begin(b); });
    pairs.clear();
    for (std::size_t p = 0; p < order.size(); ++p) {
      const double end = rows[order[p]].x + rows[order[p]].r + reach;
      for (std::size_t q = p + 1; q < order.size() && begin(order[q]) < end; ++q)
        if (silt::detail::within_reach(rows[order[p]], rows[order[q]], reach, domain))
          pairs.push_back({order[p], order[q]});
    }
  }
  std::vector<std::uint32_t> order;
};

/// Boxes halved in three directions down to 16 spheres, each with its bounding box.
struct Octree {
  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team&,
            Pairs& pairs) {
    const auto& rows = spheres.rows;
    order.resize(rows.size()), nodes.clear(), pairs.clear();
    std::iota(order.begin(), order.end(), 0u);
    if (!rows.empty()) build(spheres, 0, static_cast<std::uint32_t>(rows.size()), 0);
    for (std::uint32_t k = 0; k < rows.size(); ++k) {
      const auto& p = rows[k];
      for (std::size_t at = 0; at < nodes.size();) {
        const Node& n = nodes[at];
        const double cutoff = p.r + n.largest + reach;
        const auto out = [](double x, double low, double high) {
          return std::max({low - x, x - high, 0.0});
        };
        const silt::Vec3d d{out(p.x, n.box.min.x, n.box.max.x), out(p.y, n.box.min.y, n.box.max.y),
                            out(p.z, n.box.min.z, n.box.max.z)};
        if (dot(d, d) >= cutoff * cutoff) {
          at = n.after;
          continue;
        }
        for (std::uint32_t q = n.from; n.leaf && q < n.to; ++q)
          if (order[q] > k && silt::detail::within_reach(p, rows[order[q]], reach, domain))
            pairs.push_back({k, order[q]});
        ++at;
      }
    }
  }
  struct Node {
    silt::Box box;
    double largest;
    std::uint32_t from, to;
    std::size_t after;  // the next node that is not below this one
    bool leaf;
  };
  void build(const SphereSet& spheres, std::uint32_t from, std::uint32_t to, int depth) {
    Node node{silt::Box(), 0, from, to, 0, to - from <= 16 || depth == 40};
    for (std::uint32_t k = from; k < to; ++k) {
      node.box.include(spheres.rows[order[k]].centre());
      node.largest = std::max(node.largest, spheres.rows[order[k]].r);
    }
    const std::size_t at = nodes.size();
    nodes.push_back(node);
    if (!node.leaf) {
      const silt::Vec3d m = node.box.centre();
      const auto octant = [&](std::uint32_t k) {
        const auto& p = spheres.rows[k];
        return (p.x > m.x) + 2 * (p.y > m.y) + 4 * (p.z > m.z);
      };
      for (int o = 0; o < 8 && from < to; ++o) {
        const auto first = order.begin() + from, last = order.begin() + to;
        const auto end = std::partition(first, last, [&](auto k) { return octant(k) == o; });
        const auto cut = static_cast<std::uint32_t>(end - order.begin());
        if (cut > from) build(spheres, from, cut, depth + 1);
        from = cut;
      }
    }
    nodes[at].after = nodes.size();
  }
  std::vector<std::uint32_t> order;
  std::vector<Node> nodes;
};

#if defined(BENCH_NANOFLANN)
/// nanoflann's k-d tree, queried for all points within the largest cutoff of each.
struct KdTree {
  struct Points {
    const SphereSet& spheres;
    std::size_t kdtree_get_point_count() const { return spheres.rows.size(); }
    double kdtree_get_pt(std::size_t k, std::size_t d) const { return (&spheres.rows[k].x)[d]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team&,
            Pairs& pairs) {
    const Points points{spheres};
    using Distance = nanoflann::L2_Simple_Adaptor<double, Points>;
    const nanoflann::KDTreeSingleIndexAdaptor<Distance, Points, 3, std::uint32_t> tree(
        3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    std::vector<std::pair<std::uint32_t, double>> near;
    nanoflann::SearchParams parameters;
    parameters.sorted = false;
    pairs.clear();
    for (std::uint32_t k = 0; k < spheres.rows.size(); ++k) {
      const auto& p = spheres.rows[k];
      const double cutoff = p.r + spheres.largest_radius + reach;
      tree.radiusSearch(&p.x, cutoff * cutoff, near, parameters);
      for (const auto& [q, distance2] : near)
        if (q > k && silt::detail::within_reach(p, spheres.rows[q], reach, domain))
          pairs.push_back({k, q});
    }
  }
};
#endif

}  // namespace bench
