// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/cell_values.hpp>
#include <silt/coupling/drag/concept.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/fluid_force.hpp>
#include <silt/coupling/fluid_needs.hpp>
#include <silt/coupling/followed_drag.hpp>
#include <silt/coupling/momentum_exchange.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/coupling/step_response.hpp>
#include <silt/fluid/flow_vtk.hpp>

namespace silt::inline SILT_TARGET {

/// What CoupledFlow is, of policies in this order; CoupledFlow itself takes them in any
/// (coupled_flow_policies.hpp). Particles and a flow, each of which feels the other, unresolved or
/// by two grids, a kernel or diffusion: the fluid of a Simulation, or of a loop of one's own.
///
///   silt::FlowSolver flow(grid, air, {.model = silt::MomentumModel::A});
///   silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
///                        silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow}};
///
/// A fluid step:
///
///   weights of the particles' places -> eps = 1 - sum w V/V_cell                              (1)
///   u, eps at the particles -> K (drag law) and other forces -> c, o, q of StepResponse        (2)
///   fluid: sum w c, sum w o, sum w q, each over V_cell; FlowSolver::step                      (3)
///   particles: F = c u' - o + q (grad p' - div tau) - V (grad p' - div tau) - rho V g         (4)
///
/// with the same weights in all of them; in model B without grad p and tau, with K/eps. Forces: see
/// coupling/fluid_force.hpp. F is held over the particles' own steps until the next one. Where
/// particles are light, or drag dies within the step, their velocities after it are part of the
/// step's continuity ((6) of FlowSolver), as explicitly no step is stable from
/// (1 - eps)/eps rho/rho_p = 1 on. The last term is there as p is without the fluid's weight.
/// Particles beyond the grid feel no fluid.
///
/// Source: Z. Y. Zhou et al., J. Fluid Mech. 661 (2010) 482 (models); StepResponse.
/// Errors: those of FlowSolver and the averaging mode; InputError for spans that do not fit.
/// Tests:  tests/coupling/coupled_flow.cpp, simulation.cpp, light_particles.cpp,
///         impulsive_start.cpp.
template <class Drag, class Mode, class... Forces>
class BasicCoupledFlow {
  template <class F>
  static constexpr bool wants_curl = requires {
    requires F::needs_curl;
  };
  template <class F>
  static constexpr bool adds_mass = requires(const F& f, const InFluid& p) {
    f.added_mass(p);
  };
  template <class F>
  static constexpr bool pushes = requires(const F& f, const InFluid& p) {
    f.force_on(p);
  };
  template <class F>
  static constexpr bool turns_particles = requires(const F& f, const InFluid& p) {
    f.torque_on(p);
  };

 public:
  static constexpr bool active = true;
  static constexpr bool turns = (false || ... || turns_particles<Forces>);
  static constexpr bool needs_strain = (false || ... || detail::wants_strain<Forces>);
  static constexpr bool needs_curl = needs_strain || (false || ... || wants_curl<Forces>);
  static constexpr bool sees_forms =
      detail::wants_forms<Drag> || (false || ... || detail::wants_forms<Forces>);
  static constexpr bool has_history = (false || ... || detail::remembers<Forces>);
  static constexpr bool has_added_mass = (false || ... || adds_mass<Forces>);
  /// Drag follows each particle's velocity between fluid steps.
  static constexpr bool follows = (false || ... || std::is_same_v<Forces, FollowedDrag>);
  template <class Force>
  static constexpr int times_given = (0 + ... + std::is_same_v<Forces, Force>);
  static_assert(((times_given<Forces> == 1) && ...), "CoupledFlow: give each force once");
  static_assert(!(follows && has_added_mass),
                "FollowedDrag does not know a virtual mass: leave one of them out");
  static_assert(OrientedDragLaw<Drag> || detail::drag_fits_lanes<Drag>(),
                "the drag law works on double and float, but not on a pack of lanes: make "
                "normalised(eps, Re) a template of Real, as silt/coupling/drag/concept.hpp says");
  static_assert(
      !(follows && OrientedDragLaw<Drag>),
      "FollowedDrag does not know how bodies lie: take a drag law of spheres, or leave it "
      "out");

