// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include <silt/fluid/concept.hpp>
#include <silt/fluid/flow_heat.hpp>
#include <silt/fluid/flow_k_epsilon.hpp>
#include <silt/fluid/flow_momentum.hpp>
#include <silt/fluid/flow_projection.hpp>

namespace silt::inline SILT_TARGET {

/// Incompressible flow through particles, volume averaged, on the staggered (MAC) cells of a Grid:
/// velocities on faces, all other fields in cells.
///
///   d(eps)/dt + div(eps u) = 0                                                                 (1)
///   momentum as MomentumModel says, tau = mu (grad u + grad u' - 2/3 div u 1)                  (2)
///   f = K (v - u) + s                                                                          (3)
///
/// u [m/s] is the interstitial velocity, eps u the superficial velocity, which an Inflow
/// prescribes; on a side of the box eps is that of the adjacent cells. Before a step the caller
/// sets eps at its end, K and K v (drag of the particles), and other forces s. Drag is implicit and
/// does not limit the step. The pressure excludes the fluid's weight: add buoyancy to bodies in the
/// fluid.
///
/// A step: fluxes eps u extrapolated to its middle; advection and viscosity by Heun's method; drag
/// and pressure by incremental projection, with the drag in the diagonal and in the weight of the
/// pressure:
///
///   D u* = rho m u / dt + T - e grad p + K v + s,   D = rho m' / dt + K                        (4)
///   div(eps e / D grad dp) = div(eps u*) + (eps' - eps) / dt,   u' = u* - e / D grad dp        (5)
///
/// with e = eps (model A) or 1. Light or stiffly coupled particles respond within the step
/// (ParticleResponse). The pressure and stress that they leave to the fluid are added to e (q per
/// volume), and the volume that they carry is added to (5),
///
///   div((eps + A) (e + q)/D + B) grad dp = div(eps u* + S + A u* - B grad p) + (eps - eps~)/dt (6)
///
/// A, B, S: sums of V a, V b, V (v0 + b div tau) per volume; eps~ is the void fraction consistent
/// with the fluxes so far, which conserves volume even if particles move differently. Without (6)
/// the response of particles to the pressure reaches the fluid one step later, with a gain of (1 -
/// eps)/eps rho/rho_p: above 1 every step is unstable.
///
/// m is the fluid mass carried by the fluxes F into the volume of a velocity, m' = m - dt div F; it
/// lags eps by a step. Momentum is conserved to rounding, and a uniform flow remains uniform for
/// any eps. Second order in space and time for smooth flows; drag is first order in time. Stable
/// for courant <= 1 and mu dt / (rho eps) sum 1/h^2 < 1/2: see stable_step().
///
/// Source: F. H. Harlow, J. E. Welch, Phys. Fluids 8 (1965) 2182 (staggered cells); J. van Kan,
///   SIAM J. Sci. Stat. Comput. 7 (1986) 870 (incremental projection); Z. Y. Zhou et al., J. Fluid
///   Mech. 661 (2010) 482 (models A and B are sets II and III).
/// Threads: results are equal, bit for bit, for every number of threads.
/// Errors: InputError for invalid sides, fluids and fields; Error, with a sentence, if a step
///         fails.
/// Tests:  tests/fluid/flow_solver.cpp, tests/fluid/inflow.cpp, tests/fluid/inflow_in_time.cpp.
class FlowSolver : public fluid_detail::HeatOfFlow<FlowSolver> {
  using FlowState = fluid_detail::FlowState;
  friend class fluid_detail::HeatOfFlow<FlowSolver>;

