// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/drag/concept.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/fluid_at_particles.hpp>
#include <silt/coupling/fluid_force.hpp>
#include <silt/coupling/fluid_needs.hpp>
#include <silt/coupling/followed_drag.hpp>
#include <silt/coupling/momentum_exchange.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/coupling/step_response.hpp>

namespace silt::inline SILT_TARGET {

/// Exchange of particles with a fluid in one fluid step. It uses only the fluid at the particles'
/// positions, and no mesh: the common part of CoupledFlow, CoupledMesh and PrescribedFlow.
///
///   exchange.settings = {...};                     density, viscosity, momentum model, gravity
///   ... exchange.at.velocity[d][p] = ...           the fluid at particle p, at the step's start
///   exchange.find(particles, dt, torque, team);    K, forces -> c, o, q of StepResponse      (1)
///   exchange.give(particles, dt, true);            -> exchange.given, to distribute over cells (2)
///   ... the fluid's step; exchange.at.velocity, slope, stress: at its end
///   exchange.take(particles, dt, force);           F = c u' - o + q grad p' - V grad p' ...   (3)
///
/// If the weights of (2) and of the velocities in (3) are adjoint, the force on the fluid is
/// opposite to that on the particles, to rounding. Forces: coupling/fluid_force.hpp.
///
/// Source: Z. Y. Zhou et al., J. Fluid Mech. 661 (2010) 482 (models); StepResponse.
/// Units:  SI. A particle whose void fraction is 0 is outside the fluid; no force acts on it.
/// Errors: InputError for spans of wrong length and a viscosity of 0; forces and drag laws that
/// cannot be combined do
///         not compile.
/// Tests:  tests/coupling/particle_exchange.cpp.
template <class Drag, class... Forces>
class ParticleExchange {
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
  static constexpr bool turns = (false || ... || turns_particles<Forces>);
  static constexpr bool needs_strain = (false || ... || detail::wants_strain<Forces>);
  static constexpr bool needs_curl = needs_strain || (false || ... || wants_curl<Forces>);
  static constexpr bool sees_forms =
      detail::wants_forms<Drag> || (false || ... || detail::wants_forms<Forces>);
  static constexpr bool needs_mean_diameter =
      detail::wants_mean_diameter<Drag> || (false || ... || detail::wants_mean_diameter<Forces>);
  /// Particles are given with their angular velocities.
  static constexpr bool needs_spin =
      turns || detail::drag_reads_spin<Drag> || (false || ... || detail::reads_spin<Forces>);
  static constexpr bool needs_rotation = (false || ... || detail::wants_rotation<Forces>);
  static constexpr bool has_history = (false || ... || detail::remembers<Forces>);
  static constexpr bool has_added_mass = (false || ... || adds_mass<Forces>);
  /// Drag follows each particle's velocity between fluid steps.
  static constexpr bool follows = (false || ... || std::is_same_v<Forces, FollowedDrag>);
  template <class Force>
  static constexpr int times_given = (0 + ... + std::is_same_v<Forces, Force>);
  static_assert(((times_given<Forces> == 1) && ...), "CoupledFlow: give each force once");
  static_assert(!(follows && has_added_mass),
                "FollowedDrag does not support a virtual mass: leave out one of them");
  static_assert(OrientedDragLaw<Drag> || detail::drag_fits_lanes<Drag>(),
                "the drag law compiles for double and float, but not for a pack of lanes: make "
                "normalised(eps, Re) a template of Real, as silt/coupling/drag/concept.hpp says");
  static_assert(
      !(follows && OrientedDragLaw<Drag>),
      "FollowedDrag supports neither oriented bodies nor Polydisperse: use a drag law of spheres, "
      "or leave it out");

  explicit ParticleExchange(const Drag& drag, const Forces&... forces)
      : drag_(drag), forces_(forces...) {
    if constexpr (requires { drag.check(); }) drag.check();
  }

  ExchangeSettings settings;
  FluidAtParticles at;  // to be set before find(), and again before take()
  GivenToFluid given;   // of give()

  /// Refuses a fluid without viscosity for a drag law that needs a Reynolds number.
  void check_fluid() const;
  /// Refuses spans of wrong length. `forces`, `torques`: their lengths.
  void check(const CoupledParticles& of, std::size_t forces, std::size_t torques) const;

  /// (1): response of each particle to the step; and the torques, if `torques` is not empty.
  void find(const CoupledParticles& of, double dt, std::span<Vec3d> torque, const Team& team);
  /// Whether particles respond so strongly to the flow of the coming step that its continuity
  /// equation must include them: an explicit step would be unstable.
  bool moves() const { return moves_; }
  /// [-] Change of the fluid's velocity per change of the particles' in the previous step, largest
  /// of any particle, if give() is not implicit: from 1 on every step is unstable.
  double gain() const { return gain_; }
  /// Whether the pressure of the coming step that particles leave to the fluid is important.
  bool bears() const { return bears_; }
  /// (2). `implicit`: the fluid's step uses moves() and bears(); otherwise the particles' part of
  /// the pressure is that of the step's start.
  void give(const CoupledParticles& of, double dt, bool implicit);
  /// (3), with `at` at the end of the step.
  Exchanged take(const CoupledParticles& of, double dt, std::span<Vec3d> force);

