// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/joined_cells.hpp>
#include <silt/fluid/side_area.hpp>

namespace silt::inline SILT_TARGET {

namespace fluid_detail {

/// [-] Divisor of sums in cell i: the share of the cell open to the fluid; 1 for closed cells.
/// `open`: a row of FlowSolids::cells, or null in a box without solids.
inline double fluid_share(const double* open, int i) {
  return open != nullptr && open[i] > 0 ? open[i] : 1;
}

/// Velocity [m/s] at the centre of face (i, j, k) of direction d.
inline Vec3d velocity_at(const Three& u, int d, int i, int j, int k) {
  double v[3];
  for (int e = 0; e < 3; ++e) {
    const CellField& of = u[static_cast<std::size_t>(e)];
    if (e == d) {
      v[e] = of(i, j, k);
      continue;
    }
    v[e] = 0;
    for (int n = 0; n < 4; ++n) {  // both cells of the face, both faces of each
      const int back = n & 1, on = n >> 1;
      v[e] += 0.25 * of(i - back * (d == 0) + on * (e == 0), j - back * (d == 1) + on * (e == 1),
                        k - back * (d == 2) + on * (e == 2));
    }
  }
  return {v[0], v[1], v[2]};
}

/// Sliver: a face partly in the fluid with its centre in a wall. Its velocity u is at the middle of
/// its fluid part, at the distance `here` [m] from the wall. The neighbouring face in direction e
/// (`way` 1 or -1) has its centre in the fluid, at the distance `there`, with the velocity u_p.
/// Momentum exchange of u with the wall and with the fluid beyond:
///   link (u_w + here/there (u_p - u_w) - u),  link = mu/(here h (1 - here/there))    [N/m3]
/// In turbulent flow u is determined by the flow along the wall into and out of the sliver, unless
/// it exceeds u_p or this linear profile: then it is relaxed back with an additional rho |u_p|/h.
/// The whole wall friction acts on faces with their centres in the fluid; slivers must not add to
/// it.
struct Sliver {
  int i, j, k;
  int e, way;
  double here, there;
  Vec3d wall;  // [m/s]
};

/// Solids in the grid of a flow. The flux through a face is `area`, its share in the fluid, times
/// its velocity. With true areas a uniform flow along a plane wall remains uniform for any position
/// of the wall in the cells. Velocities are stored at the centres of faces in the fluid (`inside`),
/// and on slivers; values missing in solids are taken from neighbours in advection.
///
/// Towards a neighbour in a solid, viscosity acts over the true distance to the surface (theta h
/// instead of h):
///   mu (u_w - u)/(theta h^2) = mu (u_c - u)/h^2 + mu/h^2 (u_w/theta - u_c)
///                              - mu/h^2 (1/theta - 1) u
/// The first term is that of a neighbour with the solid's velocity u_c; the second is `push`, the
/// third is `drag` times u, which is implicit.
///
/// Fluxes into the volume of a velocity change only its fluid part, the share V of a cell: they
/// have the factor 1/V = 1 + `thin`. V is the largest open share of the flows into and out of the
/// volume; small volumes therefore do not limit the step.
///
/// Source:  F. Gibou et al., J. Comput. Phys. 176 (2002) 205 (symmetric Dirichlet condition); Y.
///          Cheny, O. Botella, J. Comput. Phys. 229 (2010) 1043 (areas of cut faces in staggered
///          cells).
struct FlowSolids {
  static constexpr double nearest = 0.05;     // lower bound of theta
  static constexpr double least_area = 1e-3;  // smaller ones are closed

  FlowSolids(const Grid& grid, const FlowBoundary& boundary, double viscosity)
      : area{CellField(grid), CellField(grid), CellField(grid)},
        inside{area},
        thin{area},
        drag{area},
        push{area},
        velocity{area},
        cells(grid),
        share(grid, 1) {
    for (int d = 0; d < 3; ++d) {
      CellField distance(grid);
      measure(grid, boundary, d, distance);
      find_slivers(grid, boundary, d, distance);
      find_links(grid, boundary, viscosity, d, distance);
      find_spans(grid, d);
    }
    const auto any = [](const CellField& f) {
      return std::any_of(f.values().begin(), f.values().end(), [](double v) { return v > 0; });
    };
    require(
        any(inside[0]) || any(inside[1]) || any(inside[2]),
        "FlowBoundary.distance leaves no face of the grid in the fluid; it must be above 0 there, "
        "and walls must be further apart than a cell");
    for (int d = 0; d < 3; ++d) find_thin(grid, d);
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) {
          const auto most = [&](const Three& of) {
            return std::max({of[0](i, j, k), of[0](i + 1, j, k), of[1](i, j, k), of[1](i, j + 1, k),
                             of[2](i, j, k), of[2](i, j, k + 1)});
          };
          if (most(inside) > 0) cells(i, j, k) = open_share(grid, boundary, i, j, k);
          if (most(area) > 0) share(i, j, k) = most(area);
        }
    find_corners(grid);
    joined.find(grid, boundary, area, cells);
  }

