// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/grid_frame.hpp>
#include <silt/search/pair_scan.hpp>
#include <silt/search/space_order.hpp>

namespace silt::inline SILT_TARGET {

/// NBS (no binary search): spheres are in linked lists of layers, of rows in a layer, and of cells
/// in a row. Only the lists in use exist. Memory is proportional to the number of spheres plus the
/// number of cells along each direction, not to the number of cells.
///
/// A row is tested against the row before it and three rows of the layer before: 13 of the 26 cells
/// around a cell (half stencil). A cell is opened for a sphere only if the shared face, edge or
/// corner is within the sphere's contact range. Cells are as wide as the largest cutoff, 2 r_max +
/// reach (wider beyond 8 N + 64 cells in a direction), which suits spheres of similar size.
///
/// Source: A. Munjiza, K. R. F. Andrews, Int. J. Numer. Meth. Engng 43 (1998) 131; proximity of
///         edges: T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113. Their method moves each
///         sphere as soon as its contacts are known; here all pairs are found at one instant.
/// Shapes: none. Units: SI. Errors: InputError for a sphere without a finite position or size.
/// Tests:  tests/search/searches.cpp (pair sets identical to BruteForce).
/// Valid:  spheres of any sizes; fast for similar sizes.
class Nbs {
 public:
  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    detail::space_order(spheres, reach, domain, team, order);
  }

  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    build(spheres, reach, domain, team);
    found_(team, pairs, [&](std::size_t part, std::size_t parts, detail::PairBuffer& found) {
      Sweep<Domain> sweep(*this, spheres.rows, reach, domain, found);
      for (std::size_t l = first_layer(part, parts); l < first_layer(part + 1, parts); ++l)
        sweep(layers_[l].z);
    });
  }

  /// First half of find(): lists the spheres of each layer.
  template <class Domain>
  void build(const SphereSet& spheres, double reach, const Domain& domain, const Team& team) {
    const std::size_t n = spheres.rows.size();
    const Box bounds = detail::bounds_of(spheres, domain, team);
    const Vec3d e = bounds.extent();
    range_ = spheres.largest_radius + reach;
    margin_ =
        n == 0 ? 0 : 1e-9 * (range_ + spheres.largest_radius) + 1e-15 * std::max({e.x, e.y, e.z});
    const std::size_t most = 8 * n + 64;
    frame_ = detail::finest_frame(
        bounds, spheres.largest_radius + range_, domain, [most](const detail::GridFrame& f) {
          return *std::max_element(f.count.begin(), f.count.end()) <= most;
        });
    list_layers(spheres.rows, team);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  struct Cell {
    std::uint32_t x, y, z;
  };
  struct Layer {
    std::uint32_t z;
    std::size_t before;  // spheres in the layers before it
  };

  void list_layers(std::span<const PositionRow> rows, const Team& team) {
    const std::size_t n = rows.size();
    cell_.resize(n);
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        cell_[k] = {static_cast<std::uint32_t>(frame_.along(rows[k].x, 0)),
                    static_cast<std::uint32_t>(frame_.along(rows[k].y, 1)),
                    static_cast<std::uint32_t>(frame_.along(rows[k].z, 2))};
    });
    for (auto* next : {&in_layer_, &in_row_[0], &in_row_[1], &in_cell_[0], &in_cell_[1]})
      next->resize(n);
    layer_.assign(frame_.count[2], none), size_.assign(frame_.count[2], 0);
    for (std::size_t k = n; k-- > 0;) {
      auto& head = layer_[cell_[k].z];
      in_layer_[k] = head, head = static_cast<std::uint32_t>(k), ++size_[cell_[k].z];
    }
    layers_.clear();
    std::size_t before = 0;
    for (std::uint32_t z = 0; z < layer_.size(); ++z)
      if (layer_[z] != none) layers_.push_back({z, before}), before += size_[z];
  }

  std::size_t first_layer(std::size_t part, std::size_t parts) const {
    const std::size_t sphere = cell_.size() * part / parts;
    return static_cast<std::size_t>(
        std::partition_point(layers_.begin(), layers_.end(),
                             [sphere](const Layer& l) { return l.before < sphere; }) -
        layers_.begin());
  }

  template <class Domain>
  class Sweep;

  detail::GridFrame frame_;
  double range_ = 0, margin_ = 0;         // [m] reach of a sphere beyond its radius; for rounding
  DynArray<Cell> cell_;                   // of each sphere
  DynArray<Layer> layers_;                // that hold spheres
  DynArray<std::uint32_t> layer_, size_;  // for each z: its first sphere, their number
  // Next sphere of a list. A layer and its rows may be in use twice at a time: as those that are
  // tested (0) and as those before them (1).
  DynArray<std::uint32_t> in_layer_;
  std::array<DynArray<std::uint32_t>, 2> in_row_, in_cell_;
  detail::FoundInParts found_;
};

/// Processes one layer after the other.
template <class Domain>
class Nbs::Sweep {
 public:
  Sweep(Nbs& of, std::span<const PositionRow> rows, double reach, const Domain& domain,
        detail::PairBuffer& found)
      : nbs_(of), rows_(rows), reach_(reach), domain_(domain), found_(found) {
    for (auto& heads : row_) heads.assign(nbs_.frame_.count[1], none);
    for (auto& heads : cells_) heads.assign(nbs_.frame_.count[0], none);
  }

