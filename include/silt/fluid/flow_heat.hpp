// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/fluid/flow_k_epsilon.hpp>
#include <silt/fluid/flow_state.hpp>

/// Time step of the temperature: (1) and (2) of FluidHeat.
namespace silt::inline SILT_TARGET::fluid_detail {

/// Calls visit(i, j, k, position) for the cells at a side; position [m]: the centre of the cell's
/// face on it.
template <class Visit>
void for_side_cells(const Grid& grid, int d, int end, const Visit& visit) {
  const auto& n = grid.cells();
  int from[3] = {0, 0, 0}, to[3] = {n[0], n[1], n[2]};
  from[d] = end == 0 ? 0 : n[FlowState::at(d)] - 1, to[d] = from[d] + 1;
  const Vec3d edge = end == 0 ? grid.box().min : grid.box().max;
  for (int k = from[2]; k < to[2]; ++k)
    for (int j = from[1]; j < to[1]; ++j)
      for (int i = from[0]; i < to[0]; ++i) {
        Vec3d x = grid.centre(i, j, k);
        (d == 0 ? x.x : d == 1 ? x.y : x.z) = d == 0 ? edge.x : d == 1 ? edge.y : edge.z;
        visit(i, j, k, x);
      }
}
template <class Visit>
void for_sides(const Grid& grid, const Visit& visit) {
  for (int d = 0; d < 3; ++d)
    for (int end = 0; end < 2 && !grid.periodic(d); ++end) visit(d, end);
}
inline double at_side(const SideHeat::OfPlaceAndTime& of, const std::optional<double>& constant,
                      const char* what, const Vec3d& x, double time) {
  const double value = of ? of(x, time) : *constant;
  require(std::isfinite(value), "FlowSolver: SideHeat.", what, " is ", value, " at ", x,
          " m, t = ", time, " s; it must be finite");
  return value;
}

/// One step of the temperature, part by part.
class HeatStep {
 public:
  HeatStep(FlowState& state, double dt, const Team& team)
      : s_(state),
        heat_(*state.heat),
        team_(team),
        left_(state.tendency[0]),
        advected_(state.tendency[1]),
        capacity_(state.fluid.density * state.heat->of.heat_capacity),
        over_{1 / state.h(0), 1 / state.h(1), 1 / state.h(2)},
        stride_{state.stride(0), state.stride(1), state.stride(2)} {
    check_sides();
    find_links();
    const int parts = parts_of(dt);
    heat_.seen.fill(0), heat_.gained = 0;
    for (int n = 0; n < parts; ++n) {
      from_ = static_cast<double>(n) / parts, to_ = static_cast<double>(n + 1) / parts;
      dt_ = dt / parts, share_of_part_ = 1.0 / parts;
      fill_ghosts();
      advect();
      s_.sides.fill_cells(advected_);
      book_sides();
      conduct();
    }
  }

 private:
  void check_sides() const {
    for_sides(s_.grid, [&](int d, int end) {
      const SideHeat& side = heat_.side(d, end);
      const char name[] = {"xyz"[d], 0};
      require(!(side.has_flux() && (side.has_temperature() || s_.sides.through(d, end))),
              "FlowSolver: the side in ", name,
              " has a SideHeat.flux, which is for walls without a prescribed temperature; give "
              "only one, and for inflows and outflows the temperature");
      require(!(s_.turbulence && side.has_temperature() && !s_.sides.through(d, end)),
              "FlowSolver: the wall at the side in ", name,
              " has a temperature, but in turbulent flow silt has no thermal wall function; give "
              "it a SideHeat.flux");
    });
  }
  /// Walls at sides: conduction over half a cell, or a flux.
  void find_links() {
    heat_.link.fill(0), heat_.pull.fill(0);
    for_sides(s_.grid, [&](int d, int end) {
      const SideHeat& side = heat_.side(d, end);
      const double over = over_[d], time = s_.sides.time();
      if (s_.sides.through(d, end) || !(side.has_temperature() || side.has_flux())) return;
      for_side_cells(s_.grid, d, end, [&](int i, int j, int k, const Vec3d& x) {
        const double open = open_side(d, end, i, j, k) / fluid_share(s_open(j, k), i);
        if (side.has_flux()) {
          heat_.pull(i, j, k) += open * over * at_side(side.flux_at, side.flux, "flux", x, time);
        } else {
          const double link =
              2 * open * heat_.of.conductivity * s_.next_mass(i, j, k) * over * over;
          heat_.link(i, j, k) += link;
          heat_.pull(i, j, k) +=
              link * at_side(side.temperature_at, side.temperature, "temperature", x, time);
        }
      });
    });
  }
  const double* s_open(int j, int k) const {
    return s_.solids ? s_.solids->cells.row(j, k) : nullptr;
  }
  double open_side(int d, int end, int i, int j, int k) const {
    if (!s_.solids) return 1;
    return s_.solids->area[FlowState::at(d)](i + (d == 0) * end, j + (d == 1) * end,
                                             k + (d == 2) * end);
  }
  double mass(const double* m, const double* next, std::ptrdiff_t i, double part) const {
    return part == 1 ? next[i] : m[i] + part * (next[i] - m[i]);
  }

