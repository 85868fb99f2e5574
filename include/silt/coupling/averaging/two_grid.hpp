// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/axis_transfer.hpp>
#include <silt/coupling/averaging/unresolved.hpp>

namespace silt::inline SILT_TARGET {

/// Two-grid averaging: particles distribute to the cells of a coarser grid, and these to the cells
/// of the flow. For cells that are not larger than particles.
///
/// The coarse grid has cells of at least `cell` diameters where those of the flow are smaller, in
/// each direction; otherwise the cells are the same.
///
///   Share     from a particle to coarse cells: Hat - linear between the eight centres around it,
///             also for bodies; Exact - the common volumes, for spheres.
///   Transfer  Linear or Constant in the coarse cells (axis_transfer.hpp); both conserve sums and
///             keep uniform fields uniform.
///
/// If cells are blocked, a coarse cell distributes only to its open ones: weights are the product
/// of share and transfer, normalised over the particle's open cells.
///
/// Source: H. Ma et al., Powder Technol. 412 (2022) 117972.
/// Errors: check(): InputError for a cell outside [1, 100]; place(): for bodies with Share::Exact.
/// Tests:  tests/coupling/averaging.cpp.
/// Valid:  cells that are not larger than particles.
/// Units:  lengths in diameters of the largest particles.
struct TwoGrid {
  enum class Share { Hat, Exact };
  enum class Transfer { Linear, Constant };
  double cell = 3;  // [diameters] of the coarse grid, at least
  Transfer transfer = Transfer::Linear;
  Share share = Share::Hat;

  void check() const {
    require(cell >= 1 && cell <= 100, "TwoGrid.cell = ", cell, " [diameters] must be in [1, 100]");
  }

  class Averaging;
};

namespace detail {

/// Linear between the centres of the eight cells around a particle.
class HatSource {
 public:
  HatSource(const Grid& grid, const AveragedParticles& particles) : of_(particles), frame_(grid) {}
  StencilKind ranges(std::size_t p, std::array<AxisRange, 3>& r) const {
    const auto s = frame_.at(of_.position[p]);
    if (!frame_.inside(s)) return StencilKind::None;
    for (std::size_t d = 0; d < 3; ++d) r[d] = frame_.hat(d, s[d]);
    return StencilKind::Dense;
  }
  void factor(std::size_t, int, const AxisRange&, double*) const {}
  void dense(std::size_t p, const std::array<AxisRange, 3>& r, double* raw) const {
    const auto s = frame_.at(of_.position[p]);
    double w[3][2];
    for (std::size_t d = 0; d < 3; ++d) {
      w[d][1] = std::clamp(s[d] - 0.5 - r[d].low, 0.0, 1.0);
      w[d][0] = 1 - w[d][1];
    }
    for (int n = 0; n < 8; ++n) raw[n] = w[0][n & 1] * w[1][n >> 1 & 1] * w[2][n >> 2];
  }

 private:
  const AveragedParticles& of_;
  CellFrame frame_;
};

/// Argument of Stencils::place for particles: hats, or the overlap volumes of spheres.
inline auto hat_shares(const Grid& grid) {
  return [&grid](const AveragedParticles& of) { return HatSource(grid, of); };
}
inline auto exact_shares(const Grid& grid) {
  return [&grid](const AveragedParticles& of) { return Unresolved::Source({}, grid, 1, of); };
}

/// Grid of the same box with cells of at least `size` where the cells are smaller.
inline Grid coarser_grid(const Grid& grid, double size) {
  std::array<int, 3> n = grid.cells();
  const Vec3d e = grid.box().extent();
  const double length[3] = {e.x, e.y, e.z};
  for (std::size_t d = 0; d < 3; ++d)
    n[d] = std::clamp(static_cast<int>(std::min(length[d] / size * (1 + 1e-12), 1e9)), 1, n[d]);
  return {grid.box(), n, {grid.periodic(0), grid.periodic(1), grid.periodic(2)}};
}

}  // namespace detail

class TwoGrid::Averaging {
 public:
  Averaging(const TwoGrid& mode, const Grid& grid, double diameter)
      : mode_((mode.check(), detail::check_diameter(diameter), mode)),
        grid_(grid),
        diameter_(diameter),
        stencils_(detail::coarser_grid(grid, mode.cell * diameter)) {
    for (std::size_t d = 0; d < 3; ++d)
      axes_.emplace_back(grid.cells()[d], coarse().cells()[d], grid.periodic(static_cast<int>(d)),
                         mode.transfer == Transfer::Linear);
  }
  const Grid& grid() const { return grid_; }
  const Grid& coarse() const { return stencils_.grid(); }
  const AveragingReport& report() const { return stencils_.report(); }