  Three area;       // [-] from 0 to 1
  Three inside;     // [-] 1 with the centre in the fluid, or 0
  Three thin;       // [-] 1/V - 1
  Three drag;       // [kg/(m3 s)]
  Three push;       // [N/m3] term with the walls' velocity
  Three velocity;   // [m/s] of the solid, on faces with their centres in it
  CellField cells;  // [-] open share of cells with a face whose centre is in the fluid; else 0
  CellField share;  // [-] V of cells
  std::array<DynArray<Sliver>, 3> slivers;
  JoinedCells joined;

  /// Copies the action of particles from the neighbour into cells with slivers only, where
  /// particles are not counted. Otherwise the fluid would have paths without drag there.
  void fill_corners(CellField& f) const {
    for (const auto& [to, from] : corners_) f(to[0], to[1], to[2]) = f(from[0], from[1], from[2]);
  }

  /// Values `from` ... `to`-1 of a row of faces; all others and their neighbours are in solids.
  struct Span {
    int from = 0, to = 0;
  };
  Span span(int d, int j, int k) const {
    return spans_[static_cast<std::size_t>(d)]
                 [static_cast<std::size_t>(k) * rows_ + static_cast<std::size_t>(j)];
  }

 private:
  void find_spans(const Grid& grid, int d) {
    const auto& n = grid.cells();
    const auto c = static_cast<std::size_t>(d);
    rows_ = static_cast<std::size_t>(n[1] + 1);
    spans_[c].assign(rows_ * static_cast<std::size_t>(n[2] + 1), {});
    for (int k = 0; k <= n[2]; ++k)
      for (int j = 0; j <= n[1]; ++j) {
        Span& to = spans_[c][static_cast<std::size_t>(k) * rows_ + static_cast<std::size_t>(j)];
        to = {n[0] + 1, 0};
        for (int z = k - 1; z <= k + 1; ++z)
          for (int y = j - 1; y <= j + 1; ++y)
            for (int i = -1; i <= n[0] + 1; ++i)
              if (area[c](i, y, z) != 0)
                to.from = std::min(to.from, i - 1), to.to = std::max(to.to, i + 2);
      }
  }
  /// Open share of a cut cell: the mean of areas of slices. At least a tenth, as room for
  /// particles.
  double open_share(const Grid& grid, const FlowBoundary& boundary, int i, int j, int k) const {
    if (area[0](i, j, k) == 1 && area[0](i + 1, j, k) == 1 && area[1](i, j, k) == 1 &&
        area[1](i, j + 1, k) == 1 && area[2](i, j, k) == 1 && area[2](i, j, k + 1) == 1)
      return 1;
    const Vec3d x = grid.centre(i, j, k), h = grid.h();
    double sum = 0;
    for (int slice = 0; slice < 4; ++slice)
      sum += integral_inside<pieces>(
          x.x, x.y, h.x, h.y,
          [&](double u, double v) {
            return boundary.distance({u, v, x.z + ((slice + 0.5) / 4 - 0.5) * h.z});
          },
          [](double, double) { return 1.0; });
    return std::clamp(sum / (4 * h.x * h.y), 0.1, 1.0);
  }
  /// For a cell with slivers only: the neighbour with the widest opening to it; otherwise any.
  void find_corners(const Grid& grid) {
    const auto& n = grid.cells();
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          if (cells(i, j, k) != 0) continue;
          double widest = -1;
          std::array<int, 3> from{};
          bool passed = false;
          for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
              for (int x = -1; x <= 1; ++x) {
                double way = 0;
                const int steps[3] = {x, y, z};
                for (std::size_t d = 0; d < 3 && std::abs(x) + std::abs(y) + std::abs(z) == 1; ++d)
                  if (steps[d] != 0)
                    way = area[d](i + std::max(x, 0), j + std::max(y, 0), k + std::max(z, 0));
                passed |= way > 0;
                std::array<int, 3> at{i + x, j + y, k + z};
                bool in = true;
                for (int d = 0; d < 3; ++d) {
                  const auto c = static_cast<std::size_t>(d);
                  if (grid.periodic(d)) at[c] = (at[c] + n[c]) % n[c];
                  in &= at[c] >= 0 && at[c] < n[c];
                }
                if (in && way > widest && cells(at[0], at[1], at[2]) != 0) widest = way, from = at;
              }
          if (passed && widest >= 0) corners_.push_back({std::array<int, 3>{i, j, k}, from});
        }
  }
  DynArray<std::array<std::array<int, 3>, 2>> corners_;
  std::array<DynArray<Span>, 3> spans_;
  std::size_t rows_ = 0;

