// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <optional>
#include <unordered_map>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/narrow/clip.hpp>

/// Power diagram of weighted sites inside a convex body.
///
///   cell i = { x in the body : |x - s_i|^2 - w_i <= |x - s_j|^2 - w_j for all j }             (1)
///   distance of the plane between i and j from s_i = (|s_j - s_i|^2 + w_i - w_j)/(2 |s_j - s_i|)
///   dV_i/dw_j = -A_ij/(2 |s_j - s_i|),   dV_i/dw_i = -sum over j of dV_i/dw_j                 (2)
///
/// Each cell is cut from the body by its planes (narrow/clip.hpp); the neighbours of the previous
/// computation are used first. Planes farther from the site than all corners are skipped.
/// Source: F. Aurenhammer, SIAM J. Comput. 16 (1987) 78-96.
/// Valid:  up to Polyhedron::most_faces cells. Units: [m].
/// Tests:  tests/shape/laguerre_cells.cpp (voro++, sampling, differences of volumes)

namespace silt::inline SILT_TARGET::detail {

struct PowerSites {
  DynArray<Vec3d> at;       // [m]
  DynArray<double> weight;  // [m2]
};

class PowerCells {
 public:
  struct Neighbour {
    std::uint32_t cell;
    double area;  // [m2] of the face between the two
  };
  struct Cell {
    double volume = 0;  // [m3]; 0: empty
    Vec3d centroid{0, 0, 0};
    DynArray<Neighbour> neighbours;
  };

  /// The body must not move in memory.
  PowerCells(const Polyhedron& body, std::size_t cells)
      : body_(body), cells_(cells), met_(cells), faces_(first_cut_face + cells) {}

  /// Computes all cells; false as soon as one is smaller than `least` [m3].
  bool measure(const PowerSites& sites, double least) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto* graph = cut(sites, i);
      if (graph == nullptr) return false;
      measure(*graph, sites.at[i], i);
      if (!(cells_[i].volume >= least)) return false;
    }
    return true;
  }
  /// Results of the last measure().
  const DynArray<Cell>& cells() const { return cells_; }

  /// Cell i, in the thread's memory until the next one is cut; nullptr if it is empty. Its faces
  /// have the numbers of the body's, or first_cut_face + j towards cell j.
  const ClippedBody::Graph* cut(const PowerSites& sites, std::size_t i) {
    auto& body = ClippedBody::whole(body_);
    ++now_;
    met_[i] = now_;
    Cut state{sites, i, body, nullptr, std::numeric_limits<double>::infinity()};
    for (const auto& old : cells_[i].neighbours) {
      met_[old.cell] = now_;
      if (!cut_by(state, old.cell)) return nullptr;
    }
    for (std::size_t j = 0; j < cells_.size(); ++j)
      if (met_[j] != now_ && !cut_by(state, j)) return nullptr;
    return state.graph;
  }

 private:
  struct Cut {
    const PowerSites& sites;
    std::size_t i;
    ClippedBody& body;
    const ClippedBody::Graph* graph;
    double square;  // [m2] squared distance from the site to the farthest corner
  };
  struct FaceSum {
    std::uint64_t of = 0;  // the measurement to which it belongs
    Vec3d corner, twice_area;
  };

  /// Cuts by the plane towards cell j if it is near enough; false if nothing remains.
  static bool cut_by(Cut& cut, std::size_t j) {
    const auto& [at, weight] = cut.sites;
    const Vec3d way = at[j] - at[cut.i];
    const double square = dot(way, way), change = weight[cut.i] - weight[j];
    const double reach = square + change;  // twice the distance of (1), times |way|
    if (reach > 0 && reach * reach >= 4 * cut.square * square) return true;
    const double scale = 1 / std::sqrt(square);
    const Vec3d normal = scale * way;  // from j: the same plane, to the last bit
    if (!cut.body.cut({normal, 0.5 * (dot(normal, at[cut.i] + at[j]) + scale * change)},
                      first_cut_face + j))
      return false;
    if (cut.graph == &cut.body.graph()) return true;
    cut.graph = &cut.body.graph(), cut.square = 0;
    for (std::size_t v = 0; v < cut.graph->size; ++v) {
      const Vec3d r = cut.graph->at(v) - at[cut.i];
      cut.square = std::max(cut.square, dot(r, r));
    }
    return true;
  }

  /// Sums det = c . (a x b) over the edges a to b around faces with a corner c, about the site.
  void measure(const ClippedBody::Graph& g, const Vec3d& site, std::size_t i) {
    auto& cell = cells_[i];
    cell.neighbours.clear(), ++now_;
    double six = 0;
    Vec3d first{0, 0, 0};
    for (std::size_t v = 0; v < g.size; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t f = g.face[v][k];
        const Vec3d a = g.at(v) - site, b = g.at(g.neighbour[v][k]) - site;
        auto& face = faces_[f];
        if (face.of != now_) {
          face = {now_, a, {0, 0, 0}};
          if (f >= first_cut_face)
            cell.neighbours.push_back({static_cast<std::uint32_t>(f - first_cut_face), 0});
        }
        const Vec3d across = cross(a, b);
        const double det = dot(face.corner, across);
        six += det, first += det * (face.corner + a + b), face.twice_area += across;
      }
    cell.volume = six / 6;
    if (cell.volume > 0) cell.centroid = site + first * (1 / (4 * six));
    for (auto& n : cell.neighbours) n.area = 0.5 * norm(faces_[first_cut_face + n.cell].twice_area);
  }

  const Polyhedron& body_;
  DynArray<Cell> cells_;
  std::uint64_t now_ = 0;
  DynArray<std::uint64_t> met_;  // when a cell's plane was last tried
  DynArray<FaceSum> faces_;      // by their numbers
};

