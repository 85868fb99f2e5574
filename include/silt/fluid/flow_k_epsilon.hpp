// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <silt/fluid/flow_state.hpp>

/// Time step of k and epsilon: (1) and (2) of KEpsilon.
namespace silt::inline SILT_TARGET::fluid_detail {

/// Scratch fields of the flow that are unused after its projection, and are reused for k and
/// epsilon.
struct CarriedTurbulence {
  explicit CarriedTurbulence(FlowState& state)
      : left(state.tendency[0]), k(state.tendency[1]), epsilon(state.tendency[2]) {}
  CellField& left;  // [-] part of a cell's content that does not flow out in the step
  CellField &k, &epsilon;
};

/// Flux through the lower face of direction d of the cell at `i`, in units of q over m. `s`: to the
/// next cell; `open`: whether faces are open, null: all.
inline double carried_through(const double* q, const double* left, const double* open, double flow,
                              std::ptrdiff_t i, std::ptrdiff_t s) {
  const bool up = flow > 0;
  const std::ptrdiff_t from = up ? i - s : i, to = up ? i : i - s, back = 2 * from - to;
  double rise = 0;
  if (open == nullptr || open[up ? from : back] != 0) rise = q[from] - q[back];
  const double on = q[to] - q[from];
  const double slope = rise * on > 0 ? (std::abs(rise) < std::abs(on) ? rise : on) : 0;  // minmod
  return flow * (q[from] + 0.5 * left[from] * slope);
}

/// to = (m q - dt div(F q)) / m' for k and epsilon. If a cell contains q and loses the share C of
/// it in the step, its faces carry at most q (1 + (1 - C)/2), which keeps values positive. In a
/// cell cut by a wall fluxes act on its fluid part, see FlowSolids.
inline void advect_turbulence(FlowState& state, double dt, CarriedTurbulence& to,
                              const Team& team) {
  const TwoEquations& two = *state.turbulence->two;
  const std::ptrdiff_t s[3] = {state.stride(0), state.stride(1), state.stride(2)};
  const double over[3] = {dt / state.h(0), dt / state.h(1), dt / state.h(2)};
  const auto fluxes = [&](int d, int j, int k) {
    return state.carried[FlowState::at(d)].row(j, k);
  };
  state.for_cells(team, [&](int j, int k) {
    const double *const F[3] = {fluxes(0, j, k), fluxes(1, j, k), fluxes(2, j, k)},
                        *const m = state.mass.row(j, k);
    double* const left = to.left.row(j, k);
    const double* const share = state.solids ? state.solids->share.row(j, k) : nullptr;
    for (int i = 0; i < state.grid.nx(); ++i) {
      double out = 0;
      for (int d = 0; d < 3; ++d)
        out += over[d] * (std::max(0.0, F[d][i + s[d]]) + std::max(0.0, -F[d][i]));
      left[i] = std::max(0.0, 1 - out / (share != nullptr ? m[i] * share[i] : m[i]));
    }
  });
  state.sides.fill_cells(to.left);
  state.for_cells(team, [&](int j, int k) {
    const double *const F[3] = {fluxes(0, j, k), fluxes(1, j, k), fluxes(2, j, k)},
                        *const m = state.mass.row(j, k), *const next = state.next_mass.row(j, k),
                        *const left = to.left.row(j, k), *const kind = two.kind.row(j, k);
    const double* open[3] = {nullptr, nullptr, nullptr};
    for (int d = 0; d < 3 && state.solids; ++d)
      open[d] = state.solids->area[FlowState::at(d)].row(j, k);
    const double* const share = state.solids ? state.solids->share.row(j, k) : nullptr;
    for (const bool energy : {true, false}) {
      const double* const q = (energy ? two.k : two.epsilon).row(j, k);
      double* const out = (energy ? to.k : to.epsilon).row(j, k);
      for (int i = 0; i < state.grid.nx(); ++i) {
        if (kind[i] == TwoEquations::closed || (!energy && kind[i] == TwoEquations::beside_wall)) {
          out[i] = q[i];
          continue;
        }
        double sum = 0, net = 0;
        for (int d = 0; d < 3; ++d) {
          sum += over[d] * (carried_through(q, left, open[d], F[d][i + s[d]], i + s[d], s[d]) -
                            carried_through(q, left, open[d], F[d][i], i, s[d]));
          net += over[d] * (F[d][i + s[d]] - F[d][i]);
        }
        if (share != nullptr) sum = (sum - net * q[i]) / share[i] + (m[i] - next[i]) * q[i];
        out[i] = std::max(TwoEquations::least, (m[i] * q[i] - sum) / next[i]);
      }
    }
  });
}

/// Diffusion between cells with their centres in the fluid, and sources.
inline void make_turbulence(FlowState& state, double dt, const CarriedTurbulence& from,
                            const Team& team) {
  FlowTurbulence& eddies = *state.turbulence;
  TwoEquations& two = *eddies.two;
  const KEpsilon& model = two.model;
  const std::ptrdiff_t s[3] = {state.stride(0), state.stride(1), state.stride(2)};
  double over[3];
  for (int d = 0; d < 3; ++d) over[d] = dt / (state.h(d) * state.h(d));
  const double nu = state.fluid.viscosity / state.fluid.density;
  const double half = 0.5 / state.fluid.density;
  state.for_cells(team, [&](int j, int k) {
    const double *const m = state.next_mass.row(j, k), *const mu = eddies.eddy.row(j, k),
                        *const kind = two.kind.row(j, k), *const k1 = from.k.row(j, k),
                        *const e1 = from.epsilon.row(j, k), *const made = two.made.row(j, k);
    const double* open[3] = {nullptr, nullptr, nullptr};
    for (int d = 0; d < 3 && state.solids; ++d)
      open[d] = state.solids->inside[FlowState::at(d)].row(j, k);
    double *const energy = two.k.row(j, k), *const epsilon = two.epsilon.row(j, k);
    for (int i = 0; i < state.grid.nx(); ++i) {
      if (kind[i] <= TwoEquations::passed) {
        energy[i] = k1[i], epsilon[i] = e1[i];
        continue;
      }
      double dk = 0, de = 0;
      for (int d = 0; d < 3; ++d)
        for (const int way : {-1, 1}) {
          const std::ptrdiff_t to = i + way * s[d];
          if (kind[to] <= TwoEquations::passed) continue;
          if (open[d] != nullptr && open[d][way > 0 ? to : i] == 0) continue;
          // The smaller share of the two cells: steps that are stable for eps = 1 are then always
          // stable.
          const double nu_t = half * (mu[i] + mu[to]),
                       link = over[d] * std::min(m[i], m[to]) / m[i];
          dk += link * (nu + nu_t / model.sigma_k) * (k1[to] - k1[i]);
          de += link * (nu + nu_t / model.sigma_epsilon) * (e1[to] - e1[i]);
        }
      const double k2 = std::max(TwoEquations::least, k1[i] + dk),
                   e2 = std::max(TwoEquations::least, e1[i] + de), rate = dt * e2 / k2;
      energy[i] = std::max(TwoEquations::least, (k2 + dt * made[i]) / (1 + rate));
      if (kind[i] == TwoEquations::beside_wall) continue;  // set by the flow
      epsilon[i] = std::max(TwoEquations::least,
                            e2 * (1 + dt * model.C1 * made[i] / k2) / (1 + model.C2 * rate));
    }
  });
}

inline void carry_turbulence(FlowState& state, double dt, const Team& team) {
  if (!state.turbulence || !state.turbulence->two) return;
  TwoEquations& two = *state.turbulence->two;
  const auto inflow = [&](int e, int end) {
    return two.inflow[FlowState::at(e)][FlowState::at(end)];
  };
  state.sides.fill_carried(two.k, inflow);
  state.sides.fill_carried(two.epsilon, [&](int e, int end) {
    return std::max(TwoEquations::least,
                    two.model.dissipation(inflow(e, end), two.model.inflow_length()));
  });
  CarriedTurbulence carried(state);
  advect_turbulence(state, dt, carried, team);
  state.sides.fill_cells(carried.k), state.sides.fill_cells(carried.epsilon);
  make_turbulence(state, dt, carried, team);
}

}  // namespace silt::fluid_detail
