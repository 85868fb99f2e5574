// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/flow_rows.hpp>
#include <silt/fluid/flow_sides.hpp>
#include <silt/fluid/flow_solids.hpp>
#include <silt/fluid/flow_step.hpp>
#include <silt/fluid/flow_turbulence.hpp>
#include <silt/fluid/fluid_heat.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET {

namespace fluid_detail {

/// Fields of a FlowSolver, and loops over them; ghosts follow `sides`.
struct FlowState {
  FlowState(const Grid& g, const FluidProperties& f, const FlowOptions& o)
      : grid(g), fluid(f), options(o), sides(g) {}

  static std::size_t at(int d) { return static_cast<std::size_t>(d); }
  std::ptrdiff_t stride(int d) const {
    return d == 0 ? 1
                  : static_cast<std::ptrdiff_t>(d == 1 ? grid.row_stride() : grid.plane_stride());
  }
  double h(int d) const { return d == 0 ? grid.h().x : d == 1 ? grid.h().y : grid.h().z; }

  /// Calls visit(j, k, from, to) for the rows of the unknown velocities of direction d; planes in
  /// threads.
  template <class Visit>
  void for_faces(int d, const Team& team, const Visit& visit) const {
    const auto& n = grid.cells();
    int from[3] = {0, 0, 0}, to[3] = {n[0], n[1], n[2]};
    from[d] = sides.first(d), to[d] = sides.last(d);
    team.for_parts(static_cast<std::size_t>(std::max(0, to[2] - from[2])), [&](std::size_t part) {
      const int k = from[2] + static_cast<int>(part);
      for (int j = from[1]; j < to[1]; ++j) visit(j, k, from[0], to[0]);
    });
  }
  template <class Visit>
  void for_cells(const Team& team, const Visit& visit) const {
    team.for_parts(at(grid.nz()), [&](std::size_t k) {
      for (int j = 0; j < grid.ny(); ++j) visit(j, static_cast<int>(k));
    });
  }

  void take_voidage() {
    if (options.model == MomentumModel::Simplified) return;  // constant 1
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j) {
        const double* const e = voidage.row(j, k);
        for (int i = 0; i < grid.nx(); ++i)
          if (!(e[i] > 0 && e[i] <= 1 + 1e-9)) [[unlikely]]
            throw Error(text("FlowSolver: cell (", i, ", ", j, ", ", k, ") has a void fraction of ",
                             e[i],
                             "; it must be above 0 and at most 1: spread the particles' volume "
                             "over more cells, or use larger cells"));
      }
    eps = voidage;
    sides.fill_cells(eps);
  }