  BasicCoupledFlow(const Drag& drag, const Mode& mode, FlowSolver flow, const Forces&... forces)
      : flow_(std::move(flow)),
        drag_(drag),
        mode_(mode),
        forces_(forces...),
        solids_(flow_.grid()),
        cells_(flow_.grid()) {
    mode_.check();
    if constexpr (follows) held_drag().check(flow_.grid());
    if (in_pressure()) flow_.keep_stress();
  }

  FlowSolver& flow() { return flow_; }
  const FlowSolver& flow() const { return flow_; }
  double least_voidage = 0.3;      // [-] of a cell; what it leaves out is counted
  Vec3d gravity{0, 0, 0};          // [m/s2]; a Simulation sets its own
  std::optional<double> diameter;  // [m] in which the mode's widths are; left out: the largest

  /// @name In a Simulation
  /// @{
  /// Particle steps a fluid step; left out: as many as keep the flow stable (at half its limit) and
  /// no particle crosses a fifth of a cell in, at most `most_steps`; of light ones, see HeldAnswer.
  std::optional<int> steps;
  int most_steps = 50;
  double time() const { return time_; }                // [s] up to which the flow is known
  std::int64_t fluid_steps() const { return count_; }  // [-] since the start
  const CoupledStep& last_step() const { return last_; }
  const FluidClosure& closure() const { return closure_; }
  /// @}

  /// Advances the flow by dt [s]; gives the force on each particle [N], and the torque [N m] if any
  /// of Forces has one.
  CoupledStep advance(const CoupledParticles& particles, double dt, std::span<Vec3d> force,
                      const Team& team = {}, std::span<Vec3d> torque = {}) {
    const std::size_t n = particles.velocity.size();
    check(particles, force.size(), torque.size());
    make_averaging(particles, team);
    CoupledStep done;
    if (!averaging_) {  // there has been no particle yet
      done.flow = flow_.step(dt, team);
      return finish(done, dt);
    }
    averaging_->place(particles.shape, team);
    done.averaging = averaging_->report();
    spread_volume(particles, done, team);
    find_cells(team);
    gather(n, team, true);
    remember(particles, dt, team);
    find_exchange(particles, dt, torque, team);
    spread_exchange(particles, n, dt, team);
    done.flow = flow_.step(dt, team);
    cells_.find_velocity(flow_, team);
    find_loads(team);
    gather(n, team, false);
    following_ = false;
    if constexpr (follows) start_.assign(n, {});
    Vec3d on_particles{0, 0, 0};
    for (std::size_t p = 0; p < n; ++p) {
      if (is_outside(p)) {
        force[p] = {0, 0, 0};
        continue;
      }
      const Vec3d slope = in_pressure() ? value(slope_at, p) - value(stress_at, p) : Vec3d{0, 0, 0};
      const Vec3d exchanged = response_[p].force(value(u_at, p), slope);
      on_particles += exchanged, done.exchanged += norm(exchanged);
      force[p] = exchanged + static_force(particles.volume[p], p);
      if constexpr (follows) start_following(particles, p, exchanged, dt, done, on_particles);
    }
    done.momentum_error =
        on_particles - cells_.exchanged(flow_, bears() ? &flow_.response().borne : nullptr);
    return finish(done, dt);
  }

