// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/flow_sides.hpp>
#include <silt/fluid/flow_solids.hpp>
#include <silt/fluid/grid.hpp>
#include <silt/fluid/k_epsilon.hpp>
#include <silt/fluid/mixing_length.hpp>

namespace silt::inline SILT_TARGET {

/// y+ of cells at walls [-].
struct WallUnits {
  double least = 0, mean = 0, most = 0;
};

namespace fluid_detail {

/// Fields of KEpsilon in cells.
struct TwoEquations {
  TwoEquations(const Grid& grid, const KEpsilon& m)
      : model(m), k(grid), epsilon(grid), made(grid), slopes(grid), kind(grid) {}

  // Kinds of cells; passed: with open faces, but with the centre in a wall.
  static constexpr double closed = 0, passed = 1, beside_wall = 2, free = 3;
  static constexpr double least = 1e-30;  // of k and epsilon

  KEpsilon model;
  CellField k, epsilon, made;  // [m2/s2], [m2/s3]; P [m2/s3] at the start of the step
  CellField slopes;            // [-] squared slopes of a logarithm over those of central
                               // differences
  CellField kind;
  std::array<std::array<double, 2>, 3> inflow{};  // [m2/s2] k of each side
};

/// Turbulence of a flow: eddy viscosity in cells, wall shear on faces.
///
/// Viscosity acts towards a wall by links mu/(theta h^2) (FlowSolids; 2 mu/h^2 at a side of the
/// box). WallLaw increases them by the factor y+/u+:
///   drag = sum link (y+/u+ - 1),  u+ y+ = |u - u_w| y/nu
/// The area of an oblique wall is then right, as in laminar flow. Between velocities at the
/// distances y1 and y2 from a wall the profile is logarithmic, and its slope in the middle is
/// smaller than the difference quotient: there mu_t has the factor
///   edges = 2 (y2 - y1)/((y2 + y1) ln(y2/y1))
struct FlowTurbulence {
  FlowTurbulence(const Grid& grid, const KEpsilon& m)
      : FlowTurbulence(grid, MixingLength{0.5 * m.width}) {
    two.emplace(grid, m);
  }
  FlowTurbulence(const Grid& grid, const MixingLength& m)
      : model(m),
        eddy(grid),
        square(grid),
        distance(grid),
        open{CellField(grid, 1), CellField(grid, 1), CellField(grid, 1)},
        edges{open, open, open},
        drag{CellField(grid), CellField(grid), CellField(grid)},
        push{CellField(grid), CellField(grid), CellField(grid)} {}

  MixingLength model;
  std::optional<TwoEquations> two;  // instead of the mixing length
  bool ready = false;               // up to date with the walls
  bool found = false;               // up to date with the velocities
  double largest = 0;               // [Pa s] largest eddy viscosity of the last step
  WallUnits walls;
  CellField eddy;              // [Pa s]
  CellField square, distance;  // [m2], [m] l^2 undamped, y; 0 in solids and at walls
  Three open;                  // [-] faces between which eddies carry momentum: not those in walls
  std::array<Three, 3> edges;  // [-] of component d and direction e: from a face to the next
  Three drag, push;            // [kg/(m3 s)], [N/m3] of walls, beyond the laminar ones

  /// Finds the walls.
  void prepare(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary,
               const FlowSolids* solids, double viscosity, double nu, double fastest) {
    for (int d = 0; d < 3; ++d) {
      find_faces(grid, sides, boundary, solids, viscosity, d);
      find_edges(grid, sides, boundary, d);
    }
    find_cells(grid, sides, boundary, solids);
    if (two) sides.fill_cells(two->kind), begin(grid, sides, nu, fastest);
    ready = true;
  }