  /// [W/(m3 K)] conductance of the face below cell i in direction d.
  struct Faces {
    Faces(const FlowState& s, int j, int k) {
      m = s.next_mass.row(j, k);
      eddy = s.turbulence ? s.turbulence->eddy.row(j, k) : nullptr;
      for (int d = 0; d < 3; ++d)
        area[d] = s.solids ? s.solids->area[FlowState::at(d)].row(j, k) : nullptr;
    }
    const double *m, *eddy, *area[3];
  };
  double conducted(const Faces& f, int d, std::ptrdiff_t i) const {
    const std::ptrdiff_t b = i - stride_[d];
    double k = heat_.of.conductivity;
    if (f.eddy != nullptr)
      k += 0.5 * (f.eddy[i] + f.eddy[b]) * heat_.of.heat_capacity / heat_.of.turbulent_prandtl;
    const double mean = 2 * f.m[i] * f.m[b] / (f.m[i] + f.m[b]);
    return (f.area[d] != nullptr ? f.area[d][i] : 1) * k * mean * over_[d] * over_[d];
  }

  /// Number of equal parts of the step.
  int parts_of(double dt) const {
    const double most = s_.over_planes(
        team_,
        [&](int k) {
          double all = 0;
          for (int j = 0; j < s_.grid.ny(); ++j) {
            const Faces faces(s_, j, k);
            const double *const m = s_.mass.row(j, k), *const next = s_.next_mass.row(j, k);
            const double* F[3];
            for (int d = 0; d < 3; ++d) F[d] = s_.carried[FlowState::at(d)].row(j, k);
            for (int i = 0; i < s_.grid.nx(); ++i) {
              double out = 0, conducts = 0;
              for (int d = 0; d < 3; ++d) {
                out += over_[d] * (std::max(0.0, F[d][i + stride_[d]]) + std::max(0.0, -F[d][i]));
                conducts += conducted(faces, d, i) + conducted(faces, d, i + stride_[d]);
              }
              const double holds = std::min(m[i], next[i]) * fluid_share(s_open(j, k), i);
              all = FlowState::larger(all, dt * std::max(out, 1.1 * conducts / capacity_) / holds);
            }
          }
          return all;
        },
        FlowState::larger);
    if (!(most <= FluidHeat::most_parts))
      throw FlowStepError(
          text("FlowSolver: heat spreads over ", most, " cells in a step of ", dt,
               " s; it must be at most ", FluidHeat::most_parts, ": use a step of at most ",
               dt * FluidHeat::most_parts / most, " s, or larger cells"),
          dt * FluidHeat::most_parts / most);
    return std::max(1, static_cast<int>(std::ceil(most)));
  }

  void fill_ghosts() {
    CellField& T = heat_.temperature;
    s_.sides.fill_cells(T);
    for_sides(s_.grid, [&](int d, int end) {
      const SideHeat& side = heat_.side(d, end);
      const bool open = s_.sides.open(d, end);
      if (!s_.sides.through(d, end) || (open && !side.has_temperature())) return;
      const int out = end == 0 ? -1 : 1;
      const double time = s_.sides.time();
      for_side_cells(s_.grid, d, end, [&](int i, int j, int k, const Vec3d& x) {
        const double value = side.has_temperature() ? at_side(side.temperature_at, side.temperature,
                                                              "temperature", x, time)
                                                    : heat_.of.start_temperature;
        for (const int far : {1, 2})
          T(i + far * out * (d == 0), j + far * out * (d == 1), k + far * out * (d == 2)) = value;
      });
    });
  }