  void open(const CellField& cells, const Team& team = {}) {
    require(cells.grid() == grid_, "averaging: the field of open cells is not of its grid");
    open_.clear();
    CellField seen(coarse());
    const CellField* const from[]{&cells};
    CellField* const to[]{&seen};
    collect(from, to, team);
    const auto balance = [&](const auto& source_of) {
      balance_.assign(1, detail::Balance::open(stencils_, cells, seen, diameter_, source_of, team));
    };
    mode_.share == Share::Hat ? balance(detail::hat_shares(coarse()))
                              : balance(detail::exact_shares(coarse()));
    open_.assign(1, cells);
  }
  void place(const AveragedParticles& particles, const Team& team = {}) {
    detail::check_particles(particles, grid_);
    const std::size_t n = particles.position.size();
    if (mode_.share == Share::Hat)
      return stencils_.place(n, detail::hat_shares(coarse())(particles), team);
    require(particles.forms.empty(), "TwoGrid: Share::Exact is for spheres only; use Share::Hat");
    stencils_.place(n, detail::exact_shares(coarse())(particles), team);
  }
  void spread(Quantities q, CellFields f, const Team& team = {}) {
    detail::check_columns("spread", q, f, grid_, report().particles);
    const CellFields part = copies_.room_for(q.size(), &coarse());
    stencils_.spread(q, part, team);
    if (!open_.empty()) multiply_openness(balance_[0], part, team);
    distribute(part, f, team);
    if (!open_.empty()) multiply_openness(open_[0], f, team);
  }
  void gather(ConstCellFields f, GatheredValues g, const Team& team = {}) {
    detail::check_columns("gather", g, f, grid_, report().particles);
    const CellFields part = copies_.room_for(f.size(), &coarse());
    collect(f, part, team);
    if (!open_.empty()) multiply_openness(balance_[0], part, team);
    stencils_.gather({part.data(), part.size()}, g, team);
  }

 private:
  /// fine = T coarse.
  void distribute(CellFields from, CellFields to, const Team& team) const {
    team.for_parts(static_cast<std::size_t>(grid_.nz()), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      DynArray<double> row(static_cast<std::size_t>(coarse().nx()));
      for (std::size_t q = 0; q < from.size(); ++q)
        for (int j = 0; j < grid_.ny(); ++j) {
          std::fill(row.begin(), row.end(), 0.0);
          axes_[2].of_fine(k, [&](int ck, double wz) {
            axes_[1].of_fine(j, [&](int cj, double wy) {
              const double *values = from[q]->row(cj, ck), w = wz * wy;
              for (std::size_t c = 0; c < row.size(); ++c) row[c] += w * values[c];
            });
          });
          double* fine = to[q]->row(j, k);
          for (int i = 0; i < grid_.nx(); ++i) {
            double sum = 0;
            axes_[0].of_fine(i,
                             [&](int c, double w) { sum += w * row[static_cast<std::size_t>(c)]; });
            fine[i] = sum;
          }
        }
    });
  }
  /// coarse = T^t (openness fine): along x and y plane by plane, then along z.
  void collect(ConstCellFields from, CellFields to, const Team& team) {
    const auto nx = static_cast<std::size_t>(coarse().nx()),
               ny = static_cast<std::size_t>(coarse().ny());
    const std::size_t plane_size = nx * ny,
                      size = plane_size * static_cast<std::size_t>(grid_.nz());
    planes_.assign(size * from.size(), 0.0);
    team.for_parts(static_cast<std::size_t>(grid_.nz()), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      DynArray<double> row(nx);
      for (std::size_t q = 0; q < from.size(); ++q)
        for (int j = 0; j < grid_.ny(); ++j) {
          const double* fine = from[q]->row(j, k);
          const double* o = open_.empty() ? nullptr : open_[0].row(j, k);
          std::fill(row.begin(), row.end(), 0.0);
          for (int i = 0; i < grid_.nx(); ++i) {
            const double value = !o ? fine[i] : o[i] > 0 ? o[i] * fine[i] : 0.0;
            axes_[0].of_fine(
                i, [&](int c, double w) { row[static_cast<std::size_t>(c)] += w * value; });
          }
          double* sums = &planes_[q * size + plane * plane_size];
          axes_[1].of_fine(j, [&](int c, double w) {
            double* sum = sums + static_cast<std::size_t>(c) * nx;
            for (std::size_t i = 0; i < nx; ++i) sum[i] += w * row[i];
          });
        }
    });
    team.for_parts(static_cast<std::size_t>(coarse().nz()), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      for (std::size_t q = 0; q < from.size(); ++q)
        for (std::size_t j = 0; j < ny; ++j) {
          double* sum = to[q]->row(static_cast<int>(j), k);
          std::fill_n(sum, nx, 0.0);
          axes_[2].of_coarse(k, [&](int f, double w) {
            const double* values =
                &planes_[q * size + static_cast<std::size_t>(f) * plane_size + j * nx];
            for (std::size_t i = 0; i < nx; ++i) sum[i] += w * values[i];
          });
        }
    });
  }

  TwoGrid mode_;
  Grid grid_;
  double diameter_;
  Stencils stencils_;
  DynArray<AxisTransfer> axes_;
  DynArray<CellField> open_;     // none: all are
  DynArray<CellField> balance_;  // of coarse cells, where some are not open
  FieldCopies copies_;
  AlignedVector<double> planes_;
};

static_assert(AveragingMode<TwoGrid>);

}  // namespace silt
