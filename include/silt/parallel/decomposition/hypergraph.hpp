// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/parallel/decomposition/concept.hpp>
#include <silt/parallel/zoltan.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// A cell of a coarse grid, with the sums over its points on all ranks.
struct WorkCell {
  std::uint64_t id;
  std::int64_t work;  // integer weights
  std::int64_t points;
  int rank;  // the rank that owns it, or has most of its points

  friend bool operator<(const WorkCell& a, const WorkCell& b) { return a.id < b.id; }
};

/// Cells of `side` [m] that cover a box.
struct WorkGrid {
  Vec3d origin{0, 0, 0};
  double side = 0;  // [m]
  std::array<std::int64_t, 3> cells{0, 0, 0};

  WorkGrid() = default;
  WorkGrid(const Box& box, double cell) : origin(box.min), side(cell) {
    const auto e = box.extent();
    const std::array<double, 3> extent{e.x, e.y, e.z};
    for (std::size_t d = 0; d < 3; ++d)
      cells[d] = 1 + static_cast<std::int64_t>(std::min(extent[d] / side, 1048574.0));
  }

  /// Indices of the cell around a position, or of the nearest cell.
  std::array<std::int64_t, 3> at(const Vec3d& p) const {
    const std::array<double, 3> x{(p.x - origin.x) / side, (p.y - origin.y) / side,
                                  (p.z - origin.z) / side};
    std::array<std::int64_t, 3> c{};
    for (std::size_t d = 0; d < 3; ++d)
      c[d] = static_cast<std::int64_t>(std::clamp(x[d], 0.0, static_cast<double>(cells[d]) - 1));
    return c;
  }
  std::uint64_t id(const std::array<std::int64_t, 3>& c) const {
    return static_cast<std::uint64_t>((c[2] * cells[1] + c[1]) * cells[0] + c[0]);
  }
  std::array<std::int64_t, 3> place(std::uint64_t id) const {
    const auto k = static_cast<std::int64_t>(id);
    return {k % cells[0], k / cells[0] % cells[1], k / cells[0] / cells[1]};
  }
  /// Calls f(id) for the cells at this distance (the largest difference along an axis).
  template <class F>
  void for_shell(const std::array<std::int64_t, 3>& c, std::int64_t distance, const F& f) const {
    for (std::int64_t k = -distance; k <= distance; ++k)
      for (std::int64_t j = -distance; j <= distance; ++j) {
        const bool inner = std::max(std::abs(k), std::abs(j)) < distance;
        for (std::int64_t i = -distance; i <= distance; i += inner ? 2 * distance : 1) {
          const std::array<std::int64_t, 3> other{c[0] + i, c[1] + j, c[2] + k};
          bool there = true;
          for (std::size_t d = 0; d < 3; ++d) there &= other[d] >= 0 && other[d] < cells[d];
          if (there) f(id(other));
          if (distance == 0) break;
        }
      }
  }
};

inline const WorkCell* find_cell(const std::vector<WorkCell>& cells, std::uint64_t id) {
  const auto at = std::lower_bound(cells.begin(), cells.end(), WorkCell{id, 0, 0, 0});
  return at != cells.end() && at->id == id ? &*at : nullptr;
}

/// The callbacks' data of one rank: the cells that it owns. Each is a vertex and, with its
/// neighbours, a hyperedge, whose weight is the number of points that become ghosts if it is cut.
struct ZoltanCells {
  std::vector<WorkCell> cells;
  double mean;                                     // work of a cell
  std::vector<std::vector<std::uint64_t>> around;  // ids, including the cell's own
  int pins = 0;

  static const ZoltanCells& of(void* data) { return *static_cast<const ZoltanCells*>(data); }
  static void put(ZOLTAN_ID_PTR to, std::size_t k, std::uint64_t id) {
    to[2 * k] = static_cast<ZOLTAN_ID_TYPE>(id & 0xffffffffu);
    to[2 * k + 1] = static_cast<ZOLTAN_ID_TYPE>(id >> 32);
  }