  /// advected = (m T - dt div(F T))/m'. For the fluxes see advect_turbulence().
  void advect() {
    s_.for_cells(team_, [&](int j, int k) {
      const double *const m = s_.mass.row(j, k), *const next = s_.next_mass.row(j, k);
      double* const left = left_.row(j, k);
      for (int i = 0; i < s_.grid.nx(); ++i) {
        double out = 0;
        for (int d = 0; d < 3; ++d) {
          const double* const F = s_.carried[FlowState::at(d)].row(j, k);
          out += over_[d] * (std::max(0.0, F[i + stride_[d]]) + std::max(0.0, -F[i]));
        }
        left[i] =
            std::max(0.0, 1 - dt_ * out / (mass(m, next, i, from_) * fluid_share(s_open(j, k), i)));
      }
    });
    s_.sides.fill_cells(left_);
    s_.for_cells(team_, [&](int j, int k) {
      const double *const m = s_.mass.row(j, k), *const next = s_.next_mass.row(j, k);
      double* const out = advected_.row(j, k);
      for (int i = 0; i < s_.grid.nx(); ++i) {
        double sum = 0;
        for (int d = 0; d < 3; ++d)
          sum += over_[d] * (carried_at(d, j, k, i + stride_[d]) - carried_at(d, j, k, i));
        sum *= dt_ / fluid_share(s_open(j, k), i);
        out[i] = (mass(m, next, i, from_) * heat_.temperature.row(j, k)[i] - sum) /
                 mass(m, next, i, to_);
      }
    });
  }
  double carried_at(int d, int j, int k, std::ptrdiff_t i) const {
    return carried_through(heat_.temperature.row(j, k), left_.row(j, k),
                           s_.solids ? s_.solids->area[FlowState::at(d)].row(j, k) : nullptr,
                           s_.carried[FlowState::at(d)].row(j, k)[i], i, stride_[d]);
  }
  /// Counts heat of inflow and outflow.
  void book_sides() {
    for_sides(s_.grid, [&](int d, int end) {
      double sum = 0;
      for_side_cells(s_.grid, d, end, [&](int i, int j, int k, const Vec3d&) {
        sum += carried_at(d, j, k, end == 0 ? i : i + stride_[d]);
      });
      heat_.book.through_sides +=
          (end == 0 ? 1 : -1) * sum * capacity_ * dt_ * over_[d] * s_.grid.cell_volume();
    });
  }

  /// Conduction, then walls and particles.
  void conduct() {
    DynArray<std::array<double, 3>> books(FlowState::at(s_.grid.nz()), {0, 0, 0});
    s_.for_cells(team_, [&](int j, int k) {
      const auto row = [&](const CellField& f) { return f.row(j, k); };
      const Faces faces(s_, j, k);
      const double *const m = row(s_.mass), *const next = row(s_.next_mass),
                          *const A = row(advected_), *const link = row(heat_.link),
                          *const pull = row(heat_.pull), *const exchange = row(heat_.exchange),
                          *const given = row(heat_.given), *const source = row(heat_.source),
                          *const open = s_open(j, k);
      double *const T = heat_.temperature.row(j, k), *const seen = heat_.seen.row(j, k);
      auto& book = books[FlowState::at(k)];
      for (int i = 0; i < s_.grid.nx(); ++i) {
        const double share = fluid_share(open, i);
        const double holds = capacity_ * mass(m, next, i, to_) / dt_;  // [W/(m3 K)]
        double sum = 0;
        for (int d = 0; d < 3; ++d) {
          const std::ptrdiff_t up = i + stride_[d];
          sum += conducted(faces, d, up) * (A[up] - A[i]) -
                 conducted(faces, d, i) * (A[i] - A[i - stride_[d]]);
        }
        double value = A[i] + sum / (holds * share);
        if (open == nullptr || open[i] > 0) {
          const double K = link[i] + exchange[i], S = pull[i] + given[i] + source[i];
          if (K != 0 || S != 0) value = (holds * value + S) / (holds + K);
          book[0] += share * (pull[i] - link[i] * value);
          book[1] += share * (given[i] - exchange[i] * value);
          book[2] += share * source[i];
        }
        T[i] = value, seen[i] += share_of_part_ * value;
      }
    });
    for (const auto& one : books) {
      const double energy = dt_ * s_.grid.cell_volume();
      heat_.book.through_sides += energy * one[0];
      heat_.book.from_particles += energy * one[1], heat_.gained += energy * one[1];
      heat_.book.from_sources += energy * one[2];
    }
  }