  /// Largest of any particle in the last step.
  const HeldAnswer& held_answer() const { return held_answer_; }
  void restore_held(double in_contact) { held_answer_.in_contact = in_contact; }
  /// Velocity of a particle at the end of the step, if no other force acts: (3) of StepResponse.
  const StepResponse& response(std::size_t p) const { return response_[p]; }
  /// Outside the fluid.
  bool is_outside(std::size_t p) const { return at.voidage[p] == 0; }
  bool in_pressure() const { return settings.model == MomentumModel::A; }

  /// @name With FollowedDrag
  /// @{
  const FollowedDrag& followed() const requires follows { return std::get<FollowedDrag>(forces_); }
  const FollowStart& start_of(std::size_t p) const requires follows { return start_[p]; }
  /// [N s] that particles which have left the fluid had taken beyond what it had given them.
  Vec3d lost{0, 0, 0};
  /// Force [N] on the particle of `row` with velocity v [m/s] over its next dt [s], in a fluid of
  /// velocity u [m/s] with the additional force `read` [N].
  template <class Row>
  Vec3d follow(const FollowedRow<Row>& row, const Vec3d& u, const Vec3d& read, const Vec3d& v,
               double mass, const Vec3d& contacts, double dt) const;
  /// @}

  /// State of forces with a history, for a checkpoint.
  template <class Visit>
  void for_each_state(const Visit& visit) {
    if constexpr (has_history) detail::visit_histories(forces_, visit);
  }

 private:
  /// If the particles' response to a step's pressure and velocity is below this share of its cause,
  /// continuity may include it one step later.
  static constexpr double most_lagged_gain = 0.1;  // [-]
  /// If q of (3) is below this share of a particle's volume, the pressure of the previous step is
  /// used: this saves a sum over cells for particles in gas.
  static constexpr double most_lagged_share = 0.02;  // [-]
  static constexpr double stiff_drag = 0.2;          // [-] of a step over the relaxation time

  /// grad p - div tau [Pa/m] at particle p.
  Vec3d slope(std::size_t p) const {
    return in_pressure() ? vector_of(at.slope, p) - vector_of(at.stress, p) : Vec3d{0, 0, 0};
  }
  /// Force of pressure, viscous stress and the fluid's weight [N].
  Vec3d static_force(double volume, std::size_t p) const {
    Vec3d push = -settings.fluid.density * settings.gravity;
    if (in_pressure()) push += vector_of(at.stress, p) - vector_of(at.slope, p);
    return volume * push;
  }
  double voidage(std::size_t p) const {
    const bool alone = settings.model == MomentumModel::Simplified;
    return alone ? 1 : std::clamp(at.voidage[p], settings.least_voidage, 1.0);
  }
  void remember(const CoupledParticles& of, double dt, const Team& team);
  InFluid particle(const CoupledParticles& of, std::size_t p, double dt) const;
  StepResponse response_of(const CoupledParticles& of, const InFluid& here, std::size_t p);
  bool is_pushed(const CoupledParticles& of, std::size_t p, double dt) const;
  /// Drag [kg/s].
  double coefficient(double eps, double slip, double d) const;
  double coefficient(const CoupledParticles& of, const InFluid& here, std::size_t p) const;
  double coefficient(const InFluid& here, double slip) const;
  double gain_of(const InFluid& here, const StepResponse& r) const {
    return (1 - here.voidage) / here.voidage *
           (r.with_fluid + here.density / here.dt * r.with_pressure);
  }
  Vec3d torque_on(const InFluid& here) const {
    Vec3d sum{0, 0, 0};
    const auto ask = [&](const auto& force) {
      if constexpr (turns_particles<std::decay_t<decltype(force)>>) sum += force.torque_on(here);
    };
    std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
    return sum;
  }
  void start_following(const CoupledParticles& of, std::size_t p, const Vec3d& exchanged, double dt,
                       Exchanged& done);

  Drag drag_;
  std::tuple<Forces...> forces_;
  DynArray<StepResponse> response_;
  DynArray<Vec3d> slips_;   // [m/s] of forces with a history
  DynArray<Vec3d> others_;  // [N] of Forces, with FollowedDrag
  DynArray<FollowStart> start_;
  HeldAnswer held_answer_;
  double gain_ = 0;  // [-]
  bool moves_ = false, bears_ = false;
};

}  // namespace silt

#include <silt/coupling/particle_exchange_parts.hpp>