  static int count(void* data, int* error) {
    *error = ZOLTAN_OK;
    return static_cast<int>(of(data).cells.size());
  }
  static void list(void* data, int, int, ZOLTAN_ID_PTR ids, ZOLTAN_ID_PTR places, int,
                   float* weights, int* error) {
    const auto& own = of(data);
    for (std::size_t k = 0; k < own.cells.size(); ++k) {
      put(ids, k, own.cells[k].id);
      places[k] = static_cast<ZOLTAN_ID_TYPE>(k);
      weights[k] = static_cast<float>(static_cast<double>(own.cells[k].work) / own.mean);
    }
    *error = ZOLTAN_OK;
  }
  static void sizes(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR places, int* size,
                    int* error) {
    for (int k = 0; k < n; ++k) size[k] = static_cast<int>(of(data).cells[places[k]].points);
    *error = ZOLTAN_OK;
  }
  static void edge_sizes(void* data, int* edges, int* pins, int* format, int* error) {
    *edges = static_cast<int>(of(data).cells.size());
    *pins = of(data).pins;
    *format = ZOLTAN_COMPRESSED_EDGE;
    *error = ZOLTAN_OK;
  }
  static void edges(void* data, int, int, int, int, ZOLTAN_ID_PTR ids, int* starts,
                    ZOLTAN_ID_PTR pins, int* error) {
    const auto& own = of(data);
    std::size_t next = 0;
    for (std::size_t k = 0; k < own.cells.size(); ++k) {
      put(ids, k, own.cells[k].id);
      starts[k] = static_cast<int>(next);
      for (const auto id : own.around[k]) put(pins, next++, id);
    }
    *error = ZOLTAN_OK;
  }
  static void edge_count(void* data, int* edges, int* error) {
    *edges = static_cast<int>(of(data).cells.size());
    *error = ZOLTAN_OK;
  }
  static void edge_weights(void* data, int, int, int, int, ZOLTAN_ID_PTR ids, ZOLTAN_ID_PTR places,
                           float* weights, int* error) {
    const auto& own = of(data);
    for (std::size_t k = 0; k < own.cells.size(); ++k) {
      put(ids, k, own.cells[k].id);
      places[k] = static_cast<ZOLTAN_ID_TYPE>(k);
      weights[k] = static_cast<float>(own.cells[k].points);
    }
    *error = ZOLTAN_OK;
  }
};

}  // namespace detail

/// Hypergraph partitioning by Zoltan (PHG), for MPI: parts of equal work with few ghosts between
/// them, of any form. Vertices are the cells of a coarse grid; a cell with its neighbours is a
/// hyperedge, whose weight is the number of its points: what is cut is the number of points that
/// other ranks need, provided that no contact reaches farther than a cell. Later partitions leave
/// cells where they are unless a move reduces the total cost.
///
/// Parts consist of whole cells. Work is balanced to the tolerance, or to a cell's work.
///
/// Source: Devine, Boman, Heaphy, Bisseling, Catalyurek, IPDPS (2006); Catalyurek et al., IPDPS
///         (2007) for repartitioning (recalled); Zoltan of Trilinos 13.2, LB_METHOD = HYPERGRAPH.
/// Errors: InputError for settings out of range, Error if Zoltan fails.
/// Tests:  tests/mpi/decompositions.cpp (work, ghosts beside Bisection's).
/// Valid:  where a cell is at least as wide as the range of contacts, and Zoltan is installed.
/// Units:  [m]; work in units of the weights.
struct Hypergraph {
  double cell = 0;  // [m] side of the cells; 0: some cells_a_rank of them with points a rank
  double cells_a_rank = 100;
  double tolerance = 1.03;  // [-] largest over mean work that Zoltan aims at
  /// Cost of a ghost relative to that of a point that moves [-]; from 1 on Zoltan almost ignores
  /// the previous partition.
  double ghosts_a_move = 0.1;
  detail::WorkGrid grid = {};
  std::vector<detail::WorkCell> cells = {};  // by id, each with its rank
  detail::ZoltanHandle zoltan = {};
  int ranks = 0;  // number of ranks