  void operator()(std::uint32_t z) {
    const std::uint32_t before = beside(z, -1, 2);
    list_rows(z, 0);
    if (before != none) list_rows(before, 1);
    for (std::uint32_t k = nbs_.layer_[z]; k != none; k = nbs_.in_layer_[k]) {
      const std::uint32_t y = nbs_.cell_[k].y;
      if (row_[0][y] == k) look_at_row(y);  // each row once: at its first sphere
    }
    clear_rows(z, 0);
    if (before != none) clear_rows(before, 1);
  }

 private:
  // Rows in use: the current one, the one before it, and three of the layer before.
  static constexpr int rows_in_work = 5;
  static constexpr int dy[rows_in_work] = {0, -1, -1, 0, 1}, dz[rows_in_work] = {0, 0, 1, 1, 1};

  std::uint32_t beside(std::uint32_t k, int step, int d) const {
    const auto n = static_cast<std::uint32_t>(nbs_.frame_.count[d]);
    const bool outside = (k == 0 && step < 0) || (k + 1 == n && step > 0);
    if (outside && !nbs_.frame_.wraps[d]) return none;
    return outside ? (step < 0 ? n - 1 : 0) : k + static_cast<std::uint32_t>(step);
  }

  /// Lists are in the order of the spheres' numbers, reversed alternately in layers and cells of
  /// rows. The direction does not matter.
  void list_rows(std::uint32_t z, int which) {
    for (std::uint32_t k = nbs_.layer_[z]; k != none; k = nbs_.in_layer_[k]) {
      auto& head = row_[which][nbs_.cell_[k].y];
      nbs_.in_row_[which][k] = head, head = k;
    }
  }
  void clear_rows(std::uint32_t z, int which) {
    for (std::uint32_t k = nbs_.layer_[z]; k != none; k = nbs_.in_layer_[k])
      row_[which][nbs_.cell_[k].y] = none;
  }

  void look_at_row(std::uint32_t y) {
    std::array<std::uint32_t, rows_in_work> heads;
    for (int r = 0; r < rows_in_work; ++r) {
      const std::uint32_t beside_y = beside(y, dy[r], 1);
      heads[r] = beside_y == none ? none : row_[dz[r]][beside_y];
      for (std::uint32_t k = heads[r]; k != none; k = nbs_.in_row_[dz[r]][k]) {
        auto& head = cells_[r][nbs_.cell_[k].x];
        nbs_.in_cell_[dz[r]][k] = head, head = k;
      }
    }
    for (std::uint32_t k = heads[0]; k != none; k = nbs_.in_row_[0][k]) look_at_sphere(k);
    for (int r = 0; r < rows_in_work; ++r)
      for (std::uint32_t k = heads[r]; k != none; k = nbs_.in_row_[dz[r]][k])
        cells_[r][nbs_.cell_[k].x] = none;
  }

  void look_at_sphere(std::uint32_t p) {
    const Cell& c = nbs_.cell_[p];
    const PositionRow& row = rows_[p];
    const auto& frame = nbs_.frame_;
    // Squares of the distances [m2] to the faces before and after it.
    const double range = row.r + nbs_.range_ + nbs_.margin_;
    const auto faces = [&](double x, std::uint32_t k, int d) {
      const double within = x - frame.low[d], edge = frame.edge(d);
      const double before = std::max(within - k * edge, 0.0),
                   after = std::max((k + 1.0) * edge - within, 0.0);
      return std::array<double, 3>{before * before, 0, after * after};
    };
    const auto fx = faces(row.x, c.x, 0), fy = faces(row.y, c.y, 1), fz = faces(row.z, c.z, 2);
    pair_with_list(p, nbs_.in_cell_[0][p], 0);
    for (int r = 0; r < rows_in_work; ++r) {
      const double to_row = fy[static_cast<std::size_t>(dy[r] + 1)] + (dz[r] == 1 ? fz[0] : 0);
      if (to_row >= range * range) continue;
      for (int dx = -1; dx <= (r == 0 ? -1 : 1); ++dx) {
        if (to_row + fx[static_cast<std::size_t>(dx + 1)] >= range * range) continue;
        const std::uint32_t x = beside(c.x, dx, 0);
        if (x != none) pair_with_list(p, cells_[r][x], dz[r]);
      }
    }
  }

  void pair_with_list(std::uint32_t p, std::uint32_t k, int which) {
    for (; k != none; k = nbs_.in_cell_[which][k])
      if (detail::within_reach(rows_[p], rows_[k], reach_, domain_)) found_.put({p, k});
  }

  Nbs& nbs_;
  std::span<const PositionRow> rows_;
  double reach_;  // [m]
  const Domain& domain_;
  detail::PairBuffer& found_;
  std::array<DynArray<std::uint32_t>, 2> row_;  // first spheres of the rows of both layers
  std::array<DynArray<std::uint32_t>, rows_in_work> cells_;  // and of the cells of rows in use
};

static_assert(NeighbourSearch<Nbs>);

}  // namespace silt
