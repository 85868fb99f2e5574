// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/components.hpp>
#include <silt/fluid/double_rows.hpp>
#include <silt/fluid/grid.hpp>
#include <silt/fluid/multigrid.hpp>
#include <silt/fluid/pressure_coefficients.hpp>

namespace silt::inline SILT_TARGET {

/// Stopping criterion of PressureSolver.
struct PressureTolerance {
  double relative = 1e-6;     // |b - A p| / |b| [-]
  int most_iterations = 200;  // [-]
};

/// Result of one solve. |v| is the root of the sum of squares over the cells.
struct PressureSolution {
  int iterations = 0;      // of conjugate gradients, one V-cycle each [-]
  double residual = 0;     // |b - A p| / |b|, b without the removed part, in double precision [-]
  double removed = 0;      // part removed from b to make it solvable, relative to |b| [-]
  bool converged = false;  // residual <= relative, or rounding of b compared with the removed part
  std::string reason;      // why not, one sentence; empty if converged
};

/// Solves A p = b on the cells of a Grid:
///
///   (A p)_c = sum over the six faces of a_f (p_c - p_neighbour) + d_c p_c                      (1)
///
/// with coefficients a_f >= 0 of the faces and d_c >= 0 of the cells (a Dirichlet value p_0 beyond
/// a face with the coefficient w: d_c += w, b_c += w p_0). Units are the caller's: a, d and b / p
/// have the same unit. Periodic directions wrap; their face n is face 0. Faces at the boundary of
/// other directions are closed for any a. Cells without open faces and with d = 0 are blocked: p =
/// 0. For a connected set of cells without d > 0, b minus its mean over the set is used, and the
/// mean of p over the set is 0.
///
/// Method: conjugate gradients preconditioned by a symmetric V-cycle of geometric multigrid (see
/// multigrid.hpp), both in float; p in double. The residual is recomputed in double whenever it has
/// dropped by 1e-4 and at the end ("reliable updates"); the result is as accurate as with double
/// throughout. Memory: about 65 bytes per cell (9 floats, 2 doubles, labels; coarser levels).
/// Source: O. Tatebe, The multigrid preconditioned conjugate gradient method, 6th Copper Mountain
///   Conf. on Multigrid Methods, NASA CP-3224, 1993, 621-634; G. L. G. Sleijpen, H. A. van der
///   Vorst, Reliable updated residuals in hybrid Bi-CG methods, Computing 56, 1996, 141-163,
///   doi:10.1007/BF02309342.
/// Valid:  contrasts of a to 1e4 and more, for any sizes. Rows of few cells (nx < 16) cost as much
///         as rows of 16: use a long direction as x.
/// Threads: results are equal, bit for bit, for every number of threads.
/// Errors: InputError for coefficients that are negative or not finite, and for other grids. A
///         failed solve is reported in the result.
/// Tests:  tests/fluid/pressure_solver.cpp; speed: benchmarks/fluid/bench_pressure.cpp.
class PressureSolver {
 public:
  PressureSolver(const PressureSolver&) = delete;
  explicit PressureSolver(const Grid& grid)
      : grid_(grid),
        multigrid_(grid.cells(), wraps(grid)),
        b_(grid),
        direction_(multigrid_.finest().values(), 7),
        product_(multigrid_.finest().values(), 8),
        correction_(multigrid_.finest().values(), 9),
        plane_sums_(static_cast<std::size_t>(grid.nz()), 0.0) {}

  const Grid& grid() const { return grid_; }
  const fluid_detail::Multigrid& multigrid() const { return multigrid_; }
  /// Number of connected sets of cells without d > 0.
  std::size_t floating_sets() const { return components_ ? components_->sizes.size() : 0; }

  /// Sets new coefficients: of the lower faces in each direction, and of the cells. solve() reads
  /// the four fields again: they must not change or be destroyed until then.
  void set(const CellField& ax, const CellField& ay, const CellField& az, const CellField& d,
           const Team& team) {
    is_set_ = false;
    for (const CellField* field : {&ax, &ay, &az, &d}) require_grid(*field, "coefficients");
    coefficients_.set({&ax, &ay, &az, &d}, multigrid_.finest(), team);
    multigrid_.coarsen(team);
    components_ = &coefficients_.components();
    is_set_ = true;
  }