  static double along(const Vec3d& v, int d) { return d == 0 ? v.x : d == 1 ? v.y : v.z; }
  /// Calls visit(i, j, k) for all values of a face field, including ghosts.
  template <class Visit>
  static void for_all(const Grid& grid, const Visit& visit) {
    constexpr int g = Grid::ghost;
    for (int k = -g; k < grid.nz() + g; ++k)
      for (int j = -g; j < grid.ny() + g; ++j)
        for (int i = -g; i < grid.nx() + g; ++i) visit(i, j, k);
  }
  /// Calls visit(to, e, way) for the neighbours of a value that are in the field.
  template <class Visit>
  static void for_neighbours(const Grid& grid, int i, int j, int k, const Visit& visit) {
    constexpr int g = Grid::ghost;
    for (int e = 0; e < 3; ++e)
      for (const int way : {-1, 1}) {
        std::array<int, 3> to{i, j, k};
        int& at = to[static_cast<std::size_t>(e)];
        at += way;
        if (at >= -g && at < grid.cells()[static_cast<std::size_t>(e)] + g) visit(to, e, way);
      }
  }
  /// Centre of a face of direction d, wrapped into the box if periodic.
  static Vec3d place(const Grid& grid, int d, int i, int j, int k) {
    const int at[3] = {i, j, k};
    double x[3];
    for (int e = 0; e < 3; ++e) {
      const int m = grid.cells()[static_cast<std::size_t>(e)];
      const int in = grid.periodic(e) ? (at[e] % m + m) % m : at[e];
      x[e] = (in + (e == d ? 0.0 : 0.5)) * along(grid.h(), e);
    }
    return grid.box().min + Vec3d{x[0], x[1], x[2]};
  }
  static Vec3d& move(Vec3d& x, int e, double by) {
    (e == 0 ? x.x : e == 1 ? x.y : x.z) += by;
    return x;
  }