 public:
  FlowSolver(const Grid& grid, const FluidProperties& fluid, const FlowOptions& options = {})
      : s_(grid, fluid, options),
        projection_(std::make_unique<fluid_detail::FlowProjection>(grid)) {
    require(std::isfinite(fluid.density) && fluid.density > 0,
            "FluidProperties.density = ", fluid.density,
            " kg/m3 must be given and positive: air at 20 C has 1.2, water 998");
    require(!std::isnan(fluid.viscosity),
            "FluidProperties.viscosity [Pa s] must be given: air at 20 C has 1.8e-5, water 1e-3");
    require(std::isfinite(fluid.viscosity) && fluid.viscosity >= 0,
            "FluidProperties.viscosity = ", fluid.viscosity, " Pa s must not be negative");
    require(options.tolerance > 0 && options.tolerance < 1,
            "FlowOptions.tolerance = ", options.tolerance, " must be in (0, 1)");
  }

  FlowSolver(FlowSolver&&) = default;
  FlowSolver(const FlowSolver& other)
      : s_(other.s_),
        before_put_in_(other.before_put_in_),
        boundaries_(other.boundaries_),
        projection_(std::make_unique<fluid_detail::FlowProjection>(other.grid())) {}
  FlowSolver& operator=(FlowSolver&&) = default;

  const Grid& grid() const { return s_.grid; }
  const FluidProperties& fluid() const { return s_.fluid; }
  /// [m/s] largest component of the velocity on any face, or of an inflow.
  double fastest() const { return s_.fastest(); }
  const FlowOptions& options() const { return s_.options; }

  /// Condition at the lower (end 0) or upper (end 1) side of a direction that is not periodic;
  /// default: a wall at rest. If the mean pressure of the outlets changes, the whole pressure is
  /// shifted by the change. A jump at the outlet would cause a pressure pulse.
  void set_side(int direction, int end, const FlowSide& side) {
    fluid_detail::FlowSides sides = s_.sides;
    sides.set(direction, end, side);
    s_.scale_inflows(sides, s_.boundary, s_.solids);
    if (sides.any_open())
      for (double& p : s_.pressure.values())
        p += sides.outlet_pressure() - s_.sides.outlet_pressure();
    s_.sides = std::move(sides), s_.sides_changed = true;
    if (s_.turbulence) s_.turbulence->ready = s_.turbulence->found = false;
  }

  /// Walls in the box: there is fluid only where boundary.distance > 0.
  void set_boundary(const FlowBoundary& boundary) {
    require(static_cast<bool>(boundary.distance),
            "FlowBoundary.distance is not set; give the signed distance to the surface");
    before_put_in_.reset();
    std::optional<fluid_detail::FlowSolids> solids;
    solids.emplace(grid(), boundary, s_.fluid.viscosity);
    fluid_detail::FlowSides sides = s_.sides;
    sides.fill_cells(solids->cells);
    s_.scale_inflows(sides, boundary, solids);
    s_.sides = std::move(sides), s_.solids = std::move(solids), s_.boundary = boundary;
    if (s_.turbulence) s_.turbulence->ready = s_.turbulence->found = false;
    s_.started = false, ++boundaries_;
  }
  int boundaries() const { return boundaries_; }  // number of boundaries set so far
  /// [m] from the walls in the box, by FlowBoundary.distance; infinite without.
  double wall_distance(const Vec3d& place) const {
    return s_.boundary ? s_.boundary->distance(place) : std::numeric_limits<double>::infinity();
  }