  /// @name With FollowedDrag, in a Simulation
  /// @{
  /// What particle p feels until the next fluid step: the fluid's velocity [m/s] and voidage [-],
  /// 0: no fluid; drag [N] that the fluid has given; all other force [N], but for pressure and
  /// stress if those are read from cells.
  struct Start {
    Vec3d velocity{0, 0, 0}, drag{0, 0, 0}, push{0, 0, 0};
    double voidage = 0;
  };
  const Start& start_of(std::size_t p) const requires follows { return start_[p]; }
  /// [N s] that particles which have left the fluid had taken beyond what it had given them.
  Vec3d lost() const { return lost_; }
  void lose(const Vec3d& impulse) { lost_ += impulse; }
  /// Renews the values of cells, if there are such, after a fluid step or a restart.
  void prepare_to_follow(const Team& team) requires follows {
    if (following_ || !(held_drag().cell > 0)) return;
    cells_.find_velocity(flow_, team);
    find_loads(team);
    for (auto* fields : {&cells_.velocity, &cells_.slope, &cells_.stress})
      for (CellField& f : *fields) join(f);
    held_.make(flow_.grid(), held_drag().cell);
    held_.renew(flow_.grid(), cells_, in_pressure(), team);
    following_ = true;
  }
  /// The force [N] on the particle of row k, at x [m], with velocity v [m/s], over its next dt [s].
  template <class Loads>
  Vec3d follow(Loads& loads, std::size_t k, const Vec3d& x, const Vec3d& v, double mass,
               const Vec3d& contacts, double dt) const requires follows {
    const auto& how = held_drag();
    auto &held = loads.held[k], &reference = loads.reference[k];
    const Vec3d push = held.vector();
    Vec3d u = loads.flow[k].vector(), read{0, 0, 0};
    if (how.cell > 0) {
      const double d = loads.given[k].fourth;
      const detail::HeldValues& here = held_.at(x);
      u = here.velocity, read = (std::numbers::pi / 6 * d * d * d) * here.push;
    }
    const Vec3d slip = u - v, change = slip - reference.vector();
    const double tolerance2 = how.tolerance * how.tolerance;
    if (!(dot(change, change) <= tolerance2 * dot(reference.vector(), reference.vector()))) {
      reference = {slip.x, slip.y, slip.z, loads.flow[k].fourth};
      held.fourth = coefficient(loads.flow[k].fourth, norm(slip), loads.given[k].fourth);
    }
    const Vec3d a = (1 / mass) * (contacts + push + read) + gravity;
    const Vec3d exchanged = momentum_exchange(mass, held.fourth, dt, a).force(u, v) + read;
    auto& taken = loads.taken[k];
    taken.x += dt * exchanged.x, taken.y += dt * exchanged.y, taken.z += dt * exchanged.z;
    return exchanged + push;
  }
  /// @}

  /// [-] at each particle of the last step; 0 beyond the grid.
  std::span<const double> voidage_at_particles() const { return values_[eps_at]; }
  /// The longest fluid step [s] for particles of that speed [m/s]; see `steps`.
  double longest_step(double speed, const Team& team) const {
    const Vec3d h = flow_.grid().h();
    const double stable = flow_.stable_step(team), least = std::min({h.x, h.y, h.z});
    return speed > 0 ? std::min(stable, 0.2 * least / speed) : stable;
  }
  const HeldAnswer& held_answer() const { return held_answer_; }  // of the last step
  /// The state, part by part, for a checkpoint: visit(name, span of doubles).
  template <class Visit>
  void for_each_state(const Visit& visit) {
    flow_.for_each_state(visit);
    const auto counted = static_cast<double>(count_);
    std::array<double, 8> clock{time_,   counted, last_dt_, diameter.value_or(0),
                                lost_.x, lost_.y, lost_.z,  held_answer_.in_contact};
    visit("fluid.clock", std::span<double>(clock));
    time_ = clock[0], count_ = static_cast<std::int64_t>(clock[1]), last_dt_ = clock[2];
    if (clock[3] > 0) diameter = clock[3];
    lost_ = {clock[4], clock[5], clock[6]}, held_answer_.in_contact = clock[7], following_ = false;
    if constexpr (has_history) detail::visit_histories(forces_, visit);
  }
  /// Where a particle is for the fluid: its centre, or, if that has left the grid by less than its
  /// radius, as a contact with a wall at the side lets it, the place at the side.
  Vec3d at_the_side(const Vec3d& centre, double radius) const {
    const Grid& g = flow_.grid();
    const auto inside = [&](double x, double low, double high, int d) {
      if (g.periodic(d) || x < low - radius || x > high + radius) return x;
      const double margin = 1e-9 * (high - low);
      return std::clamp(x, low + margin, high - margin);
    };
    const Vec3d &a = g.box().min, &b = g.box().max;
    return {inside(centre.x, a.x, b.x, 0), inside(centre.y, a.y, b.y, 1),
            inside(centre.z, a.z, b.z, 2)};
  }
  void start_at(double time) { time_ = time; }
  double last_step_length() const { return last_dt_; }  // [s] 0: none yet
  using Particles = detail::ParticlesInFluid;