  /// Eddy viscosity and wall shear of a flow; ghosts of `u` are filled.
  void find(const Grid& grid, const FlowSides& sides, const Three& u, double density,
            double viscosity, const Team& team) {
    const double over[3] = {1 / grid.h().x, 1 / grid.h().y, 1 / grid.h().z};
    const double nu = viscosity / density;
    DynArray<double> most(static_cast<std::size_t>(grid.nz()), 0.0);
    team.for_parts(most.size(), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) {
          const double l2 = square(i, j, k);
          if (l2 == 0) continue;
          double squares = 0;  // 2 S:S
          for (int d = 0; d < 3; ++d) {
            const CellField& v = u[at(d)];
            const double along =
                over[d] * (v(i + (d == 0), j + (d == 1), k + (d == 2)) - v(i, j, k));
            squares += 2 * along * along;
            const int e = (d + 1) % 3;
            const double shear =
                slope(v, d, e, i, j, k) * over[e] + slope(u[at(e)], e, d, i, j, k) * over[d];
            squares += shear * shear;
          }
          if (two) {
            const double nu_t = two->model.eddy(two->k(i, j, k), two->epsilon(i, j, k));
            two->made(i, j, k) = nu_t * squares * two->slopes(i, j, k);
            eddy(i, j, k) = density * nu_t;
          } else {
            const double S = std::sqrt(squares), y = distance(i, j, k);
            const double damped = MixingLength::damping(y * std::sqrt((nu + l2 * S) * S) / nu);
            eddy(i, j, k) = density * l2 * damped * damped * S;
          }
          most[plane] = std::max(most[plane], eddy(i, j, k));
        }
    });
    largest = *std::max_element(most.begin(), most.end());
    for (const WallCell& c : cells_) {
      Vec3d v{0, 0, 0};
      double* const of[3] = {&v.x, &v.y, &v.z};
      for (int d = 0; d < 3; ++d)
        *of[d] = 0.5 * (u[at(d)](c.i, c.j, c.k) +
                        u[at(d)](c.i + (d == 0), c.j + (d == 1), c.k + (d == 2)));
      const double u_plus = WallLaw::u_plus(norm(v - c.wall) * c.distance / nu);
      const double value = c.share * viscosity * WallLaw::eddy(u_plus);
      eddy(c.i, c.j, c.k) = value, largest = std::max(largest, value);
      if (two) at_wall(c, u_plus, nu);
    }
    sides.fill_cells(eddy);
    walls = {std::numeric_limits<double>::infinity(), 0, 0};
    std::size_t count = 0;
    for (int d = 0; d < 3; ++d) {
      CellField &D = drag[at(d)], &P = push[at(d)];
      for (const WallFace& f : faces_[at(d)]) D(f.i, f.j, f.k) = P(f.i, f.j, f.k) = 0;
      for (const WallFace& f : faces_[at(d)]) {
        const double u_plus =
            WallLaw::u_plus(norm(velocity_at(u, d, f.i, f.j, f.k) - f.wall) * f.distance / nu);
        if (!(u_plus > 0)) continue;
        const double y_plus = WallLaw::y_plus(u_plus), more = f.link * (y_plus / u_plus - 1);
        D(f.i, f.j, f.k) += more;
        P(f.i, f.j, f.k) += more * (d == 0 ? f.wall.x : d == 1 ? f.wall.y : f.wall.z);
        walls.least = std::min(walls.least, y_plus), walls.most = std::max(walls.most, y_plus);
        walls.mean += y_plus, ++count;
      }
    }
    if (count > 0) walls.mean /= static_cast<double>(count);
    if (count == 0) walls = {};
  }
  /// k of inflows, for k-epsilon.
  void renew_inflow(const FlowSides& sides) {
    for (int e = 0; e < 3 && two; ++e)
      for (int end = 0; end < 2; ++end)
        two->inflow[at(e)][at(end)] =
            std::max(TwoEquations::least, two->model.energy(sides.inflow_speed(e, end)));
  }

 private:
  struct WallFace {
    int i, j, k;
    double link, distance;  // [kg/(m3 s)], [m]
    Vec3d wall;             // [m/s]
  };
  struct WallCell {
    int i, j, k;
    double distance, share;  // [m]; [-] l over kappa y
    Vec3d wall;              // [m/s]
    double middle;           // [m] distance of the middle of its fluid part
  };
  static std::size_t at(int d) { return static_cast<std::size_t>(d); }