  /// Solves for p, starting from the given p. Also sets ghosts of periodic directions.
  PressureSolution solve(const CellField& b, CellField& p, const PressureTolerance& until,
                         const Team& team) {
    require(is_set_, "PressureSolver: call set() with the coefficients before solve()");
    require_grid(b, "right side");
    require_grid(p, "solution");
    require(&b != &p, "PressureSolver: right side and solution are the same field; give two");
    require(until.relative > 0 && until.relative < 1,
            "PressureTolerance.relative = ", until.relative, " [-] must be in (0, 1)");
    require(until.most_iterations >= 0,
            "PressureTolerance.most_iterations = ", until.most_iterations,
            " [-] must not be negative");
    PressureSolution result;
    const double whole = take_right_side(b, team);
    const double norm = std::sqrt(sum_planes(team, [&](int k) { return b_squares(k); }));
    if (!std::isfinite(whole) || !std::isfinite(norm)) {
      result.residual = norm;
      result.reason = "the right-hand side has a value that is not finite";
      return result;
    }
    result.removed = whole > 0 ? removed_ / whole : 0;
    // If the right-hand side is uniform, the rest is rounding and is not resolved.
    const double rounding = 1e-14 * whole;
    if (norm <= rounding) {
      clear_cells(p, false);
      p.wrap_ghosts();
      result.converged = true;
      return result;
    }
    clear_cells(p, true);
    iterate(p, norm, std::max(until.relative * norm, rounding), until, team, result);
    remove_means(p, team);
    p.wrap_ghosts();
    return result;
  }