 private:
  static constexpr std::size_t u_at = 0, eps_at = 3, slope_at = 4, stress_at = 7, curl_at = 10,
                               convection_at = 13, b_at = 16, strain_at = 17, borne_at = 23,
                               with_fluid_at = 24, with_pressure_at = 25, flux_at = 26,
                               quantities = 29;
  /// Where the particles' answer to a step's pressure and velocity is less than this share of what
  /// asks for it, continuity may know of it a step late.
  static constexpr double most_lagged_gain = 0.1;  // [-]
  /// Where q of (4) is less than this share of a particle's volume, it goes with the pressure of
  /// the step before: a sum less to spread over cells, for grains in gas.
  static constexpr double most_lagged_share = 0.02;  // [-]
  static constexpr double stiff_drag = 0.2;          // [-] of a step over the relaxation time
  const FollowedDrag& held_drag() const requires follows { return std::get<FollowedDrag>(forces_); }
  bool in_pressure() const { return flow_.options().model == MomentumModel::A; }
  Vec3d value(std::size_t column, std::size_t p) const {
    return {values_[column][p], values_[column + 1][p], values_[column + 2][p]};
  }
  /// Of no cell: there is no fluid.
  bool is_outside(std::size_t p) const { return values_[eps_at][p] == 0; }
  /// Of pressure, viscous stress and the fluid's weight [N].
  Vec3d static_force(double volume, std::size_t p) const {
    Vec3d push = -flow_.fluid().density * gravity;
    if (in_pressure()) push += value(stress_at, p) - value(slope_at, p);
    return volume * push;
  }

  void check(const CoupledParticles& of, std::size_t forces, std::size_t torques) const;

