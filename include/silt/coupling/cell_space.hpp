// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/averaging/averaged_form.hpp>
#include <silt/coupling/averaging/averaged_particles.hpp>
#include <silt/coupling/averaging/ball_points.hpp>
#include <silt/coupling/averaging/concept.hpp>
#include <silt/shape/rigid_pose.hpp>

namespace silt::inline SILT_TARGET {

/// Marks the absence of a cell.
inline constexpr std::size_t no_cell = std::numeric_limits<std::size_t>::max();

/// Cells of any mesh, numbered from 0: their number, volume, and the cell that contains a point.
///   std::size_t cells() const
///   double volume(std::size_t cell) const           [m3]
///   std::size_t locate(const Vec3d& x) const        no_cell outside the mesh; called by several
///                                                   threads at once
template <class M>
concept CellMesh = requires(const M& mesh, std::size_t cell, const Vec3d& x) {
  { mesh.cells() } -> std::convertible_to<std::size_t>;
  { mesh.volume(cell) } -> std::convertible_to<double>;
  { mesh.locate(x) } -> std::convertible_to<std::size_t>;
};

/// CellMesh with weights w_pc >= 0 of particles on its cells, sum_c w_pc = 1, or all 0 for a
/// particle outside it:
///   place(particles, team)              computes weights at the present positions
///   spread(of_particles, to_cells, team)        f_c = sum_p w_pc q_p
///   gather(of_cells, to_particles, team)        g_p = sum_c w_pc f_c, with the same weights
/// on flat spans with one double per particle or cell. As the two are adjoint, momentum is
/// conserved to rounding. Results are equal, bit for bit, for any number of threads.
/// PointWeights<Mesh> is a CellSpace of any CellMesh, GridSpace<Mode> of a Grid and an averaging
/// mode.
/// Tests:  tests/coupling/cell_space.cpp.
template <class S>
concept CellSpace = CellMesh<S> &&
    requires(S& space, const AveragedParticles& particles, std::span<const double> of,
             std::span<double> to, const Team& team) {
  space.place(particles, team);
  space.spread(of, to, team);
  space.gather(of, to, team);
};

/// Weights of particles on the cells of any mesh: interior points of a particle, with equal
/// weights, count in their cells. If the centre is in the mesh, points outside it count in the cell
/// of the centre. For cells larger than particles.
///
/// Errors: InputError for fewer than 1 or more than 1000 points, and for spans of wrong length.
/// Tests:  tests/coupling/cell_space.cpp.
template <CellMesh Mesh>
class PointWeights {
 public:
  explicit PointWeights(Mesh mesh, int points = 29) : mesh_(std::move(mesh)) {
    require(points >= 1 && points <= 1000, "PointWeights: points = ", points,
            " [-] must be in [1, 1000]");
    points_ = detail::ball_points(points);
  }
  const Mesh& mesh() const { return mesh_; }
  std::size_t cells() const { return mesh_.cells(); }
  double volume(std::size_t cell) const { return mesh_.volume(cell); }
  std::size_t locate(const Vec3d& x) const { return mesh_.locate(x); }