  /// Refuses a drag that would accelerate the fluid. (One that is not a number: FlowProjection.)
  void check_drag() const {
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j) {
        const double* const K = drag.row(j, k);
        for (int i = 0; i < grid.nx(); ++i)
          if (K[i] < 0 || std::isinf(K[i])) [[unlikely]]
            throw Error(text("FlowSolver: the drag K of cell (", i, ", ", j, ", ", k, ") is ", K[i],
                             " kg/(m3 s); it must be finite and not negative: check what sets it"));
      }
  }

  /// Refuses temperatures and sources that were set to what they cannot be.
  void check_heat() const {
    if (!heat) return;
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) {
          const double T = heat->temperature(i, j, k), source = heat->source(i, j, k);
          if (!(T >= 0 && std::isfinite(T))) [[unlikely]]
            throw Error(text("FlowSolver: the temperature of cell (", i, ", ", j, ", ", k, ") is ",
                             T, " K; it must be finite and not negative"));
          if (!std::isfinite(source)) [[unlikely]]
            throw Error(text("FlowSolver: the heat source of cell (", i, ", ", j, ", ", k, ") is ",
                             source, " W/m3; it must be finite"));
        }
  }

  static void scale_inflows(FlowSides& sides, const std::optional<FlowBoundary>& boundary,
                            const std::optional<FlowSolids>& solids) {
    sides.scale(boundary ? boundary->distance : nullptr, [&](int d, int i, int j, int k) {
      return solids ? solids->area[at(d)](i, j, k) : 1.0;
    });
  }
  /// Boundary faces and ghosts of a velocity.
  void fill_velocity(int d, CellField& u) const {
    sides.fill_velocity(d, u, eps);
    if (!solids || grid.periodic(d)) return;
    const int n[3] = {grid.nx(), grid.ny(), grid.nz()}, a = (d + 1) % 3, b = (d + 2) % 3;
    for (int y = 0; y < n[b]; ++y)
      for (int x = 0; x < n[a]; ++x)
        for (const int end : {0, n[d]}) {
          int f[3];
          f[d] = end, f[a] = x, f[b] = y;
          if (solids->area[at(d)](f[0], f[1], f[2]) == 0)
            u(f[0], f[1], f[2]) = solids->velocity[at(d)](f[0], f[1], f[2]);
        }
  }
  /// Eddy viscosity and wall shear of a turbulent flow.
  void find_turbulence(const Team& team) {
    if (!turbulence) return;
    if (!turbulence->ready)
      turbulence->prepare(grid, sides, boundary ? &*boundary : nullptr, solids ? &*solids : nullptr,
                          fluid.viscosity, fluid.viscosity / fluid.density,
                          turbulence->two ? fastest() : 0);
    if (!turbulence->found)
      turbulence->find(grid, sides, velocity, fluid.density, fluid.viscosity, team);
    turbulence->found = true;
  }
  /// To be called when walls, sides or velocities are changed from outside.
  void forget_eddies() {
    if (turbulence) turbulence->found = false;
  }
  /// 1/s, for explicit steps: eddies act twice along a component's own direction.
  double eddy_rate() const {
    const double x = 1 / (h(0) * h(0)), y = 1 / (h(1) * h(1)), z = 1 / (h(2) * h(2));
    const double most = turbulence->two && turbulence->largest == 0
                            ? eddies_at_start()
                            : turbulence->largest / fluid.density;
    return most * (x + y + z + std::max({x, y, z}));
  }
  /// [m/s] largest velocity on any face, or of an inflow.
  double fastest() const {
    double most = 0;
    for (int d = 0; d < 3; ++d) {
      for (int end = 0; end < 2; ++end) most = std::max(most, sides.inflow_speed(d, end));
      for (int k = 0; k <= grid.nz(); ++k)
        for (int j = 0; j <= grid.ny(); ++j)
          for (int i = 0; i <= grid.nx(); ++i)
            most = std::max(most, std::abs(velocity[at(d)](i, j, k)));
    }
    return most;
  }
  /// [m2/s] from k and epsilon at the first step.
  double eddies_at_start() const {
    const TwoEquations& two = *turbulence->two;
    const double k0 = two.model.start_energy(fastest(), fluid.viscosity / fluid.density);
    double most = 0;
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i) {
          const double energy = two.k(i, j, k) > 0 ? two.k(i, j, k) : k0, e = two.epsilon(i, j, k);
          most = std::max(
              most,
              two.model.eddy(energy,
                             e > 0 ? e : two.model.dissipation(energy, two.model.inflow_length())));
        }
    return most;
  }
  bool beside_solids(int i, int j, int k) const {
    if (!solids) return false;
    for (int d = 0; d < 3; ++d) {
      const double* const area = &solids->area[at(d)].row(j, k)[i];
      if (area[0] < 1 || area[stride(d)] < 1) return true;
    }
    return false;
  }

  /// to = a eps u on all faces, including boundary faces; a: open share.
  void superficial(const Three& u, Three& to, const Team& team) const {
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = stride(d);
      const int more[3] = {d == 0, d == 1, d == 2};
      team.for_parts(at(grid.nz() + more[2]), [&](std::size_t part) {
        const int k = static_cast<int>(part);
        for (int j = 0; j < grid.ny() + more[1]; ++j) {
          const double *e = eps.row(j, k), *v = u[at(d)].row(j, k);
          const double* const area = solids ? solids->area[at(d)].row(j, k) : nullptr;
          double* out = to[at(d)].row(j, k);
          fluid_detail::for_row(0, grid.nx() + more[0], [&]<class Real>(int i) {
            const Real mean = Real(0.5) * (load_any<Real>(e + i - s) + load_any<Real>(e + i));
            Real through = mean * load_any<Real>(v + i);
            if (area != nullptr) through = through * load_any<Real>(area + i);
            store_any(out + i, through);
          });
        }
      });
      sides.fill_flux(d, to[at(d)]);
    }
  }

  /// s of (3) in direction d, with buoyancy.
  const CellField& pushes(int d) const {
    return heat && !heat->push.empty() ? heat->push[at(d)] : force[at(d)];
  }
  double divergence(const Three& f, int i, int j, int k) const {
    double sum = 0;
    for (int d = 0; d < 3; ++d) {
      const double* const v = &f[at(d)].row(j, k)[i];
      sum += (v[stride(d)] - v[0]) / h(d);
    }
    return sum;
  }
  /// Sum of of_plane(k) over planes, or with std::max for `join` the largest.
  template <class OfPlane, class Join>
  double over_planes(const Team& team, const OfPlane& of_plane, const Join& join) const {
    DynArray<double> of(at(grid.nz()), 0.0);
    team.for_parts(of.size(), [&](std::size_t k) { of[k] = of_plane(static_cast<int>(k)); });
    double all = 0;
    for (const double one : of) all = join(all, one);
    return all;
  }
  static double larger(double a, double b) { return !(b <= a) ? b : a; }  // also passes NaN
  static double added(double a, double b) { return a + b; }

  double courant(double dt, const Team& team) const {
    const double over[3] = {dt / h(0), dt / h(1), dt / h(2)};
    return over_planes(
        team,
        [&](int k) {
          double most = 0;
          for (int j = 0; j < grid.ny(); ++j)
            for (int i = 0; i < grid.nx(); ++i) {
              double one = 0;
              for (int d = 0; d < 3; ++d) {
                const double* const v = &velocity[at(d)].row(j, k)[i];
                one += over[d] * std::max(std::abs(v[0]), std::abs(v[stride(d)]));
              }
              most = larger(most, one);
            }
          return most;
        },
        larger);
  }
  Grid grid;
  FluidProperties fluid;
  FlowOptions options;
  FlowSides sides;
  std::optional<FlowSolids> solids;
  std::optional<FlowBoundary> boundary;
  std::optional<FlowTurbulence> turbulence;
  std::optional<FlowHeat> heat;
  bool started = false;
  bool sides_changed = true;  // since the last step, or in the first one
  /// The flow jumped in the last step: its fluxes and pressure do not predict the next step.
  bool jumped = false;
  double old_dt = 0;  // [s] last step; 0: none, or the flow jumped in it
  Three velocity = three(), first = three(), next = three();    // [m/s] u, after a stage, u*
  Three flow = three(), old_flow = three(), carried = three();  // [m/s] eps u; F
  Three tendency = three();                                     // [N/m3] of the first stage
  Three weight = three();                                       // [m3 s/kg] e/D
  DynArray<CellField> stress;                                   // [N/m3] div tau, if stored
  std::optional<ParticleResponse> response;                     // if particles have one
  CellField pressure{grid};                                     // [Pa]
  CellField voidage{grid, 1}, eps{grid, 1}, old_eps{grid, 1}, older_eps{grid, 1};
  CellField mass{grid, 1}, next_mass{grid, 1};  // [-] m, m'
  CellField spread{grid};                       // [1/s] div u
  CellField drag{grid};                         // [kg/(m3 s)] K
  Three drag_v = three(), force = three();      // [N/m3] K v, s

 private:
  Three three() const { return {CellField(grid), CellField(grid), CellField(grid)}; }
};

}  // namespace fluid_detail

}  // namespace silt