  /// Distances of centres, and areas.
  void measure(const Grid& grid, const FlowBoundary& boundary, int d, CellField& distance) {
    const auto c = static_cast<std::size_t>(d);
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    const double ha = along(grid.h(), a), hb = along(grid.h(), b);
    for_all(grid, [&](int i, int j, int k) {
      const Vec3d x = place(grid, d, i, j, k);
      const double away = boundary.distance(x);
      require(!std::isnan(away), "FlowBoundary.distance is not a number at ", x, " m");
      distance(i, j, k) = away;
      double wet = away > 0 ? 1 : 0;
      if (std::abs(away) < 0.5 * std::hypot(ha, hb)) {
        const auto at = [&](double u, double v) {
          Vec3d y = x;
          return boundary.distance(move(move(y, a, u), b, v));
        };
        wet = integral_inside<pieces>(0, 0, ha, hb, at, [](double, double) { return 1.0; }) /
              (ha * hb);
        if (wet < least_area) wet = 0;
        if (wet > 1 - 1e-9) wet = 1;
      }
      area[c](i, j, k) = wet;
      inside[c](i, j, k) = away > 0 && wet > 0 ? 1 : 0;
      if (boundary.velocity && inside[c](i, j, k) == 0)
        velocity[c](i, j, k) = along(boundary.velocity(x), d);
    });
  }
  void find_slivers(const Grid& grid, const FlowBoundary& boundary, int d,
                    const CellField& distance) {
    const auto c = static_cast<std::size_t>(d);
    const int a = (d + 1) % 3, b = (d + 2) % 3;
    const double ha = along(grid.h(), a), hb = along(grid.h(), b);
    const auto& n = grid.cells();
    for_all(grid, [&](int i, int j, int k) {
      if (area[c](i, j, k) == 0 || inside[c](i, j, k) != 0) return;
      Sliver s{i, j, k, 0, 0, 0, 0, {0, 0, 0}};
      for_neighbours(grid, i, j, k, [&](const std::array<int, 3>& to, int e, int way) {
        const double there = distance(to[0], to[1], to[2]);
        if (inside[c](to[0], to[1], to[2]) == 0 || there <= s.there) return;
        s.there = there, s.e = e, s.way = way;
      });
      if (s.way == 0) {  // in a gap that the cells do not resolve
        area[c](i, j, k) = 0;
        return;
      }
      const int at[3] = {i, j, k};
      for (int e = 0; e < 3; ++e)
        if (at[e] < 0 || at[e] >= n[static_cast<std::size_t>(e)] + (e == d)) return;
      Vec3d x = place(grid, d, i, j, k);
      const auto by = [&](double u, double v) {
        Vec3d y = x;
        return move(move(y, a, u), b, v);
      };
      const auto away = [&](double u, double v) { return boundary.distance(by(u, v)); };
      const Vec3d sums = integral_inside<pieces>(0, 0, ha, hb, away, [](double u, double v) {
        return Vec3d{1, u, v};
      });
      x = by(sums.y / sums.x, sums.z / sums.x);
      s.here = std::clamp(boundary.distance(x), nearest * s.there, 0.9 * s.there);
      if (boundary.velocity) s.wall = boundary.velocity(x);
      slivers[c].push_back(s);
    });
  }
  /// Viscous coupling to walls.
  void find_links(const Grid& grid, const FlowBoundary& boundary, double viscosity, int d,
                  const CellField& distance) {
    const auto c = static_cast<std::size_t>(d);
    for_all(grid, [&](int i, int j, int k) {
      if (inside[c](i, j, k) == 0) return;
      for_neighbours(grid, i, j, k, [&](const std::array<int, 3>& to, int e, int way) {
        const auto f = static_cast<std::size_t>(e);
        // Outside the box the side applies.
        if (!grid.periodic(e) && (to[f] < 0 || to[f] >= grid.cells()[f] + (e == d))) return;
        if (inside[c](to[0], to[1], to[2]) != 0) return;
        const double here = distance(i, j, k), there = distance(to[0], to[1], to[2]);
        const double theta = std::clamp(here / (here - there), nearest, 1.0);
        const double h = along(grid.h(), e), link = viscosity / (h * h);
        Vec3d x = place(grid, d, i, j, k);  // on the surface
        move(x, e, way * theta * h);
        const double wall = boundary.velocity ? along(boundary.velocity(x), d) : 0;
        drag[c](i, j, k) += link * (1 / theta - 1);
        push[c](i, j, k) += link * (wall / theta - velocity[c](to[0], to[1], to[2]));
      });
    });
  }
  void find_thin(const Grid& grid, int d) {
    const auto c = static_cast<std::size_t>(d);
    const int o[3] = {d == 0, d == 1, d == 2};
    for (int k = 0; k < grid.nz() + o[2]; ++k)
      for (int j = 0; j < grid.ny() + o[1]; ++j)
        for (int i = 0; i < grid.nx() + o[0]; ++i) {
          double most = area[c](i, j, k);
          if (most == 0) continue;
          for (int e = 0; e < 3; ++e)
            for (const int end : {0, 1}) {
              const auto passed = [&](int f) {
                const int x = i + end * (e == 0) - f * o[0], y = j + end * (e == 1) - f * o[1],
                          z = k + end * (e == 2) - f * o[2];
                return area[static_cast<std::size_t>(e)](x, y, z);
              };
              most = std::max(most, 0.5 * (passed(0) + passed(1)));
            }
          thin[c](i, j, k) = 1 / most - 1;
        }
  }
  static constexpr std::size_t pieces = 4;  // per side length of a face, for its area
};

}  // namespace fluid_detail

}  // namespace silt