  void place(const AveragedParticles& of, const Team& team = {}) {
    shares_.resize(of.position.size());
    team.for_ranges(shares_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) place(of, p);
    });
  }
  void spread(std::span<const double> of, std::span<double> to, const Team& = {}) const {
    check("spread", of.size(), to.size());
    std::fill(to.begin(), to.end(), 0.0);
    for (std::size_t p = 0; p < of.size(); ++p)
      for (const Share& s : shares_[p]) to[s.cell] += s.weight * of[p];
  }
  void gather(std::span<const double> of, std::span<double> to, const Team& team = {}) const {
    check("gather", to.size(), of.size());
    team.for_ranges(to.size(), [&](std::size_t, std::size_t from, std::size_t end) {
      for (std::size_t p = from; p < end; ++p) {
        double sum = 0;
        for (const Share& s : shares_[p]) sum += s.weight * of[s.cell];
        to[p] = sum;
      }
    });
  }

 private:
  struct Share {
    std::size_t cell;
    double weight;  // [-]
  };
  void place(const AveragedParticles& of, std::size_t p) {
    auto& shares = shares_[p];
    shares.clear();
    const Vec3d& centre = of.position[p];
    const std::size_t home = mesh_.locate(centre);
    if (home == no_cell) return;
    const bool body = !of.forms.empty();
    const auto& points = body ? of.forms[of.form.empty() ? 0 : of.form[p]].points : points_;
    const RotationMatrix turn = rotation_matrix(body ? of.orientation[p] : Quaternion{});
    const double each = 1.0 / static_cast<double>(points.size());
    for (const Vec3d& x : points) {
      std::size_t cell = mesh_.locate(centre + of.radius[p] * (body ? turn * x : x));
      if (cell == no_cell) cell = home;
      const auto known = std::find_if(shares.begin(), shares.end(),
                                      [cell](const Share& s) { return s.cell == cell; });
      if (known != shares.end())
        known->weight += each;
      else
        shares.push_back({cell, each});
    }
  }
  void check(const char* what, std::size_t particles, std::size_t cells) const {
    require(particles == shares_.size() && cells == mesh_.cells(), "PointWeights::", what, ": ",
            particles, " values for ", shares_.size(), " particles and ", cells, " for ",
            mesh_.cells(), " cells; give one each, and place() the present particles first");
  }

  Mesh mesh_;
  DynArray<Vec3d> points_;  // in the unit ball
  DynArray<DynArray<Share>> shares_;
};

/// Cells of a Grid with the weights of an averaging mode, for flows with flat fields: cell (i, j,
/// k) has the number i + nx (j + ny k). CoupledFlow uses the mode directly, which saves copies.
/// `diameter` [m]: unit of the mode's widths, that of the largest particles.
template <AveragingMode Mode>
class GridSpace {
 public:
  GridSpace(const Mode& mode, const Grid& grid, double diameter)
      : grid_(grid), averaging_(mode, grid, diameter), field_(grid) {}
  std::size_t cells() const { return grid_.size(); }
  double volume(std::size_t) const { return grid_.cell_volume(); }
  std::size_t locate(const Vec3d& x) const {
    const Vec3d &low = grid_.box().min, &h = grid_.h();
    const double at[3] = {(x.x - low.x) / h.x, (x.y - low.y) / h.y, (x.z - low.z) / h.z};
    std::size_t place[3];
    for (int d = 0; d < 3; ++d) {
      const int n = grid_.cells()[static_cast<std::size_t>(d)];
      double s = at[d];
      if (grid_.periodic(d)) s -= n * std::floor(s / n);
      if (!(s >= 0 && s <= n)) return no_cell;
      place[d] = static_cast<std::size_t>(std::min(static_cast<int>(s), n - 1));
    }
    const auto nx = static_cast<std::size_t>(grid_.nx()), ny = static_cast<std::size_t>(grid_.ny());
    return place[0] + nx * (place[1] + ny * place[2]);
  }

  void place(const AveragedParticles& of, const Team& team = {}) { averaging_.place(of, team); }
  void spread(std::span<const double> of, std::span<double> to, const Team& team = {}) {
    check(to.size());
    CellField* const fields[] = {&field_};
    averaging_.spread(Quantities(&of, 1), fields, team);
    each_row([&](double* row, std::size_t from) {
      std::copy(row, row + grid_.nx(), to.begin() + static_cast<std::ptrdiff_t>(from));
    });
  }
  void gather(std::span<const double> of, std::span<double> to, const Team& team = {}) {
    check(of.size());
    each_row([&](double* row, std::size_t from) {
      std::copy_n(of.begin() + static_cast<std::ptrdiff_t>(from), grid_.nx(), row);
    });
    const CellField* const fields[] = {&field_};
    averaging_.gather(fields, GatheredValues(&to, 1), team);
  }

 private:
  template <class Use>
  void each_row(const Use& use) {
    std::size_t from = 0;
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j, from += static_cast<std::size_t>(grid_.nx()))
        use(field_.row(j, k), from);
  }
  void check(std::size_t cells) const {
    require(cells == grid_.size(), "GridSpace: ", cells, " values for ", grid_.size(),
            " cells; give one each");
  }

  Grid grid_;
  typename Mode::Averaging averaging_;
  CellField field_;
};

}  // namespace silt