  /// Time [s] for time-dependent inflows: 0 at first, then the sum of all steps. A CoupledFlow sets
  /// it to its own before each step. `last_step` [s]: the previous step, if any. Not part of
  /// for_each_state(): set it after restoring a state.
  double time() const { return s_.sides.time(); }
  void set_time(double time, double last_step = 0) {
    require(std::isfinite(time), "FlowSolver::set_time: ", time, " [s] must be finite");
    const double off = std::abs(time - s_.sides.time());
    if (s_.sides.any_changes() && !(off <= 1e-6 * last_step)) {
      if (last_step > 0) s_.sides.renew(time - last_step, 0);
      s_.sides.renew(time, last_step);
    }
    s_.sides.set_time(time);
  }
  /// Turbulent flow with Reynolds-averaged velocities. No cost unless called.
  void set_turbulence(const MixingLength& model) { make_turbulent(model); }
  void set_turbulence(const KEpsilon& model) { make_turbulent(model); }
  const char* turbulence_model() const {
    return !s_.turbulence ? "none" : s_.turbulence->two ? "k-epsilon" : "mixing length";
  }
  /// For KEpsilon, in cells; where 0 at the first step they get the initial values of KEpsilon.
  CellField& turbulent_energy() { return equations().k; }   // [m2/s2]
  CellField& dissipation() { return equations().epsilon; }  // [m2/s3]
  const CellField& turbulent_energy() const { return equations().k; }
  const CellField& dissipation() const { return equations().epsilon; }
  /// For a turbulent flow after a step: [Pa s] in cells, and y+ at walls.
  const CellField& eddy_viscosity() const {
    check_turbulent();
    return s_.turbulence->eddy;
  }
  WallUnits wall_units() const {
    check_turbulent();
    return s_.turbulence->walls;
  }
  /// Share of cells open to the fluid, at least 0.1, and 0 in closed cells; null if all are whole.
  const CellField* open_cells() const { return s_.solids ? &s_.solids->cells : nullptr; }
  /// Of row (j, k), for fluid_detail::fluid_share.
  const double* open_row(int j, int k) const {
    return s_.solids ? s_.solids->cells.row(j, k) : nullptr;
  }
  /// Open share of each face of direction d, and 1 or 0 if its centre is in the fluid or not; null
  /// if all are whole.
  const CellField* open_faces(int d) const {
    return s_.solids ? &s_.solids->area[FlowState::at(d)] : nullptr;
  }
  const CellField* inner_faces(int d) const {
    return s_.solids ? &s_.solids->inside[FlowState::at(d)] : nullptr;
  }
  /// Cells at walls that are merged for particles; null without walls in the box.
  const fluid_detail::JoinedCells* joined_cells() const {
    return s_.solids ? &s_.solids->joined : nullptr;
  }
  /// Fills the ghosts of the pressure by the sides; whether a side fixes the pressure or is
  /// periodic, which allows a gradient across it.
  void fill_pressure_ghosts() { s_.sides.fill_pressure(s_.pressure, false); }
  bool holds_pressure(int d, int end) const { return grid().periodic(d) || s_.sides.open(d, end); }
  /// Flow rate through all faces `face` of direction d [m3/s].
  double flow_rate(int d, int face) const {
    const auto& n = grid().cells();
    double sum = 0;
    int at[3], to[3] = {n[0], n[1], n[2]};
    to[d] = 1;
    for (at[2] = 0; at[2] < to[2]; ++at[2])
      for (at[1] = 0; at[1] < to[1]; ++at[1])
        for (at[0] = 0; at[0] < to[0]; ++at[0]) {
          int f[3] = {at[0], at[1], at[2]};
          f[d] = face;
          sum += s_.flow[FlowState::at(d)](f[0], f[1], f[2]);
        }
    return sum * grid().cell_volume() / s_.h(d);
  }

  /// @name State, on faces of each direction and in cells
  /// @{
  CellField& velocity(int d) {  // [m/s] interstitial
    s_.forget_eddies();
    return s_.velocity[FlowState::at(d)];
  }
  const CellField& velocity(int d) const { return s_.velocity[FlowState::at(d)]; }
  CellField& pressure() { return s_.pressure; }  // [Pa] at the middle of the last step
  const CellField& pressure() const { return s_.pressure; }
  /// @}

  /// @name Action of the particles, in cells; set before a step, kept from step to step
  /// @{
  CellField& voidage() { return s_.voidage; }  // [-] eps at the end of the step
  const CellField& voidage() const { return s_.voidage; }
  CellField& drag() { return s_.drag; }                                    // [kg/(m3 s)] K >= 0
  CellField& drag_velocity(int d) { return s_.drag_v[FlowState::at(d)]; }  // [N/m3] K v
  CellField& force(int d) { return s_.force[FlowState::at(d)]; }           // [N/m3] s
  /// Response of particles within the step; created at the first call.
  ParticleResponse& response() {
    if (!s_.response) s_.response.emplace(grid());
    return *s_.response;
  }
  bool responds() const { return s_.response.has_value(); }
  /// @}