  static constexpr bool by_place = true;

  std::vector<int> partition(const MpiComm& comm, std::span<const Vec3d> points,
                             std::span<const double> weights) {
    require_not_negative("Hypergraph.cell", cell, "m");
    require(std::isfinite(cells_a_rank) && cells_a_rank >= 1,
            "Hypergraph.cells_a_rank = ", cells_a_rank, " [-] must be finite and at least 1");
    require(std::isfinite(tolerance) && tolerance >= 1, "Hypergraph.tolerance = ", tolerance,
            " [-] must be finite and at least 1");
    require_positive("Hypergraph.ghosts_a_move", ghosts_a_move, "-");
    const detail::WholeWeights whole(comm, points, weights);
    if (whole.points > 0) {
      const auto before = std::pair(grid, std::move(cells));
      count_cells(comm, points, whole);
      bool again = ranks == comm.size() && !before.second.empty();
      if (again)  // owners as before
        for (auto& c : cells) c.rank = rank_in(before.first, before.second, centre(c.id));
      if (cells.size() <= static_cast<std::size_t>(comm.size())) {  // nothing to divide
        for (std::size_t k = 0; k < cells.size(); ++k) cells[k].rank = static_cast<int>(k);
      } else {
        std::vector<detail::WorkCell> own;
        std::exception_ptr error;
        try {
          own = divide(comm, again);
        } catch (const Error&) {
          error = std::current_exception();
        }
        agree(comm, "Zoltan's PHG", error);
        cells = gather(comm, std::span<const detail::WorkCell>(own)).values;
        std::sort(cells.begin(), cells.end());
      }
    }
    std::vector<int> owner;
    owner.reserve(points.size());
    for (const auto& p : points) owner.push_back(is_finite(p) ? rank_of(p) : comm.rank());
    return owner;
  }

  int rank_of(const Vec3d& place) const { return rank_in(grid, cells, place); }

 private:
  Vec3d centre(std::uint64_t id) const {
    const auto c = grid.place(id);
    const auto at = [&](std::size_t d) { return (static_cast<double>(c[d]) + 0.5) * grid.side; };
    return grid.origin + Vec3d{at(0), at(1), at(2)};
  }

  /// The rank of the cell around a position; if there is none, of the nearest cell with points.
  static int rank_in(const detail::WorkGrid& grid, const std::vector<detail::WorkCell>& cells,
                     const Vec3d& place) {
    if (cells.empty()) return 0;
    const auto c = grid.at(place);
    if (const auto* own = detail::find_cell(cells, grid.id(c))) return own->rank;
    int rank = -1;
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    const auto look = [&](const detail::WorkCell& other) {
      const auto o = grid.place(other.id);
      std::int64_t squares = 0;
      for (std::size_t d = 0; d < 3; ++d) squares += (o[d] - c[d]) * (o[d] - c[d]);
      if (squares < least) least = squares, rank = other.rank;
    };
    for (std::int64_t distance = 1; rank < 0 && distance <= 4; ++distance)
      grid.for_shell(c, distance, [&](std::uint64_t id) {
        if (const auto* other = detail::find_cell(cells, id)) look(*other);
      });
    if (rank < 0)
      for (const auto& other : cells) look(other);
    return rank;
  }

  /// Collective: the cells with points, of all ranks.
  void count_cells(const MpiComm& comm, std::span<const Vec3d> points,
                   const detail::WholeWeights& whole) {
    const auto e = whole.box.extent();
    double longest = std::max({e.x, e.y, e.z});
    if (!(longest > 0)) longest = 1;  // all points coincide
    double side = cell;
    if (cell == 0) {  // twice: for the box, and for the cells with points
      const auto thick = [&](double x) { return std::max(x, 1e-3 * longest); };
      side = std::cbrt(thick(e.x) * thick(e.y) * thick(e.z) / (cells_a_rank * comm.size()));
      fill(comm, points, whole, side);
      side *= std::cbrt(static_cast<double>(cells.size()) / (cells_a_rank * comm.size()));
    }
    fill(comm, points, whole, std::max(side, longest * 1e-5));
  }

