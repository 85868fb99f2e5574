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
#include <string>
#include <utility>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/cell_values.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/coupled_step.hpp>
#include <silt/coupling/held_cells.hpp>
#include <silt/coupling/left_particle.hpp>
#include <silt/coupling/mean_diameter.hpp>
#include <silt/coupling/particle_exchange.hpp>
#include <silt/coupling/step_choice.hpp>
#include <silt/fluid/concept.hpp>
#include <silt/fluid/flow_solver.hpp>
#include <silt/fluid/flow_vtk.hpp>

namespace silt::inline SILT_TARGET {

/// Two-way coupling of particles and a flow, unresolved or by two grids, a kernel or diffusion. The
/// fluid of a Simulation, or of a user's own time loop. CoupledFlow takes its policies in any order
/// (coupled_flow_policies.hpp) and derives from this type.
///
///   silt::FlowSolver flow(grid, air, {.model = silt::MomentumModel::A});
///   silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
///                        silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow}};
///
/// A fluid step:
///
///   weights at the particle positions -> eps = 1 - sum w V/V_cell                             (1)
///   u, eps at the particles -> K (drag law) and other forces -> c, o, q of StepResponse        (2)
///   fluid: sum w c, sum w o, sum w q, each over V_cell; FlowSolver::step                      (3)
///   particles: F = c u' - o + q (grad p' - div tau) - V (grad p' - div tau) - rho V g         (4)
///
/// with the same weights in all of them; in model B without grad p and tau, with K/eps. Forces: see
/// coupling/fluid_force.hpp. F is constant over the particle steps until the next fluid step. For
/// light particles, or drag that relaxes within the step, the velocities of particles after the
/// step are part of its continuity equation ((6) of FlowSolver); an explicit treatment is unstable
/// from (1 - eps)/eps rho/rho_p = 1 on. The last term of (4) adds buoyancy, as p excludes the
/// fluid's weight. No fluid force acts outside the grid. The coupling consists of an averaging mode
/// for the cells, a ParticleExchange for the particles, and a flow: FlowSolver, or any FlowOnGrid.
///
/// Heat, for a flow with heat: ParticleHeat.
/// Source: Z. Y. Zhou et al., J. Fluid Mech. 661 (2010) 482 (models); StepResponse.
/// Errors: those of FlowSolver and the averaging mode; InputError for spans of wrong length.
/// Tests:  tests/coupling/coupled_flow.cpp, simulation.cpp, light_particles.cpp,
///         impulsive_start.cpp.
/// Valid:  particles that the flow does not resolve; drag laws and modes: see their own blocks.
/// Units:  SI.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
class BasicCoupledFlow {
 public:
  using Exchange = ParticleExchange<Drag, Forces...>;
  static constexpr bool active = true;
  static constexpr bool turns = Exchange::turns, needs_spin = Exchange::needs_spin,
                        needs_rotation = Exchange::needs_rotation,
                        needs_strain = Exchange::needs_strain, needs_curl = Exchange::needs_curl,
                        sees_forms = Exchange::sees_forms, has_history = Exchange::has_history,
                        has_added_mass = Exchange::has_added_mass;
  /// Drag follows each particle's velocity between fluid steps.
  static constexpr bool follows = Exchange::follows;
  /// Takes CoupledParticles::heat, if the flow has heat.
  static constexpr bool has_heat = requires(Flow & f) { f.heat_exchange(); };

  BasicCoupledFlow(const Drag& drag, const Mode& mode, Flow flow, const Forces&... forces)
      : flow_(std::move(flow)),
        mode_(mode),
        exchange_(drag, forces...),
        solids_(flow_.grid()),
        cells_(flow_.grid()) {
    mode_.check();
    if constexpr (follows) exchange_.followed().check(flow_.grid().box());
    tell_settings();
    exchange_.check_fluid();
    if (in_pressure()) flow_.keep_stress();
  }

  /// The fastest fluid, of a flow that tells it.
  FastestFluid fastest(const Box&) const {
    if constexpr (requires { flow_.fastest(); })
      return {flow_.fastest(), flow_.fluid().density, flow_.fluid().viscosity,
              norm(flow_.grid().box().extent())};
    else
      return {};
  }
  Flow& flow() { return flow_; }
  const Flow& flow() const { return flow_; }
  double least_voidage = 0.3;      // [-] of a cell; the clipped volume is counted
  Vec3d gravity{0, 0, 0};          // [m/s2]; a Simulation sets its own
  std::optional<double> diameter;  // [m] unit of the mode's widths; left out: the largest

  /// @name In a Simulation
  /// @{
  /// Particle steps per fluid step. Left out: as many as keep the flow stable (at half its limit)
  /// and no particle crosses more than a fifth of a cell, at most `most_steps`; for light particles
  /// see HeldAnswer.
  std::optional<int> steps;
  int most_steps = 50;
  FluidClock clock;
  double time() const { return clock.time; }                // [s] time of the flow
  std::int64_t fluid_steps() const { return clock.steps; }  // [-] since the start
  const CoupledStep& last_step() const { return last_; }
  const FluidClosure& closure() const { return closure_; }
  /// @}