  /// z = M r: only the preconditioner, for tests. r of blocked cells counts as 0.
  void precondition(const CellField& r, CellField& z, const Team& team) {
    fluid_detail::Level& level = multigrid_.finest();
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j)
        for (int i = 0; i < grid_.nx(); ++i)
          if (const std::size_t at = level.index(i, j, k); true)
            level.r[at] = level.inverse[at] > 0 ? static_cast<float>(r(i, j, k)) : 0.0f;
    multigrid_.cycle(team);
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j)
        for (int i = 0; i < grid_.nx(); ++i)
          z(i, j, k) = static_cast<double>(level.x[level.index(i, j, k)]);
  }

 private:
  static std::array<bool, 3> wraps(const Grid& grid) {
    return {grid.periodic(0) && grid.nx() > 1, grid.periodic(1) && grid.ny() > 1,
            grid.periodic(2) && grid.nz() > 1};
  }
  void require_grid(const CellField& field, const char* what) const {
    require(field.grid() == grid_, "PressureSolver: the ", what,
            " are on another grid than the solver; create both with one Grid");
  }
  std::size_t cell_of_row(int j, int k) const {
    return static_cast<std::size_t>(grid_.nx()) *
           (static_cast<std::size_t>(j) +
            static_cast<std::size_t>(grid_.ny()) * static_cast<std::size_t>(k));
  }
  /// Calls of_plane(k) for every plane; returns the sum, always added in the same order.
  template <class OfPlane>
  double sum_planes(const Team& team, const OfPlane& of_plane) {
    team.for_parts(plane_sums_.size(),
                   [&](std::size_t k) { plane_sums_[k] = of_plane(static_cast<int>(k)); });
    return added_planes();
  }
  double added_planes() const {
    double sum = 0;
    for (const double part : plane_sums_) sum += part;
    return sum;
  }

  /// b minus its mean over every floating set, 0 in blocked cells; returns |b|.
  double take_right_side(const CellField& b, const Team& team) {
    const double squares = sum_planes(team, [&](int k) {
      double sum = 0;
      for (int j = 0; j < grid_.ny(); ++j) {
        const double* from = b.row(j, k);
        std::copy(from, from + grid_.nx(), b_.row(j, k));
        sum += fluid_detail::dot_row(grid_.nx(), from, from);
      }
      return sum;
    });
    removed_ = 0;
    if (!components_->sizes.empty() || components_->any_blocked) {
      remove_means(b_, team);
      removed_ = std::sqrt(sum_planes(team, [&](int k) {
        double sum = 0;
        for (int j = 0; j < grid_.ny(); ++j) {
          const double *whole = b.row(j, k), *left = b_.row(j, k);
          for (int i = 0; i < grid_.nx(); ++i) sum += (whole[i] - left[i]) * (whole[i] - left[i]);
        }
        return sum;
      }));
    }
    return std::sqrt(squares);
  }
  double b_squares(int k) const {
    double sum = 0;
    for (int j = 0; j < grid_.ny(); ++j)
      sum += fluid_detail::dot_row(grid_.nx(), b_.row(j, k), b_.row(j, k));
    return sum;
  }

  /// Subtracts the mean over every floating set, and sets blocked cells to 0.
  void remove_means(CellField& v, const Team& team) {
    const std::size_t sets = components_->sizes.size();
    if (sets == 0 && !components_->any_blocked) return;
    set_sums_.assign(sets * plane_sums_.size(), 0.0);
    const auto for_cells = [&](const auto& what) {
      team.for_parts(plane_sums_.size(), [&](std::size_t k) {
        for (int j = 0; j < grid_.ny(); ++j) {
          double* values = v.row(j, static_cast<int>(k));
          const std::int32_t* set =
              components_->of_cell.data() + cell_of_row(j, static_cast<int>(k));
          for (int i = 0; i < grid_.nx(); ++i) what(k * sets, set[i], values[i]);
        }
      });
    };
    for_cells([&](std::size_t first, std::int32_t set, double& value) {
      if (set >= 0) set_sums_[first + static_cast<std::size_t>(set)] += value;
    });
    DynArray<double> means(sets, 0.0);
    for (std::size_t k = 0; k < plane_sums_.size(); ++k)
      for (std::size_t s = 0; s < sets; ++s) means[s] += set_sums_[k * sets + s];
    for (std::size_t s = 0; s < sets; ++s) means[s] /= static_cast<double>(components_->sizes[s]);
    for_cells([&](std::size_t, std::int32_t set, double& value) {
      if (set >= 0) value -= means[static_cast<std::size_t>(set)];
      if (set == fluid_detail::Components::blocked) value = 0;
    });
  }

  /// Sets p to zero, in blocked cells only or everywhere.
  void clear_cells(CellField& p, bool only_blocked) const {
    if (only_blocked && !components_->any_blocked) return;
    for (int k = 0; k < grid_.nz(); ++k)
      for (int j = 0; j < grid_.ny(); ++j) {
        const std::int32_t* set = components_->of_cell.data() + cell_of_row(j, k);
        double* values = p.row(j, k);
        for (int i = 0; i < grid_.nx(); ++i)
          if (!only_blocked || set[i] == fluid_detail::Components::blocked) values[i] = 0;
      }
  }

  /// Conjugate gradients from p to a residual of `target`. `scale` of the residual in float: r =
  /// scale (b - A p).
  void iterate(CellField& p, double norm, double target, const PressureTolerance& until,
               const Team& team, PressureSolution& result) {
    constexpr double drop = 1e-4;  // of the residual between two computed in double
    const double cells = std::sqrt(static_cast<double>(grid_.size()));
    double scale = cells / norm, residual = 0;
    const auto stopped = [&](const char* why) { result.reason = why; };
    double next_check = 0, rz = 0, alpha = 0;
    bool along = false;   // direction_ holds a direction
    bool behind = false;  // p does not include direction_ and correction_ yet
    const auto renew = [&] {
      residual = true_residual(p, scale, team);
      if (std::isnormal(residual) && std::abs(std::log10(residual * scale / cells)) > 6) {
        scale = cells / residual;  // floats would leave their range: restart
        along = false;
        residual = true_residual(p, scale, team);
      }
      next_check = std::max(target, drop * residual);
    };
    renew();
    while (residual > target) {
      if (result.iterations == until.most_iterations) {
        stopped("the residual is not small enough after most_iterations");
        break;
      }
      const double before = rz;
      rz = multigrid_.cycle(team);
      if (!(rz > 0 && std::isfinite(rz))) {
        stopped("the preconditioned residual is not a number or not positive");
        break;
      }
      if (!along) direction_.clear();
      const double pq = advance(along ? rz / before : 0, along ? alpha : 0, team);
      behind = true;
      if (!(pq > 0 && std::isfinite(pq))) {
        alpha = 0;
        stopped(
            "the coefficients give a direction without resistance, or a value that is not a "
            "number");
        break;
      }
      along = true;
      const double step = rz / pq;
      alpha = step * coefficients_.scale() / scale;
      ++result.iterations;
      residual = std::sqrt(subtract(static_cast<float>(step), team)) / scale;
      if (!(residual > next_check)) {  // or no number
        flush(p, alpha, team);
        alpha = 0;
        behind = false;
        renew();
      }
    }
    if (behind) {
      flush(p, alpha, team);
      residual = true_residual(p, scale, team);
    }
    result.residual = residual / norm;
    result.converged = residual <= target;
    if (result.converged)
      result.reason.clear();
    else
      forget();
    if (!std::isfinite(residual))
      stopped(
          "the initial solution has a value that is not finite, or the "
          "numbers left the range of double");
  }

  /// NaN must not outlive the solve that made them.
  void forget() {
    multigrid_.forget();
    direction_.clear();
    product_.clear();
    correction_.clear();
  }

  /// r of the finest level = scale (b - A p); returns |b - A p|.
  double true_residual(const CellField& p, double scale, const Team& team) {
    return std::sqrt(sum_planes(team, [&](int k) {
      return coefficients_.residual_plane(k, b_, p, scale, multigrid_.finest());
    }));
  }

  /// correction += alpha direction, direction = z + beta direction, product = A direction; returns
  /// direction . product.
  double advance(double beta, double alpha, const Team& team) {
    fluid_detail::Level& level = multigrid_.finest();
    const int n = grid_.nx();
    const float* search = direction_.data();
    std::fill(plane_sums_.begin(), plane_sums_.end(), 0.0);
    const PlaneSweeps order{grid_.nz(),     grid_.ny(),    2, 8 * sizeof(float) * level.stride,
                            level.wraps[2], level.wraps[1]};
    sweep_planes(team, order, [&](int stage, int k, int from, int to) {
      for (int j = from; j < to; ++j) {
        const std::size_t at = level.begin(j, k);
        if (stage == 0) {
          float* row = direction_.data() + at;
          if (alpha != 0)
            fluid_detail::add_scaled_row(level.stride, alpha, row, correction_.data() + at);
          fluid_detail::direction_row(level.stride, static_cast<float>(beta), level.x.data() + at,
                                      row);
          level.wrap_row(row);
        } else {
          plane_sums_[static_cast<std::size_t>(k)] +=
              fluid_detail::apply_row(n, level.half, level.faces(j, k),
                                      level.neighbours(search, j, k), product_.data() + at);
        }
      }
    });
    return added_planes();
  }
  /// r -= step product; returns r . r.
  double subtract(float step, const Team& team) {
    fluid_detail::Level& level = multigrid_.finest();
    return sum_planes(team, [&](int k) {
      double sum = 0;
      for (int j = 0; j < grid_.ny(); ++j) {
        const std::size_t at = level.begin(j, k);
        sum += fluid_detail::subtract_row(level.stride, step, product_.data() + at,
                                          level.r.data() + at);
      }
      return sum;
    });
  }
  /// p += correction + alpha direction; correction = 0.
  void flush(CellField& p, double alpha, const Team& team) {
    const fluid_detail::Level& level = multigrid_.finest();
    team.for_parts(plane_sums_.size(), [&](std::size_t plane) {
      const int k = static_cast<int>(plane);
      for (int j = 0; j < grid_.ny(); ++j) {
        const std::size_t at = level.begin(j, k);
        double *values = p.row(j, k), *even = correction_.data() + at, *odd = even + level.half;
        if (alpha != 0)
          fluid_detail::add_scaled_row(level.stride, alpha, direction_.data() + at, even);
        for (int m = 0; m < grid_.nx() / 2; ++m) {
          values[2 * m] += even[m];
          values[2 * m + 1] += odd[m];
        }
        if (grid_.nx() % 2 == 1) values[grid_.nx() - 1] += even[grid_.nx() / 2];
        std::fill(even, even + level.stride, 0.0);
      }
    });
  }

  Grid grid_;
  fluid_detail::Multigrid multigrid_;
  fluid_detail::PressureCoefficients coefficients_;
  const fluid_detail::Components* components_ = nullptr;
  CellField b_;
  fluid_detail::LevelArray<float> direction_, product_;  // of conjugate gradients
  fluid_detail::LevelArray<double> correction_;  // of p since the residual was computed in double
  DynArray<double> plane_sums_, set_sums_;
  double removed_ = 0;  // |.| of the removed part of the right-hand side
  bool is_set_ = false;
};

}  // namespace silt
