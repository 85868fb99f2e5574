// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/fluid/flow_state.hpp>

/// Parts of a step before the pressure: see FlowSolver.
namespace silt::inline SILT_TARGET::fluid_detail {

inline void refuse_unstable(const FlowState& state, double dt, double courant) {
  if (courant > 1)
    throw FlowStepError(
        text("FlowSolver: the flow crosses ", detail::sentence(courant), " cells in a step of ",
             detail::sentence(dt), " s; it must be at most 1: use a step of at most ",
             detail::sentence(dt / courant), " s"),
        dt / courant);
  const Vec3d size = state.grid.h();
  const double squares = 1 / (size.x * size.x) + 1 / (size.y * size.y) + 1 / (size.z * size.z);
  const double spread = state.fluid.viscosity / state.fluid.density * dt * squares +
                        (state.turbulence ? dt * state.eddy_rate() : 0);
  if (spread > 0.45)
    throw FlowStepError(
        text("FlowSolver: viscosity spreads over mu dt / rho (1/hx^2 + "
             "1/hy^2 + 1/hz^2) = ",
             detail::sentence(spread), " of a cell in a step of ", detail::sentence(dt),
             " s; it must be at most 0.45: use a step of at most ",
             detail::sentence(0.45 * dt / spread), " s"),
        0.45 * dt / spread);
}

/// Fluxes at the middle of the step, and the fluid that they carry.
inline void carry(FlowState& state, double dt, const Team& team) {
  // Extrapolates by at most the length of the last step, if that was short.
  const double ahead = state.old_dt > 0 ? std::min(0.5 * dt / state.old_dt, 1.0) : 0;
  for (int d = 0; d < 3; ++d) {
    const int more[3] = {d == 0, d == 1, d == 2};
    team.for_parts(FlowState::at(state.grid.nz() + more[2]), [&](std::size_t part) {
      for (int j = 0; j < state.grid.ny() + more[1]; ++j) {
        const int k = static_cast<int>(part);
        const double *now = state.flow[FlowState::at(d)].row(j, k),
                     *old = state.old_flow[FlowState::at(d)].row(j, k);
        double* out = state.carried[FlowState::at(d)].row(j, k);
        for_row(0, state.grid.nx() + more[0], [&]<class Real>(int i) {
          const Real f = load_any<Real>(now + i);
          store_any(out + i, f + Real(ahead) * (f - load_any<Real>(old + i)));
        });
      }
    });
    state.sides.fill_flux(d, state.carried[FlowState::at(d)]);
  }
  const double lacking = state.over_planes(
      team,
      [&](int k) {
        double most = 0;
        for (int j = 0; j < state.grid.ny(); ++j) {
          const double *m = state.mass.row(j, k), *e = state.eps.row(j, k);
          const double* const share = state.solids ? state.solids->cells.row(j, k) : nullptr;
          double* const out = state.next_mass.row(j, k);
          for (int i = 0; i < state.grid.nx(); ++i) {
            out[i] = m[i] - dt / fluid_share(share, i) * state.divergence(state.carried, i, j, k);
            most = FlowState::larger(most, 0.5 * e[i] - out[i]);
          }
        }
        return most;
      },
      FlowState::larger);
  if (lacking > 0) {  // eps jumps: follow it one step later, without extrapolation
    state.carried = state.flow, state.mass = state.older_eps, state.next_mass = state.old_eps;
    // What the last step carried, in a step of another length: m' = m - dt div F holds for both.
    if (const double as_much = state.old_dt / dt; as_much > 0 && as_much != 1)
      for (CellField& flow : state.carried)
        for (double& f : flow.values()) f *= as_much;
  }
  state.sides.fill_cells(state.mass), state.sides.fill_cells(state.next_mass);
}
/// Whether the fluxes have jumped in this step by more than a third of their value, as after a
/// change of sides or at a start from rest.
inline bool has_jumped(const FlowState& state, const Team& team) {
  double changes = 0, squares = 0;
  for (int d = 0; d < 3; ++d) {
    const CellField &now = state.flow[FlowState::at(d)], &old = state.old_flow[FlowState::at(d)];
    const auto sum = [&](const auto& of) {
      return state.over_planes(
          team,
          [&](int k) {
            double all = 0;
            for (int j = 0; j < state.grid.ny(); ++j)
              for (int i = 0; i < state.grid.nx(); ++i) all += of(i, j, k) * of(i, j, k);
            return all;
          },
          FlowState::added);
    };
    changes += sum([&](int i, int j, int k) { return now(i, j, k) - old(i, j, k); });
    squares += sum([&](int i, int j, int k) { return now(i, j, k); });
  }
  return changes > squares / 9;
}
inline void find_spread(FlowState& state, const Team& team) {
  state.for_cells(team, [&](int j, int k) {
    double* const out = state.spread.row(j, k);
    for (int i = 0; i < state.grid.nx(); ++i)
      out[i] = state.beside_solids(i, j, k) ? 0 : state.divergence(state.velocity, i, j, k);
  });
  state.sides.fill_cells(state.spread);
}

/// Forcing of the velocities of slivers of direction d: see Sliver.
inline void lead_slivers(FlowState& state, const Three& q, int d, const Team& team) {
  const std::size_t c = FlowState::at(d);
  FlowSolids& solids = *state.solids;
  const DynArray<Sliver>& slivers = solids.slivers[c];
  const double mu = state.fluid.viscosity;
  constexpr std::size_t part = 64;
  team.for_parts((slivers.size() + part - 1) / part, [&](std::size_t n) {
    for (std::size_t l = n * part; l < std::min(slivers.size(), (n + 1) * part); ++l) {
      const Sliver& s = slivers[l];
      int p[3] = {s.i, s.j, s.k};
      p[s.e] += s.way;
      const double wall = d == 0   ? s.wall.x
                          : d == 1 ? s.wall.y
                                   : s.wall.z,
                   next = q[c](p[0], p[1], p[2]) - wall, h = state.h(s.e), r = s.here / s.there;
      double link = mu / (s.here * h * (1 - r)), to = r * next;
      if (state.turbulence) {
        const double u = q[c](s.i, s.j, s.k) - wall;
        to = std::clamp(u, std::min(to, next), std::max(to, next));
        const double speed = norm(velocity_at(q, d, p[0], p[1], p[2]) - s.wall);
        link = u == to ? 0 : link + state.fluid.density * speed / h;
      }
      solids.drag[c](s.i, s.j, s.k) = link;
      solids.push[c](s.i, s.j, s.k) = link * (wall + to);
    }
  });
}

/// One stage: `out` is u* of (4) with the tendency of q, or, in the second stage, with the mean of
/// both tendencies.
inline void stage(FlowState& state, const Three& q, bool second, double dt, Three& out,
                  const Team& team) {
  for (int d = 0; d < 3; ++d) {
    const std::size_t c = FlowState::at(d);
    if (state.solids) lead_slivers(state, q, d, team);
    state.for_faces(d, team, [&](int j, int k, int from, int to) {
      const auto row = [&](const CellField& f) { return f.row(j, k); };
      const bool walled = state.solids.has_value();
      const auto of_solids = [&](const auto& field) {
        return walled ? field(*state.solids)[c].row(j, k) : nullptr;
      };
      const FlowTurbulence* const eddies = state.turbulence ? &*state.turbulence : nullptr;
      const bool bears = state.response && state.response->bears;
      const auto all = [&](int e) { return row(q[FlowState::at(e)]); };
      const auto reached = [&](int e) {
        return eddies ? row(eddies->open[FlowState::at(e)]) : nullptr;
      };
      const auto edges = [&](int e) {
        return eddies ? row(eddies->edges[c][FlowState::at(e)]) : nullptr;
      };
      const StageRow r{row(q[c]),
                       {row(state.carried[0]), row(state.carried[1]), row(state.carried[2])},
                       row(state.spread),
                       {state.stride(0), state.stride(1), state.stride(2)},
                       state.stride(d),
                       row(state.carried[c]),
                       {1 / state.h(0), 1 / state.h(1), 1 / state.h(2)},
                       1 / state.h(d),
                       state.fluid.density,
                       state.fluid.viscosity,
                       state.fluid.density / dt,
                       state.options.model == MomentumModel::A,
                       second,
                       row(state.velocity[c]),
                       row(state.eps),
                       row(state.mass),
                       row(state.next_mass),
                       row(state.drag),
                       row(state.drag_v[c]),
                       row(state.pushes(d)),
                       row(state.pressure),
                       bears ? row(state.response->borne) : nullptr,
                       of_solids([](const FlowSolids& s) -> const Three& { return s.area; }),
                       of_solids([](const FlowSolids& s) -> const Three& { return s.inside; }),
                       of_solids([](const FlowSolids& s) -> const Three& { return s.thin; }),
                       of_solids([](const FlowSolids& s) -> const Three& { return s.drag; }),
                       of_solids([](const FlowSolids& s) -> const Three& { return s.push; }),
                       of_solids([](const FlowSolids& s) -> const Three& { return s.velocity; }),
                       eddies ? row(eddies->eddy) : nullptr,
                       {all(0), all(1), all(2)},
                       {reached(0), reached(1), reached(2)},
                       {edges(0), edges(1), edges(2)},
                       eddies ? row(eddies->drag[c]) : nullptr,
                       eddies ? row(eddies->push[c]) : nullptr,
                       out[c].row(j, k),
                       state.tendency[c].row(j, k),
                       state.weight[c].row(j, k),
                       state.stress.empty() ? nullptr : state.stress[c].row(j, k)};
      const auto enter = [&, first = from, end = to] {
        for (const int side : {0, 1}) {
          const int edge = side == 0 ? 0 : state.grid.cells()[c];
          if (!state.sides.open(d, side) || (d == 1 && j != edge) || (d == 2 && k != edge))
            continue;
          for (int i = d == 0 ? edge : first; i < (d == 0 ? edge + 1 : end); ++i)
            eddies   ? walled ? enter_at_rest<true, true>(r, i, 1 - 2 * side)
                              : enter_at_rest<false, true>(r, i, 1 - 2 * side)
              : walled ? enter_at_rest<true, false>(r, i, 1 - 2 * side)
                     : enter_at_rest<false, false>(r, i, 1 - 2 * side);
        }
      };
      if (walled) {  // most of a box around a pipe is solid
        const auto open = state.solids->span(d, j, k);
        const int all_to = to;
        constexpr int width = static_cast<int>(Lanes<DefaultArch>::width);
        const auto packs = [&](int i) { return from + (std::max(0, i - from) / width) * width; };
        const int first = std::min(packs(open.from), to),
                  end = std::max(first, std::min(packs(open.to + width - 1), to));
        leave_closed(r, from, first), leave_closed(r, end, all_to);
        from = first, to = end;
      }
      if (eddies)
        walled ? stage_row<true, true>(r, from, to) : stage_row<false, true>(r, from, to);
      else
        walled ? stage_row<true, false>(r, from, to) : stage_row<false, false>(r, from, to);
      enter();
    });
    state.fill_velocity(d, out[c]);
  }
}

}  // namespace silt::fluid_detail
