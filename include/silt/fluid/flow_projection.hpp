// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <silt/fluid/flow_state.hpp>
#include <silt/fluid/pressure_solver.hpp>

namespace silt::inline SILT_TARGET {

namespace fluid_detail {

/// After a step with (6): the void fraction consistent with the fluxes.
inline void count_flow(FlowState& state, double dt, const Team& team) {
  state.for_cells(team, [&](int j, int k) {
    const double* const share = state.solids ? state.solids->cells.row(j, k) : nullptr;
    const double* const before = state.older_eps.row(j, k);
    double* const counted = state.old_eps.row(j, k);
    for (int i = 0; i < state.grid.nx(); ++i)
      counted[i] = before[i] - dt / fluid_share(share, i) * state.divergence(state.flow, i, j, k);
  });
}

/// Pressure correction that makes the velocities of a step volume conserving: (5) of FlowSolver.
class FlowProjection {
 public:
  explicit FlowProjection(const Grid& grid)
      : solver_(grid),
        coefficient_{CellField(grid), CellField(grid), CellField(grid)},
        change_(grid),
        right_(grid),
        held_(grid) {}

  void run(FlowState& state, double dt, FlowStep& done, const Team& team) {
    state.old_flow = state.flow;
    state.superficial(state.next, state.flow, team);
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = state.stride(d);
      const double over = 1 / (state.h(d) * state.h(d));
      state.for_faces(d, team, [&](int j, int k, int from, int to) {
        const double *eps = state.eps.row(j, k), *w = state.weight[FlowState::at(d)].row(j, k);
        const CarriedRow carried(state, d, j, k);
        const double* const area =
            state.solids ? state.solids->area[FlowState::at(d)].row(j, k) : nullptr;
        double* const a = coefficient_[FlowState::at(d)].row(j, k);
        for_row(from, to, [&]<class Real>(int i) {
          const Real mean = Real(0.5) * (load_any<Real>(eps + i - s) + load_any<Real>(eps + i));
          Real through = Real(over) * mean * load_any<Real>(w + i);
          if (carried.any()) through += Real(over) * carried.response(i, load_any<Real>(w + i));
          if (area != nullptr) through = through * load_any<Real>(area + i);
          store_any(a + i, through);
        });
      });
    }
    hold_outlets(state);
    const bool moves = state.response && state.response->moves;
    if (moves) carry_particles(state, team);
    const double excess = state.over_planes(
        team,
        [&](int k) {
          double all = 0;
          for (int j = 0; j < state.grid.ny(); ++j) {
            const double *now = state.eps.row(j, k), *old = state.old_eps.row(j, k);
            const double* const share = state.solids ? state.solids->cells.row(j, k) : nullptr;
            double* const b = right_.row(j, k);
            for (int i = 0; i < state.grid.nx(); ++i) {
              const double fluid = share != nullptr ? share[i] : 1;
              b[i] = -(state.divergence(state.flow, i, j, k) + fluid * (now[i] - old[i]) / dt);
              if (moves) b[i] -= state.divergence(*carried_, i, j, k);
              all += b[i];
            }
          }
          return all;
        },
        FlowState::added);
    const double mean = excess * dt / static_cast<double>(state.grid.size());
    if (!state.sides.any_open() && std::abs(mean) > 1e-6)
      throw Error(detail::sentence(
          "FlowSolver: ", mean > 0 ? "more" : "less", " fluid enters than leaves, by ",
          std::abs(mean),
          " of the volume in a step, and no side is an Outflow; make one an "
          "Outflow, or balance the velocities of the sides and the particles added "
          "and removed. (Where a "
          "CoupledFlow clips solids at its least_voidage, the clipped volume counts "
          "as removed: use "
          "wider weights or larger cells)"));
    // Residuals below the rounding of the void fraction in this step are not resolved.
    const double norm = norm_of_right(state, team), least = rounding / dt / norm;
    if (!std::isfinite(norm)) throw_no_numbers(state);
    solver_.set(coefficient_[0], coefficient_[1], coefficient_[2], held_, team);
    change_.fill(0);
    PressureSolution solved;
    solved.converged = !(least < 1);
    if (least < 1)
      solved = solver_.solve(right_, change_,
                             {.relative = std::max(state.options.tolerance, least),
                              .most_iterations = state.options.most_iterations},
                             team);
    if (!solved.converged)
      throw Error(text("FlowSolver: the pressure of a step of ", dt,
                       " s cannot be found: ", solved.reason));
    done.iterations = solved.iterations, done.removed = solved.removed;
    done.unbalanced = (least < 1 ? solved.residual : 1) * norm * dt;
    state.sides.fill_pressure(change_, true);
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = state.stride(d);
      state.for_faces(d, team, [&](int j, int k, int from, int to) {
        const double *star = state.next[FlowState::at(d)].row(j, k),
                     *w = state.weight[FlowState::at(d)].row(j, k), *dp = change_.row(j, k);
        double* const u = state.velocity[FlowState::at(d)].row(j, k);
        for_row(from, to, [&]<class Real>(int i) {
          const Real slope =
              Real(1 / state.h(d)) * (load_any<Real>(dp + i) - load_any<Real>(dp + i - s));
          store_any(u + i, load_any<Real>(star + i) - load_any<Real>(w + i) * slope);
        });
      });
      state.fill_velocity(d, state.velocity[FlowState::at(d)]);
    }
    state.for_cells(team, [&](int j, int k) {
      double* const p = state.pressure.row(j, k);
      const double* const dp = change_.row(j, k);
      for (int i = 0; i < state.grid.nx(); ++i) p[i] += dp[i];
    });
    state.superficial(state.velocity, state.flow, team);
  }