  FlowState& s_;
  FlowHeat& heat_;
  const Team& team_;
  CellField &left_, &advected_;  // [-] part of a cell's content that does not flow out, [K]
  double capacity_;              // [J/(m3 K)] of the fluid
  double over_[3];               // [1/m]
  std::ptrdiff_t stride_[3];
  double from_ = 0, to_ = 1, dt_ = 0, share_of_part_ = 1;  // of the part: in the step, [s], [-]
};

/// [J] relative to 0 K.
inline double stored_heat(const FlowState& state, const CellField& mass, const Team& team) {
  const double sum = state.over_planes(
      team,
      [&](int k) {
        double all = 0;
        for (int j = 0; j < state.grid.ny(); ++j) {
          const double *const m = mass.row(j, k), *const T = state.heat->temperature.row(j, k);
          const double* const open = state.solids ? state.solids->cells.row(j, k) : nullptr;
          for (int i = 0; i < state.grid.nx(); ++i) all += fluid_share(open, i) * m[i] * T[i];
        }
        return all;
      },
      FlowState::added);
  return state.fluid.density * state.heat->of.heat_capacity * state.grid.cell_volume() * sum;
}

inline void carry_heat(FlowState& state, double dt, const Team& team) {
  if (!state.heat) return;
  FluidHeatBook& book = state.heat->book;
  if (book.stored >= 0) book.counted_anew += stored_heat(state, state.mass, team) - book.stored;
  HeatStep(state, dt, team);
  book.stored = stored_heat(state, state.next_mass, team);
}

/// Forces of the step, with buoyancy.
inline void push_by_heat(FlowState& state, const Team& team) {
  if (!state.heat || state.heat->push.empty()) return;
  FlowHeat& heat = *state.heat;
  const Vec3d g = heat.of.gravity;
  const double by[3] = {g.x, g.y, g.z}, factor = -state.fluid.density * heat.of.expansion;
  for (int d = 0; d < 3; ++d) {
    CellField& push = heat.push[FlowState::at(d)];
    state.for_cells(team, [&](int j, int k) {
      const double *const s = state.force[FlowState::at(d)].row(j, k),
                          *const T = heat.temperature.row(j, k), *const eps = state.eps.row(j, k);
      double* const out = push.row(j, k);
      for (int i = 0; i < state.grid.nx(); ++i)
        out[i] = s[i] + factor * by[d] * eps[i] * (T[i] - heat.of.reference_temperature);
    });
    if (state.solids) state.solids->fill_corners(push);
    state.sides.fill_cells(push);
  }
}

/// Heat functions of a FlowSolver, inherited by it.
template <class Solver>
class HeatOfFlow {
 public:
  /// Adds a temperature to the fluid, initially start_temperature. No cost unless called.
  void set_heat(const FluidHeat& heat) {
    heat.check();
    FlowState& s = state();
    std::array<std::array<SideHeat, 2>, 3> sides;
    if (s.heat) sides = s.heat->sides;
    s.heat.emplace(s.grid, heat);
    s.heat->sides = sides;
  }
  bool has_heat() const { return state().heat.has_value(); }
  const FluidHeat& heat() const { return known().of; }
  /// Thermal condition at the lower (end 0) or upper (end 1) side of a direction; default:
  /// insulated.
  void set_side_heat(int direction, int end, const SideHeat& side) {
    require(direction >= 0 && direction < 3 && (end == 0 || end == 1), "FlowSolver: side (",
            direction, ", ", end, ") does not exist; directions are 0, 1, 2 and ends 0, 1");
    require(!state().grid.periodic(direction), "FlowSolver: the grid is periodic in ",
            "xyz"[direction], "; it has no sides there");
    if (side.temperature) require_not_negative("SideHeat.temperature", *side.temperature, "K");
    known().side(direction, end) = side;
  }
  CellField& temperature() { return known().temperature; }  // [K]
  const CellField& temperature() const { return known().temperature; }
  /// Sources in the coming steps; kept from step to step.
  CellField& heat_source() { return known().source; }  // [W/m3]
  /// @name Exchange with particles in the coming step: sums of b and b T_p, see FluidHeat
  /// @{
  CellField& heat_exchange() { return known().exchange; }        // [W/(m3 K)]
  CellField& heat_of_particles() { return known().given; }       // [W/m3]
  CellField& temperature_seen() { return known().seen; }         // [K] by them, in the last step
  double heat_from_particles() const { return known().gained; }  // [J] in the last step
  /// @}
  FluidHeatBook heat_book(const Team& team = {}) const {
    FluidHeatBook book = known().book;
    const double now = stored_heat(state(), state().mass, team);
    if (book.stored >= 0) book.counted_anew += now - book.stored;
    book.stored = now;
    return book;
  }

 private:
  FlowState& state() { return static_cast<Solver&>(*this).s_; }
  const FlowState& state() const { return static_cast<const Solver&>(*this).s_; }
  FlowHeat& known() {
    require(state().heat.has_value(), "FlowSolver: the flow has no temperature; set_heat() first");
    return *state().heat;
  }
  const FlowHeat& known() const { return const_cast<HeatOfFlow&>(*this).known(); }
};

}  // namespace silt::fluid_detail