/// Makes polyhedra of cells, one after the other. A shared corner has the same numbers, bit for
/// bit, in all cells: it is identified by the four cells and faces that meet there.
class CellForms {
 public:
  /// Edges shorter than this part of a cell's diagonal are not clean: the normal of such a thin
  /// triangle is accurate to 1e-11, and the hull takes 1e-10 of the diagonal for rounding.
  static constexpr double shortest = 1e-5;

  explicit CellForms(std::size_t cells) : cells_(cells) {}

  /// Cell i. With `must_be_clean`: none if it has such an edge (other than those of the body) or if
  /// the hull has lost a corner or a face.
  /// Errors: InputError for a cell that is flat to rounding.
  std::optional<Polyhedron> form(const ClippedBody::Graph& g, std::size_t i, bool must_be_clean) {
    DynArray<Vec3d> points;
    Box box;
    for (std::size_t v = 0; v < g.size; ++v) {
      points.push_back(shared_.try_emplace(name(g, v, i), g.at(v)).first->second);
      box.include(points.back());
    }
    const double least = shortest * norm(box.extent());
    std::size_t corners = g.size;
    bool clean = true;
    for (std::size_t v = 0; v < g.size; ++v)
      for (const std::size_t other : {g.neighbour[v][0], g.neighbour[v][1], g.neighbour[v][2]}) {
        if (other < v) continue;
        const Vec3d edge = points[other] - points[v];
        if (is_of_body(g, v) && is_of_body(g, other))
          corners -= dot(edge, edge) == 0;  // a corner of more than three edges
        else
          clean &= dot(edge, edge) >= least * least;
      }
    if (must_be_clean && !clean) return {};
    auto out = Polyhedron::from_points(points);
    // V vertices with three edges each, and F faces: V - 3/2 V + F = 2.
    clean &= out.vertices().size() == corners && out.faces().size() == 2 + g.size / 2;
    if (must_be_clean && !clean) return {};
    return out;
  }

 private:
  static bool is_of_body(const ClippedBody::Graph& g, std::size_t v) {
    const auto& f = g.face[v];
    return std::max({f[0], f[1], f[2]}) < first_cut_face;
  }
  std::uint64_t name(const ClippedBody::Graph& g, std::size_t v, std::size_t i) const {
    std::array<std::uint64_t, 4> who{i};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t f = g.face[v][k];
      who[k + 1] = f < first_cut_face ? cells_ + f : f - first_cut_face;
    }
    std::sort(who.begin(), who.end());
    return who[0] << 48 | who[1] << 32 | who[2] << 16 | who[3];
  }

  std::size_t cells_;
  std::unordered_map<std::uint64_t, Vec3d> shared_;
};

}  // namespace silt::detail