 private:
  /// Reports which field of the step is not finite, and where.
  [[noreturn, gnu::cold]] static void throw_no_numbers(const FlowState& state) {
    const auto look = [&](const CellField& f, const char* what) {
      const Grid& g = state.grid;
      for (int k = 0; k < g.nz(); ++k)
        for (int j = 0; j < g.ny(); ++j)
          for (int i = 0; i < g.nx(); ++i)
            if (!(std::abs(f(i, j, k)) < too_large))
              throw Error(text("FlowSolver: ", what, " of cell (", i, ", ", j, ", ", k, ") is ",
                               f(i, j, k),
                               ", which gives no velocity for any step, however short; check "
                               "what sets it"));
    };
    for (const CellField& f : state.velocity) look(f, "the velocity");
    look(state.drag, "the drag K");
    for (const CellField& f : state.drag_v) look(f, "the drag's K v");
    for (const CellField& f : state.force) look(f, "the force");
    if (state.response) {
      look(state.response->borne, "the pressure on particles");
      look(state.response->with_fluid, "the particles' answer to velocity");
      look(state.response->with_pressure, "the particles' answer to pressure");
      for (const CellField& f : state.response->flux) look(f, "the particles' flux");
    }
    throw Error(
        "FlowSolver: the velocity is not finite for any step, however short; check the "
        "velocities of the sides and of walls");
  }
  static constexpr double too_large = 1e150;  // its square, over a cell's size, may overflow

  /// (6) of FlowSolver on a row of faces.
  struct CarriedRow {
    CarriedRow(const FlowState& state, int d, int j, int k) : back(state.stride(d)) {
      if (!state.response || !state.response->moves) return;
      const ParticleResponse& r = *state.response;
      A = r.with_fluid.row(j, k), B = r.with_pressure.row(j, k);
      S = r.flux[FlowState::at(d)].row(j, k);
    }
    bool any() const { return A != nullptr; }
    template <class Real>
    Real mean(const double* of, int i) const {
      return Real(0.5) * (load_any<Real>(of + i - back) + load_any<Real>(of + i));
    }
    template <class Real>
    Real response(int i, const Real& weight) const {
      return mean<Real>(A, i) * weight + mean<Real>(B, i);
    }
    std::ptrdiff_t back;
    const double *A = nullptr, *B = nullptr, *S = nullptr;
  };
  void carry_particles(const FlowState& state, const Team& team) {
    const Grid& g = state.grid;
    if (!carried_) carried_ = Three{CellField(g), CellField(g), CellField(g)};
    for (int d = 0; d < 3; ++d) {
      CellField& to = (*carried_)[FlowState::at(d)];
      to.fill(0);
      const std::ptrdiff_t s = state.stride(d);
      state.for_faces(d, team, [&](int j, int k, int from, int end) {
        const CarriedRow carried(state, d, j, k);
        const double *star = state.next[FlowState::at(d)].row(j, k), *p = state.pressure.row(j, k);
        const double* const area =
            state.solids ? state.solids->area[FlowState::at(d)].row(j, k) : nullptr;
        double* const out = to.row(j, k);
        for_row(from, end, [&]<class Real>(int i) {
          const Real slope =
              Real(1 / state.h(d)) * (load_any<Real>(p + i) - load_any<Real>(p + i - s));
          Real flux = carried.template mean<Real>(carried.S, i) +
                      carried.template mean<Real>(carried.A, i) * load_any<Real>(star + i) -
                      carried.template mean<Real>(carried.B, i) * slope;
          if (area != nullptr) flux = flux * load_any<Real>(area + i);
          store_any(out + i, flux);
        });
      });
      state.sides.fill_flux(d, to);
    }
  }

  static constexpr double rounding = 1e-14;  // [-] of the void fraction

  /// Root mean square [1/s].
  double norm_of_right(const FlowState& state, const Team& team) const {
    const double squares = state.over_planes(
        team,
        [&](int k) {
          double all = 0;
          for (int j = 0; j < state.grid.ny(); ++j) {
            const double* const b = right_.row(j, k);
            for (int i = 0; i < state.grid.nx(); ++i) all += b[i] * b[i];
          }
          return all;
        },
        FlowState::added);
    return std::sqrt(squares / static_cast<double>(state.grid.size()));
  }
  /// Outlets fix the pressure half a cell from the last centre.
  void hold_outlets(const FlowState& state) {
    held_.fill(0);
    const auto& n = state.grid.cells();
    for (int d = 0; d < 3; ++d)
      for (int end = 0; end < 2; ++end) {
        if (!state.sides.open(d, end)) continue;
        const int a = (d + 1) % 3, b = (d + 2) % 3;
        for (int y = 0; y < n[FlowState::at(b)]; ++y)
          for (int x = 0; x < n[FlowState::at(a)]; ++x) {
            int cell[3], face[3];
            cell[a] = face[a] = x, cell[b] = face[b] = y;
            cell[d] = end == 0 ? 0 : n[FlowState::at(d)] - 1,
            face[d] = end == 0 ? 0 : n[FlowState::at(d)];
            held_(cell[0], cell[1], cell[2]) +=
                2 * coefficient_[FlowState::at(d)](face[0], face[1], face[2]);
          }
      }
  }

  PressureSolver solver_;
  Three coefficient_;                // a eps e/D/h^2
  CellField change_, right_, held_;  // dp and its equation
  std::optional<Three> carried_;     // [m/s] the particles' volume, with the last pressure
};

}  // namespace fluid_detail

}  // namespace silt