  /// From now on steps store div tau [N/m3], the viscous part that acts equally on fluid and
  /// particles, on the inner faces of each direction; without the stress of walls in the box.
  void keep_stress() {
    if (s_.stress.empty()) s_.stress.assign(3, CellField(grid()));
  }
  const CellField& stress(int d) const { return s_.stress[FlowState::at(d)]; }

  /// Takes the velocities as set as initial state of the steps; default: at rest.
  void start(const Team& team = {}) {
    before_put_in_.reset();
    s_.take_voidage();
    s_.older_eps = s_.old_eps = s_.mass = s_.eps;
    for (int d = 0; d < 3; ++d) {
      if (s_.solids)
        for (int k = 0; k < grid().nz(); ++k)
          for (int j = 0; j < grid().ny(); ++j)
            for (int i = 0; i < grid().nx(); ++i)
              if (s_.solids->area[FlowState::at(d)](i, j, k) == 0)
                s_.velocity[FlowState::at(d)](i, j, k) =
                    s_.solids->velocity[FlowState::at(d)](i, j, k);
      s_.fill_velocity(d, s_.velocity[FlowState::at(d)]);
    }
    s_.forget_eddies();
    s_.superficial(s_.velocity, s_.flow, team);
    s_.old_flow = s_.flow;
    s_.old_dt = 0, s_.started = s_.sides_changed = true;
  }

  /// Solids [m3 in each cell] that have been put there since the last step, and have not pushed the
  /// fluid away: that in their place is gone, with the momentum and the heat that it had. A cell
  /// keeps a void fraction of `least`. Solids that were taken away are negative: fluid of the
  /// cell's velocity and temperature is in their place. A second call before the step replaces the
  /// first. Without this call the next step drives the
  /// fluid out or in, in no time.
  void put_in(const CellField& solids, double least, const Team& team = {}) {
    if (!s_.started || s_.options.model == MomentumModel::Simplified) return;
    if (before_put_in_)
      std::tie(s_.old_eps, s_.older_eps, s_.mass) = *before_put_in_;
    else
      before_put_in_.emplace(s_.old_eps, s_.older_eps, s_.mass);
    const double over = 1 / grid().cell_volume();
    s_.for_cells(team, [&](int j, int k) {
      const double* const open = open_row(j, k);
      const double* const v = solids.row(j, k);
      for (CellField* before : {&s_.old_eps, &s_.older_eps, &s_.mass}) {
        double* const eps = before->row(j, k);
        for (int i = 0; i < grid().nx(); ++i)
          eps[i] = std::clamp(eps[i] - v[i] * over / fluid_detail::fluid_share(open, i),
                              std::min(eps[i], least), std::max(eps[i], 1.0));
      }
    });
  }

  /// Momentum of the fluid [kg m/s] that steps conserve: in the volumes of velocities.
  Vec3d momentum(const Team& team = {}) const {
    double of[3];
    for (int d = 0; d < 3; ++d) {
      const std::ptrdiff_t s = s_.stride(d);
      const int first = s_.sides.first(d), last = s_.sides.last(d);
      of[d] = s_.over_planes(
          team,
          [&](int k) {
            double all = 0;
            for (int j = 0; j < s_.grid.ny(); ++j) {
              const double* const open = open_row(j, k);
              for (int i = 0; i < s_.grid.nx(); ++i) {
                const int face = d == 0 ? i : d == 1 ? j : k;
                const double *m = &s_.mass.row(j, k)[i], u = s_.velocity[FlowState::at(d)](i, j, k);
                const double low = open != nullptr ? open[i - s] * m[-s] : m[-s],
                             high = open != nullptr ? open[i] * m[0] : m[0];
                if (face >= first && face < last) all += 0.5 * (low + high) * u;
              }
            }
            return all;
          },
          FlowState::added);
      of[d] *= s_.fluid.density * s_.grid.cell_volume();
    }
    return {of[0], of[1], of[2]};
  }