  /// Advances the flow by dt [s]; sets the force on each particle [N], and the torque [N m] if any
  /// of Forces has one.
  CoupledStep advance(const CoupledParticles& particles, double dt, std::span<Vec3d> force,
                      const Team& team = {}, std::span<Vec3d> torque = {}) {
    const std::size_t n = particles.velocity.size();
    tell_settings();
    if constexpr (requires { flow_.set_time(1.0, 1.0); })
      flow_.set_time(clock.time, clock.last_step);
    exchange_.check(particles, force.size(), torque.size());
    make_averaging(particles, team);
    CoupledStep done;
    if (!averaging_) {  // no particles yet
      done.flow = flow_.step(dt, team);
      return finish(done, dt);
    }
    spread_left(particles, team);
    if (clock.steps == 0) look_for_walls(particles);
    averaging_->place(particles.shape, team);
    done.averaging = averaging_->report();
    spread_volume(particles, done, team);
    find_cells(team);
    gather(n, team, true);
    find_mean_diameters(particles, team);
    exchange_.find(particles, dt, torque, team);
    spread_exchange(particles, dt, team);
    if (particles.heat) spread_heat(particles, dt, team);
    if constexpr (requires { flow_.put_in(solids_, least_voidage, team); })
      if (change_) flow_.put_in(*change_, least_voidage, team);
    done.flow = flow_.step(dt, team);
    if (particles.heat) take_heat(*particles.heat, dt, done, team);
    cells_.find_velocity(flow_, team);
    find_loads(team);
    gather(n, team, false);
    following_ = false;
    const Exchanged exchanged = exchange_.take(particles, dt, force);
    done.exchanged = exchanged.magnitudes, done.owed = exchanged.owed;
    done.momentum_error =
        exchanged.on_particles -
        cells_.exchanged(flow_, exchange_.bears() ? &flow_.response().borne : nullptr);
    return finish(done, dt);
  }

  /// A particle that has left since the last step: its place is given to the fluid in the next one.
  void take_away(const LeftParticle& left) {
    const Vec3d& x = left.position;
    const Quaternion& q = left.orientation;
    left_.insert(left_.end(), {x.x, x.y, x.z, left.radius, left.volume, q.w, q.x, q.y, q.z,
                               static_cast<double>(left.form)});
  }

  /// [-] at each particle of the last step; 0 outside the grid.
  std::span<const double> voidage_at_particles() const { return exchange_.at.voidage; }
  const HeldAnswer& held_answer() const { return exchange_.held_answer(); }  // of the last step
  /// Position of a particle for the fluid: its centre, or the point on the side if the centre is
  /// outside the grid by less than the radius, as in a contact with a wall at the side.
  Vec3d at_the_side(const Vec3d& centre, double radius) const;
  /// Whether a particle there, as at_the_side() gives it, is in the flow.
  bool reaches(const Vec3d& position) const;

  /// @name FluidCoupling (coupling/concept.hpp)
  /// @{
  void prepare(const FluidScene& scene) const;
  int steps_wanted(const FluidPace& pace, const Team& team) const;
  /// Refuses a given number of steps that is too large for light particles in contact.
  void check_step([[maybe_unused]] double span, [[maybe_unused]] const FluidPace& pace) const {
    if constexpr (!follows)
      if (steps)
        detail::check_held_step("CoupledFlow", *steps, held_answer(), span, pace,
                                has_added_mass ? "" : ", or add FollowedDrag");
  }
  template <class Visit>
  void for_each_state(const Visit& visit);
  void check_state(const std::string& name, std::span<const double> values) const;
  static constexpr const char* file_kind = ".vti";
  /// [m] adds pressure_with_weight to vtk_series; it equals the pressure at this point.
  std::optional<Vec3d> weight_from;
  void write(const std::string& path) const {
    std::optional<FluidWeight> weight;
    if (weight_from) weight = FluidWeight{gravity, *weight_from};
    write_flow(path, flow_, weight);
  }
  template <class Describer>
  void describe(const Describer& is) const;
  /// Sentences for what is probably a mistake: particles that start in walls of the flow, solid
  /// volume that the cells cannot take, properties that no fluid has. progress() and on_warnings()
  /// pass them on at the start and at the end of a run.
  DynArray<std::string> warnings() const;
  static constexpr bool warns_at_start = true;
  /// @}