  void fill(const MpiComm& comm, std::span<const Vec3d> points, const detail::WholeWeights& whole,
            double side) {
    grid = {whole.box, side};
    std::vector<detail::WorkCell> own;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (is_finite(points[k]))
        own.push_back({grid.id(grid.at(points[k])), whole.weights[k], 1, comm.rank()});
    std::sort(own.begin(), own.end());
    std::vector<detail::WorkCell> sums;
    for (const auto& c : own) {
      if (sums.empty() || sums.back().id != c.id)
        sums.push_back(c);
      else
        sums.back().work += c.work, sums.back().points += c.points;
    }
    auto all = gather(comm, std::span<const detail::WorkCell>(sums)).values;
    std::stable_sort(all.begin(), all.end());
    cells.clear();
    std::int64_t most = 0;
    for (const auto& c : all) {
      if (cells.empty() || cells.back().id != c.id) {
        cells.push_back(c), most = c.points;
        continue;
      }
      if (c.points > most) cells.back().rank = c.rank, most = c.points;
      cells.back().work += c.work, cells.back().points += c.points;
    }
  }

  /// Collective: the cells that this rank had, with their new ranks.
  std::vector<detail::WorkCell> divide(const MpiComm& comm, bool again) {
    if (!zoltan || ranks != comm.size()) {
      zoltan.make(comm);
      ranks = comm.size();
      for (const auto& [parameter, value] : {std::pair{"LB_METHOD", "HYPERGRAPH"},
                                             {"HYPERGRAPH_PACKAGE", "PHG"},
                                             {"EDGE_WEIGHT_DIM", "1"},
                                             {"ADD_OBJ_WEIGHT", "NONE"},
                                             {"RETURN_LISTS", "PARTS"},
                                             {"REMAP", "1"},
                                             {"PHG_EDGE_SIZE_THRESHOLD", "1.0"},
                                             {"SEED", "20110401"}})
        zoltan.set(parameter, value);
    }
    zoltan.set("LB_APPROACH", again ? "REPARTITION" : "PARTITION");
    zoltan.set("IMBALANCE_TOL", std::to_string(tolerance));
    zoltan.set("PHG_REPART_MULTIPLIER", std::to_string(ghosts_a_move));
    detail::ZoltanCells own{};
    std::int64_t total = 0;
    for (const auto& c : cells) {
      total += c.work;
      if (c.rank != comm.rank()) continue;
      own.cells.push_back(c);
      auto& around = own.around.emplace_back();
      for (const std::int64_t distance : {0, 1})
        grid.for_shell(grid.place(c.id), distance, [&](std::uint64_t id) {
          if (detail::find_cell(cells, id) != nullptr) around.push_back(id);
        });
      own.pins += static_cast<int>(around.size());
    }
    own.mean = static_cast<double>(total) / static_cast<double>(cells.size());
    Zoltan_Struct* z = zoltan.get();
    Zoltan_Set_Num_Obj_Fn(z, detail::ZoltanCells::count, &own);
    Zoltan_Set_Obj_List_Fn(z, detail::ZoltanCells::list, &own);
    Zoltan_Set_Obj_Size_Multi_Fn(z, detail::ZoltanCells::sizes, &own);
    Zoltan_Set_HG_Size_CS_Fn(z, detail::ZoltanCells::edge_sizes, &own);
    Zoltan_Set_HG_CS_Fn(z, detail::ZoltanCells::edges, &own);
    Zoltan_Set_HG_Size_Edge_Wts_Fn(z, detail::ZoltanCells::edge_count, &own);
    Zoltan_Set_HG_Edge_Wts_Fn(z, detail::ZoltanCells::edge_weights, &own);
    zoltan.partition([&](unsigned k, int part) { own.cells[k].rank = part; });
    return own.cells;
  }
};
static_assert(Decomposition<Hypergraph, MpiComm>);

}  // namespace silt