  /// Longest step [s] for which the explicit terms are stable, with a margin.
  double stable_step(const Team& team = {}) const {
    const Vec3d h = s_.grid.h();
    const double speeds = s_.courant(1, team),
                 squares = 1 / (h.x * h.x) + 1 / (h.y * h.y) + 1 / (h.z * h.z);
    const double by_flow = speeds > 0 ? 0.5 / speeds : std::numeric_limits<double>::infinity();
    const double nu = s_.fluid.viscosity / s_.fluid.density;
    const double by_eddies = s_.turbulence ? s_.eddy_rate() : 0;
    double longest = std::min(by_flow, 0.35 / (nu * squares + by_eddies));
    if (s_.sides.any_changes() && std::isfinite(longest)) {  // includes coming inflow
      fluid_detail::FlowSides ahead = s_.sides;
      const auto crossed = [&](double t) {  // [-] cells in a step of `longest`
        ahead.renew(time() + t, 0);
        return longest * ahead.changing_courant();
      };
      while (crossed(longest) > 0.5 || crossed(0.5 * longest) > 0.5) longest *= 0.5;
    }
    return longest;
  }

  /// State for a restart, part by part: visit(name, span of doubles), which may change it.
  template <class Visit>
  void for_each_state(const Visit& visit) {
    before_put_in_.reset();
    const auto fields = [&](const char* name, auto&... field) {
      int number = 0;
      (visit(text(name, number++), field.values()), ...);
    };
    fields("fluid.velocity", s_.velocity[0], s_.velocity[1], s_.velocity[2]);
    fields("fluid.flow", s_.flow[0], s_.flow[1], s_.flow[2]);
    fields("fluid.old_flow", s_.old_flow[0], s_.old_flow[1], s_.old_flow[2]);
    fields("fluid.pressure", s_.pressure);
    fields("fluid.voidage", s_.voidage, s_.eps, s_.old_eps, s_.older_eps, s_.mass);
    std::array<double, 4> last{s_.started ? 1.0 : 0.0, s_.old_dt, s_.sides_changed ? 1.0 : 0.0,
                               s_.jumped ? 1.0 : 0.0};
    for (int d = 0; d < 3 && !s_.stress.empty(); ++d)
      visit(text("fluid.stress", d), s_.stress[FlowState::at(d)].values());
    visit("fluid.last", std::span<double>(last));
    s_.forget_eddies();
    if (s_.turbulence) visit("fluid.eddy", std::span<double>(&s_.turbulence->largest, 1));
    if (s_.turbulence && s_.turbulence->two)
      fields("fluid.k_epsilon", s_.turbulence->two->k, s_.turbulence->two->epsilon);
    if (s_.heat) {
      FluidHeatBook& book = s_.heat->book;
      std::array<double, 5> sums{book.stored, book.through_sides, book.from_particles,
                                 book.from_sources, book.counted_anew};
      fields("fluid.temperature", s_.heat->temperature),
          visit("fluid.heat", std::span<double>(sums));
      book = {sums[0], sums[1], sums[2], sums[3], sums[4]};
    }
    s_.started = last[0] != 0, s_.old_dt = last[1], s_.sides_changed = last[2] != 0,
    s_.jumped = last[3] != 0;
  }

  FlowStep step(double dt, const Team& team = {}) {
    require(std::isfinite(dt) && dt > 0, "FlowSolver: a step of ", dt,
            " s must be finite and greater than 0");
    try {
      const FlowStep done = make_step(dt, team);
      before_put_in_.reset();
      return done;
    } catch (...) {
      if (before_put_in_) std::tie(s_.old_eps, s_.older_eps, s_.mass) = std::move(*before_put_in_);
      before_put_in_.reset();
      throw;
    }
  }

