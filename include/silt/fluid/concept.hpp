// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <span>
#include <string>

#include <silt/core/threads.hpp>
#include <silt/fluid/flow_step.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

struct StateVisitor {
  template <class Values>
  void operator()(const std::string&, Values&&) const {}
};

template <class F>
concept FlowFields = requires(F& flow, const F& seen, int direction) {
  { seen.grid() } -> std::convertible_to<const Grid&>;
  { seen.fluid() } -> std::convertible_to<const FluidProperties&>;
  { seen.options() } -> std::convertible_to<const FlowOptions&>;
  { seen.velocity(direction) } -> std::convertible_to<const CellField&>;
  { flow.pressure() } -> std::same_as<CellField&>;
  { flow.voidage() } -> std::same_as<CellField&>;
  flow.fill_pressure_ghosts();
  { seen.holds_pressure(direction, 0) } -> std::same_as<bool>;
  flow.keep_stress();
  { seen.stress(direction) } -> std::convertible_to<const CellField&>;
};

template <class F>
concept TakesDrag = requires(F& flow, const F& seen, int direction) {
  { flow.drag() } -> std::same_as<CellField&>;
  { flow.drag_velocity(direction) } -> std::same_as<CellField&>;
  { flow.response() } -> std::same_as<ParticleResponse&>;
  { seen.responds() } -> std::same_as<bool>;
};

template <class F>
concept FlowSteps = requires(F& flow, const F& seen, double dt, const Team& team) {
  { flow.step(dt, team) } -> std::convertible_to<FlowStep>;
  { seen.stable_step(team) } -> std::convertible_to<double>;
  flow.for_each_state(StateVisitor{});
};

template <class F>
concept FlowWalls = requires(const F& seen, int direction) {
  { seen.boundaries() } -> std::convertible_to<int>;
  { seen.open_cells() } -> std::convertible_to<const CellField*>;
  { seen.open_row(0, 0) } -> std::convertible_to<const double*>;
  { seen.open_faces(direction) } -> std::convertible_to<const CellField*>;
  { seen.inner_faces(direction) } -> std::convertible_to<const CellField*>;
  seen.joined_cells();
};

}  // namespace detail

/// Flow on a Grid, as required by CoupledFlow. FlowSolver is one. A user-defined flow usually
/// derives from it and replaces step(), for example for a time-dependent inflow
/// (docs/own_fluid.md).
///
///   fields   grid(), fluid(), options(); velocity(d) on the faces of direction d, pressure() and
///            voidage() in cells, as FlowSolver; fill_pressure_ghosts(), holds_pressure(d, end);
///            keep_stress(), after which steps store stress(d), div tau
///   drag     drag(), drag_velocity(d): action of particles in the coming step; response(): their
///            response within the step, responds(): whether response() was ever called
///   steps    step(dt, team) -> FlowStep, which throws Error, or FlowStepError if a shorter step
///            would succeed; stable_step(team) [s]; for_each_state(visit), for checkpoints
///   walls    open_cells(), open_row(j, k), open_faces(d), inner_faces(d), joined_cells(): null
///            without walls in the box; boundaries(): number of boundaries set so far
///
/// Tests: tests/coupling/own_coupling.cpp.
template <class F>
concept FlowOnGrid =
    detail::FlowFields<F> && detail::TakesDrag<F> && detail::FlowSteps<F> && detail::FlowWalls<F>;

}  // namespace silt