  /// @name FollowingFluid, with FollowedDrag
  /// @{
  const FollowStart& start_of(std::size_t p) const requires follows {
    return exchange_.start_of(p);
  }
  /// [N s] that particles which have left the fluid had taken beyond what it had given them.
  Vec3d lost() const { return exchange_.lost; }
  void lose(const Vec3d& impulse) { exchange_.lost += impulse; }
  /// Updates the values of cells, if used, after a fluid step or a restart.
  void prepare_to_follow(const Team& team) requires follows {
    tell_settings();
    const double cell = exchange_.followed().cell;
    if (following_ || !(cell > 0)) return;
    cells_.find_velocity(flow_, team);
    find_loads(team);
    for (auto* fields : {&cells_.velocity, &cells_.slope, &cells_.stress})
      for (CellField& f : *fields) join(f);
    held_.make(flow_.grid(), cell);
    held_.renew(flow_.grid(), cells_, in_pressure(), team);
    following_ = true;
  }
  /// Force [N] on a particle at x [m], with velocity v [m/s], over its next dt [s].
  template <class Row>
  Vec3d follow(const FollowedRow<Row>& row, const Vec3d& x, const Vec3d& v, double mass,
               const Vec3d& contacts, double dt) const requires follows {
    Vec3d u = row.flow.vector(), read{0, 0, 0};
    if (exchange_.followed().cell > 0) {
      const double d = row.given.fourth;
      const detail::HeldValues& here = held_.at(x);
      u = here.velocity, read = (std::numbers::pi / 6 * d * d * d) * here.push;
    }
    return exchange_.follow(row, u, read, v, mass, contacts, dt);
  }
  /// @}

 private:
  using CellValues = detail::CellValues;
  bool in_pressure() const { return exchange_.in_pressure(); }
  void tell_settings() {
    exchange_.settings = {flow_.fluid(), flow_.options().model, gravity, least_voidage};
  }
  double longest_step(double speed, const Team& team) const;
  void look_for_walls(const CoupledParticles& of);
  void make_averaging(const CoupledParticles& of, const Team& team);
  void spread_left(const CoupledParticles& present, const Team& team);
  void find_change(CellField& more, const Team& team) const;
  void spread_volume(const CoupledParticles& of, CoupledStep& done, const Team& team);
  void find_mean_diameters(const CoupledParticles& of, const Team& team) {
    if constexpr (Exchange::needs_mean_diameter) {
      CellField sum(flow_.grid());
      detail::find_mean_diameters(of, exchange_.at.mean_diameter,
                                  [&](std::span<const double> from, std::span<double> to) {
                                    CellField* const cells[] = {&sum};
                                    averaging_->spread(Quantities(&from, 1), cells, team);
                                    if (const auto* joined = flow_.joined_cells())
                                      joined->spread(sum);
                                    join(sum);
                                    const CellField* const seen[] = {&sum};
                                    averaging_->gather(seen, GatheredValues(&to, 1), team);
                                  });
    }
  }
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
  /// Cell values at the particles: all, or those changed by a flow step.
  void gather(std::size_t n, const Team& team, bool all);
  void spread_exchange(const CoupledParticles& of, double dt, const Team& team);
  void share_out(CellFields fields, const Team& team);
  void spread_heat(const CoupledParticles& of, double dt, const Team& team);
  void take_heat(const ParticleHeat& heat, double dt, CoupledStep& done, const Team& team);
  CoupledStep finish(const CoupledStep& done, double dt) {
    clock.count(dt), last_ = done, closure_.add(done), left_.clear();
    return done;
  }

  Flow flow_;
  Mode mode_;
  Exchange exchange_;
  std::optional<typename Mode::Averaging> averaging_;
  /// For heat, with modes that smooth: grains and fluid that are mixed over a kernel's width would
  /// conduct heat through the bed.
  static constexpr bool heats_apart = has_heat && !std::is_same_v<Mode, Unresolved>;
  std::conditional_t<heats_apart, std::optional<Kernel::Averaging>, std::monostate> heats_;
  auto& averaging_of_heat() {
    if constexpr (heats_apart)
      return *heats_;
    else
      return *averaging_;
  }
  int opened_ = 0;                            // number of the flow's boundaries at the last opening
  int opened_for_heat_ = 0;                   // the same of heats_
  CellField solids_;                          // [m3]
  static constexpr std::size_t of_left = 10;  // numbers of a LeftParticle
  DynArray<double> left_;                     // since the last step, of_left each
  std::optional<CellField> emptied_;          // [m3] their volume in the present step
  std::optional<CellField> change_;           // [m3] of solids, for FlowSolver::put_in
  CellValues cells_;
  detail::HeldCells held_;
  bool following_ = false;                  // held_ is of the present flow
  ParticleColumn conducts_, gives_, seen_;  // [W/K] b, [W] b T, [K] of ParticleHeat
  CoupledStep last_;
  FluidClosure closure_;
  struct {
    std::size_t count = 0, all = 0;
    double distance = 0;  // [m] of the deepest
    Vec3d place{0, 0, 0};
  } in_walls_;  // particles at the start
};

}  // namespace silt

#include <silt/coupling/coupled_flow_heat.hpp>
#include <silt/coupling/coupled_flow_in_simulation.hpp>
#include <silt/coupling/coupled_flow_parts.hpp>
#include <silt/coupling/coupled_flow_policies.hpp>