 private:
  FlowStep make_step(double dt, const Team& team) {
    const bool first = !s_.started;
    if (first) start(team);
    if (s_.jumped) s_.pressure.fill(s_.sides.outlet_pressure());
    FlowStep done;
    s_.find_turbulence(team);
    done.courant = s_.courant(dt, team);
    fluid_detail::refuse_unstable(s_, dt, done.courant);
    s_.take_voidage();
    s_.check_drag(), s_.check_heat();
    renew_inflows(dt);
    for (CellField* f : {&s_.drag, &s_.drag_v[0], &s_.drag_v[1], &s_.drag_v[2], &s_.force[0],
                         &s_.force[1], &s_.force[2]}) {
      if (s_.solids) s_.solids->fill_corners(*f);
      s_.sides.fill_cells(*f);
    }
    if (s_.response)
      s_.response->for_each([&](CellField& f) {
        if (s_.solids) s_.solids->fill_corners(f);
        s_.sides.fill_cells(f);
      });
    fluid_detail::push_by_heat(s_, team);
    s_.sides.fill_pressure(s_.pressure, false);
    fluid_detail::carry(s_, dt, team);
    fluid_detail::find_spread(s_, team);
    fluid_detail::stage(s_, s_.velocity, false, dt, s_.first, team);
    fluid_detail::stage(s_, s_.first, true, dt, s_.next, team);
    projection_->run(s_, dt, done, team);
    fluid_detail::carry_turbulence(s_, dt, team);
    fluid_detail::carry_heat(s_, dt, team);
    // For the next step, used by stable_step().
    s_.forget_eddies(), s_.find_turbulence(team);
    std::swap(s_.mass, s_.next_mass), std::swap(s_.older_eps, s_.old_eps);
    if (s_.response && s_.response->moves)
      fluid_detail::count_flow(s_, dt, team);
    else
      s_.old_eps = s_.eps;
    s_.old_dt = dt;
    s_.jumped = s_.sides_changed && fluid_detail::has_jumped(s_, team);
    if (s_.jumped) {
      s_.old_dt = 0;
      // The initial fluxes need not be those of any flow.
      if (first) s_.mass = s_.eps;
    }
    s_.sides_changed = false;
    return done;
  }
  /// Updates time-dependent inflows to the end of a step.
  void renew_inflows(double dt) {
    const double end = time() + dt;
    if (s_.sides.any_changes()) {
      s_.sides_changed = s_.sides.renew(end, dt) || s_.sides_changed;
      if (s_.turbulence) s_.turbulence->renew_inflow(s_.sides);
    }
    s_.sides.set_time(end);
  }
  template <class Model>
  void make_turbulent(const Model& model) {
    model.check();
    require(s_.fluid.viscosity > 0,
            "FlowSolver: turbulence at a wall needs FluidProperties.viscosity > 0");
    s_.turbulence.emplace(grid(), model);
  }
  const fluid_detail::TwoEquations& equations() const {
    require(s_.turbulence && s_.turbulence->two,
            "FlowSolver: the flow has no k and epsilon; set_turbulence(KEpsilon) first");
    return *s_.turbulence->two;
  }
  fluid_detail::TwoEquations& equations() {
    std::as_const(*this).equations(), s_.forget_eddies();
    return *s_.turbulence->two;
  }
  void check_turbulent() const {
    require(s_.turbulence.has_value(),
            "FlowSolver: the flow is not turbulent; set_turbulence first");
  }

  FlowState s_;
  std::optional<std::tuple<CellField, CellField, CellField>>
      before_put_in_;  // until the step is made
  int boundaries_ = 0;
  std::unique_ptr<fluid_detail::FlowProjection> projection_;  // no state between steps
};

static_assert(FlowOnGrid<FlowSolver>);

}  // namespace silt