  void make_averaging(const CoupledParticles& of, const Team& team);
  void spread_volume(const CoupledParticles& of, CoupledStep& done, const Team& team);
  void find_loads(const Team& team) {
    if (in_pressure()) cells_.find_slope(flow_, team), cells_.find_stress(flow_, team);
  }
  void find_cells(const Team& team) {
    cells_.find_velocity(flow_, team);
    find_loads(team);
    if constexpr (needs_curl) cells_.find_curl(flow_, team);
    if constexpr (needs_strain) cells_.find_strain(flow_, team);
    if constexpr (has_added_mass) cells_.find_convection(flow_, team);
  }
  void join(CellField& values) const {
    if (const auto* joined = flow_.joined_cells()) joined->average(values);
  }
  /// Cell values at the particles: all, or those that a flow step has changed.
  void gather(std::size_t n, const Team& team, bool all);
  /// Forces with a history learn of the slips of now.
  void remember(const CoupledParticles& of, double dt, const Team& team);
  void find_exchange(const CoupledParticles& of, double dt, std::span<Vec3d> torque,
                     const Team& team);
  bool is_pushed(const CoupledParticles& of, std::size_t p, double dt) const;
  InFluid particle(const CoupledParticles& of, std::size_t p, double dt) const;
  /// [kg/s] of drag.
  double coefficient(double voidage, double slip, double d) const {
    const auto& fluid = flow_.fluid();
    const double Re = slip_reynolds(voidage, fluid.density, slip, d, fluid.viscosity);
    const double K = drag_coefficient(drag_, voidage, Re, d, fluid.viscosity);
    return flow_.options().model == MomentumModel::B ? model_b(K, voidage) : K;
  }
  CoupledStep finish(const CoupledStep& done, double dt) {
    time_ += dt, ++count_, last_dt_ = dt, last_ = done, closure_.add(done);
    return done;
  }
  double coefficient([[maybe_unused]] const CoupledParticles& of, const InFluid& at,
                     [[maybe_unused]] std::size_t p) const {
    if constexpr (follows)
      if (!of.drag.empty()) {
        HeldDrag& held = of.drag[p];
        const double tolerance = held_drag().tolerance;
        if (norm(at.slip - held.slip) <= tolerance * norm(held.slip) &&
            std::abs(at.voidage - held.voidage) <= tolerance)
          return held.coefficient;
        held = {coefficient(at.voidage, norm(at.slip), at.diameter), at.slip, at.voidage};
        return held.coefficient;
      }
    return coefficient(at, norm(at.slip));
  }
  double coefficient(const InFluid& at, double slip) const {
    const double Re = slip_reynolds(at.voidage, at.density, slip, at.diameter, at.viscosity);
    const double K = detail::drag_on(drag_, at, Re);
    return flow_.options().model == MomentumModel::B ? model_b(K, at.voidage) : K;
  }
  /// After the fluid's step, in which it gave `exchanged` [N] to particle p.
  void start_following(const CoupledParticles& of, std::size_t p, const Vec3d& exchanged, double dt,
                       CoupledStep& done, Vec3d& on_particles) requires follows {
    const double V = of.volume[p];
    const Vec3d others = others_[p];  // lift, and so on
    const bool alone = flow_.options().model == MomentumModel::Simplified;
    const Vec3d weight = -V * flow_.fluid().density * gravity, all = static_force(V, p);
    const bool from_cells = held_drag().cell > 0;  // then pressure is part of what is exchanged
    start_[p] = {value(u_at, p), exchanged - others + (from_cells ? all - weight : Vec3d{0, 0, 0}),
                 others + (from_cells ? weight : all),
                 alone ? 1 : std::clamp(values_[eps_at][p], least_voidage, 1.0)};
    if (of.owed.empty()) return;
    done.owed += of.owed[p], on_particles += (1 / dt) * of.owed[p];
    done.exchanged += norm(of.owed[p]) / dt;
  }
  StepResponse response_of(const CoupledParticles& of, const InFluid& at, std::size_t p);
  /// By how much the fluid's velocity changes in a step for a change of the particles' in the one
  /// before, if continuity knows of that a step late [-].
  double gain_of(const InFluid& at, const StepResponse& r) const {
    return (1 - at.voidage) / at.voidage * (r.with_fluid + at.density / at.dt * r.with_pressure);
  }
  bool moves() { return flow_.responds() && flow_.response().moves; }
  bool bears() { return flow_.responds() && flow_.response().bears; }
  Vec3d torque_on(const InFluid& at) const {
    Vec3d sum{0, 0, 0};
    const auto ask = [&](const auto& force) {
      if constexpr (turns_particles<std::decay_t<decltype(force)>>) sum += force.torque_on(at);
    };
    std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
    return sum;
  }
  void spread_exchange(const CoupledParticles& of, std::size_t n, double dt, const Team& team);
  using CellValues = detail::CellValues;
  FlowSolver flow_;
  Drag drag_;
  Mode mode_;
  std::tuple<Forces...> forces_;
  std::optional<typename Mode::Averaging> averaging_;
  int opened_ = 0;  // which of the flow's boundaries it knows
  CellField solids_;    // [m3]
  CellValues cells_;
  std::array<std::vector<double>, quantities> values_;  // of each particle, by column
  std::vector<StepResponse> response_;
  std::vector<Vec3d> slips_;   // [m/s] of forces with a history
  std::vector<Vec3d> others_;  // [N] of Forces, with FollowedDrag
  std::vector<Start> start_;
  detail::HeldCells held_;
  bool following_ = false;         // held_ is of the present flow
  Vec3d lost_{0, 0, 0};            // [N s]
  double time_ = 0, last_dt_ = 0;  // [s]
  std::int64_t count_ = 0;
  HeldAnswer held_answer_;
  CoupledStep last_;
  FluidClosure closure_;
};

}  // namespace silt

#include <silt/coupling/coupled_flow_parts.hpp>
#include <silt/coupling/coupled_flow_policies.hpp>