  /// (4) of KEpsilon; `u_plus` is at c.distance.
  void at_wall(const WallCell& c, double u_plus, double nu) {
    const double ustar = WallLaw::y_plus(u_plus) * nu / c.distance;
    const double g = 1 / (1 + WallLaw::eddy(WallLaw::u_plus_at(c.middle * ustar / nu)));
    two->made(c.i, c.j, c.k) = std::pow(ustar, 4) / nu * g * (1 - g);
    two->epsilon(c.i, c.j, c.k) =
        std::max(TwoEquations::least,
                 two->model.dissipation(two->k(c.i, c.j, c.k), WallLaw::kappa * c.middle));
  }
  /// Inflows, and initial k and epsilon where not set; `fastest` [m/s] of the flow.
  void begin(const Grid& grid, const FlowSides& sides, double nu, double fastest) {
    const KEpsilon& m = two->model;
    renew_inflow(sides);
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end) fastest = std::max(fastest, sides.inflow_speed(e, end));
    const double l = m.inflow_length(), k0 = m.start_energy(fastest, nu);
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) {
          double &energy = two->k(i, j, k), &epsilon = two->epsilon(i, j, k);
          require(std::isfinite(energy) && std::isfinite(epsilon) && energy >= 0 && epsilon >= 0,
                  "FlowSolver: cell (", i, ", ", j, ", ", k, ") has k = ", energy,
                  " m2/s2 and epsilon = ", epsilon, " m2/s3; give them values above 0");
          if (energy == 0) energy = k0;
          if (epsilon == 0) epsilon = m.dissipation(energy, l);
        }
  }
  /// Squared ratio of the slope of a logarithm to that of central differences.
  static double log_slopes(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary,
                           int i, int j, int k, double y) {
    const double h[3] = {grid.h().x, grid.h().y, grid.h().z};
    double sum = 0;
    for (int e = 0; e < 3; ++e) {
      double beyond[2];
      for (const int end : {0, 1}) {
        double x[3] = {i + 0.5, j + 0.5, k + 0.5};
        x[e] += end ? 1 : -1;
        if (grid.periodic(e)) x[e] -= grid.cells()[at(e)] * std::floor(x[e] / grid.cells()[at(e)]);
        Vec3d wall;
        beyond[end] =
            std::max(FlowSolids::nearest * h[e], distance_at(grid, sides, boundary, x, wall));
      }
      const double slope = std::log(beyond[1] / beyond[0]) / (2 * h[e]);
      if (std::isfinite(slope)) sum += slope * slope;
    }
    // Far from walls it is 1, and near the middle of a pipe the profile is not logarithmic.
    return sum > 0 && std::sqrt(sum) * y > 1 ? 1 / (sum * y * y) : 1;
  }

  /// Half the difference over two cells in direction e of component d at the centre of a cell.
  static double slope(const CellField& v, int d, int e, int i, int j, int k) {
    const int a[3] = {d == 0, d == 1, d == 2}, b[3] = {e == 0, e == 1, e == 2};
    const auto pair = [&](int way) {
      const int x = i + way * b[0], y = j + way * b[1], z = k + way * b[2];
      return v(x, y, z) + v(x + a[0], y + a[1], z + a[2]);
    };
    return 0.25 * (pair(1) - pair(-1));
  }
  static Vec3d place(const Grid& grid, double i, double j, double k) {
    const Vec3d h = grid.h();
    return grid.box().min + Vec3d{i * h.x, j * h.y, k * h.z};
  }

  void find_faces(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary,
                  const FlowSolids* solids, double viscosity, int d) {
    const auto& n = grid.cells();
    const double h[3] = {grid.h().x, grid.h().y, grid.h().z};
    auto& faces = faces_[at(d)];
    faces.clear(), drag[at(d)].fill(0), push[at(d)].fill(0);
    open[at(d)].fill(1);
    if (solids != nullptr) open[at(d)] = solids->inside[at(d)];
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          if (open[at(d)](i, j, k) == 0) continue;
          for (int e = 0; e < 3; ++e)
            for (const int way : {-1, 1}) {
              int to[3] = {i, j, k};
              to[e] += way;
              const int end = way > 0, m = n[at(e)];
              if (!grid.periodic(e) && (to[e] < 0 || to[e] >= m + (e == d))) {
                const Vec3d* const wall = sides.wall(e, end);
                if (wall == nullptr || e == d) continue;
                open[at(d)](to[0], to[1], to[2]) = 0;
                faces.push_back({i, j, k, 2 * viscosity / (h[e] * h[e]), 0.5 * h[e], *wall});
              } else if (boundary != nullptr && open[at(d)](to[0], to[1], to[2]) == 0) {
                Vec3d x = place(grid, i + (d == 0 ? 0 : 0.5), j + (d == 1 ? 0 : 0.5),
                                k + (d == 2 ? 0 : 0.5));
                Vec3d beyond = x;
                (e == 0 ? beyond.x : e == 1 ? beyond.y : beyond.z) += way * h[e];
                const double here = boundary->distance(x), there = boundary->distance(beyond);
                const double theta = std::clamp(here / (here - there), FlowSolids::nearest, 1.0);
                (e == 0 ? x.x : e == 1 ? x.y : x.z) += way * theta * h[e];
                faces.push_back({i, j, k, viscosity / (theta * h[e] * h[e]), here,
                                 boundary->velocity ? boundary->velocity(x) : Vec3d{0, 0, 0}});
              }
            }
        }
  }
  void find_edges(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary, int d) {
    const auto& n = grid.cells();
    const Vec3d h = grid.h();
    const double least = FlowSolids::nearest * std::min({h.x, h.y, h.z});
    CellField y(grid);
    const auto for_all = [&](int before, const auto& visit) {
      for (int k = -before; k <= n[2]; ++k)
        for (int j = -before; j <= n[1]; ++j)
          for (int i = -before; i <= n[0]; ++i) visit(i, j, k);
    };
    for_all(1, [&](int i, int j, int k) {
      if (open[at(d)](i, j, k) == 0) return;
      double x[3] = {i + 0.0, j + 0.0, k + 0.0};
      for (int e = 0; e < 3; ++e) {
        if (grid.periodic(e)) x[e] -= n[at(e)] * std::floor(x[e] / n[at(e)]);
        if (e != d) x[e] += 0.5;
      }
      Vec3d wall;
      y(i, j, k) = std::max(least, distance_at(grid, sides, boundary, x, wall));
    });
    for (int e = 0; e < 3; ++e) {
      const int s[3] = {e == 0, e == 1, e == 2};
      CellField& share = edges[at(d)][at(e)];
      share.fill(0);
      for (int k = -1; k < n[2] + (d == 2); ++k)
        for (int j = -1; j < n[1] + (d == 1); ++j)
          for (int i = -1; i < n[0] + (d == 0); ++i) {
            const double a = y(i, j, k), b = y(i + s[0], j + s[1], k + s[2]);
            if (!(a > 0 && b > 0)) continue;
            const bool flat = !(std::abs(a - b) > 1e-3 * (a + b));  // includes open space
            share(i, j, k) = flat ? 1 : 2 * (b - a) / ((b + a) * std::log(b / a));
          }
    }
  }
  /// Distance from the nearest wall, and its velocity; `x` in cells.
  static double distance_at(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary,
                            const double (&x)[3], Vec3d& wall) {
    double y = std::numeric_limits<double>::infinity();
    const Vec3d at_x = place(grid, x[0], x[1], x[2]);
    wall = {0, 0, 0};
    if (boundary != nullptr) y = boundary->distance(at_x);
    if (boundary != nullptr && boundary->velocity) wall = boundary->velocity(at_x);
    const double h[3] = {grid.h().x, grid.h().y, grid.h().z};
    for (int e = 0; e < 3; ++e)
      for (int end = 0; end < 2; ++end) {
        const Vec3d* const side = sides.wall(e, end);
        const double away = (end ? grid.cells()[at(e)] - x[e] : x[e]) * h[e];
        if (side != nullptr && away < y) y = away, wall = *side;
      }
    return y;
  }
  void find_cells(const Grid& grid, const FlowSides& sides, const FlowBoundary* boundary,
                  const FlowSolids* solids) {
    const auto& n = grid.cells();
    const double half = 0.5 * std::min({grid.h().x, grid.h().y, grid.h().z});
    cells_.clear(), eddy.fill(0), square.fill(0), distance.fill(0);
    if (two) two->kind.fill(TwoEquations::closed), two->made.fill(0);
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          if (solids != nullptr && solids->cells(i, j, k) == 0) continue;
          Vec3d wall;
          const double y = distance_at(grid, sides, boundary, {i + 0.5, j + 0.5, k + 0.5}, wall);
          if (two) two->kind(i, j, k) = TwoEquations::passed;
          if (!(y > 0)) continue;
          const double l = model.length(y);
          const bool beside = is_beside_walls(i, j, k);
          if (beside)
            cells_.push_back({i, j, k, two ? std::max(y, 2 * FlowSolids::nearest * half) : y,
                              two ? 1 : std::min(1.0, l / (WallLaw::kappa * y)), wall,
                              y < half ? 0.5 * (y + half) : y});
          else
            square(i, j, k) = l * l, distance(i, j, k) = std::min(y, 1e3 * model.half_width);
          if (!two) continue;
          two->kind(i, j, k) = beside ? TwoEquations::beside_wall : TwoEquations::free;
          two->slopes(i, j, k) = beside ? 1 : log_slopes(grid, sides, boundary, i, j, k, y);
        }
  }
  /// True if differences around a cell would use velocities in walls.
  bool is_beside_walls(int i, int j, int k) const {
    for (int d = 0; d < 3; ++d) {
      const CellField& o = open[at(d)];
      const int a[3] = {d == 0, d == 1, d == 2};
      for (int e = 0; e < 3; ++e)
        for (int way = -1; way <= (e == d ? 0 : 1); ++way) {
          const int on = e == d ? 0 : way;
          const int x = i + on * (e == 0), y = j + on * (e == 1), z = k + on * (e == 2);
          if (o(x, y, z) == 0 || o(x + a[0], y + a[1], z + a[2]) == 0) return true;
        }
    }
    return false;
  }

  std::array<DynArray<WallFace>, 3> faces_;
  DynArray<WallCell> cells_;
};

}  // namespace fluid_detail

}  // namespace silt
