// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <silt/boundary/deforming_box.hpp>
#include <silt/boundary/domain.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/coupling/heat_exchange.hpp>
#include <silt/coupling/no_fluid.hpp>
#include <silt/engine/checks/contact_rates.hpp>
#include <silt/engine/checks/guard.hpp>
#include <silt/engine/checks/time_step.hpp>
#include <silt/engine/contact/ask_on_lanes.hpp>
#include <silt/engine/engine.hpp>
#include <silt/engine/population/arrivals.hpp>
#include <silt/engine/population/openings.hpp>
#include <silt/engine/stages/bond_stage.hpp>
#include <silt/engine/stages/module_stage.hpp>
#include <silt/fill/particles.hpp>
#include <silt/search/verlet_list.hpp>
#include <silt/simulation/body_readings.hpp>
#include <silt/simulation/bond_access.hpp>
#include <silt/simulation/break_access.hpp>
#include <silt/simulation/contact_access.hpp>
#include <silt/simulation/energy_ledger.hpp>
#include <silt/simulation/fluid_access.hpp>
#include <silt/simulation/module_access.hpp>
#include <silt/simulation/name_access.hpp>
#include <silt/simulation/observing.hpp>
#include <silt/simulation/opening_access.hpp>
#include <silt/simulation/particle_edits.hpp>
#include <silt/simulation/particle_readings.hpp>
#include <silt/simulation/rank_access.hpp>
#include <silt/simulation/ranks_scene.hpp>
#include <silt/simulation/wall_access.hpp>

namespace silt::inline SILT_TARGET {

/// A particle simulation, composed of one policy per axis, in any order:
///
///   silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
// clang-format off
///   axis        policy                                          default
///   particles   Particles<Shape>                                required
///   contact     Contacts<Law, Options...>                       required
///   search      VerletList<Finder>, or a finder itself          VerletList<HashedGrid>, automatic skin
///   domain      OpenDomain, PeriodicBox, DeformingBox           OpenDomain
///   fluid       CoupledFlow, CoupledMesh, PrescribedFlow, ...   NoFluid
///   precision   Double, Mixed                                   Double
///   kernels     KernelsFor<Arch>                                what the compile flags allow
///   integrator  Leapfrog, SymplecticEuler, Gear                 Leapfrog
///   rotation    NoSquish, Spiral: for bodies                    NoSquish
///   ledger      EnergyLedger                                    no energy balance
///   events      ContactEvents                                   no contact events
///   modules     Field<"name">, BodyForce, user-defined structs  none; any number of them
// clang-format on
///
/// Units: lengths in m, times in s, masses in kg. Errors: InputError for values and combinations
/// that cannot be used; SimulationError if a run exceeds a limit of `guard`; a compile-time message
/// for policies that do not form a simulation (simulation/refused_simulation.hpp).
template <class... Policies>
class Simulation : public detail::ContactAccess<Simulation<Policies...>>,
                   public detail::ModuleAccess<Simulation<Policies...>>,
                   public detail::NameAccess<Simulation<Policies...>>,
                   public detail::ParticleEdits<Simulation<Policies...>>,
                   public detail::BodyReadings<Simulation<Policies...>>,
                   public detail::BondAccess<Simulation<Policies...>>,
                   public detail::BreakAccess<Simulation<Policies...>>,
                   public detail::FluidAccess<Simulation<Policies...>>,
                   public detail::OpeningAccess<Simulation<Policies...>>,
                   public detail::ParticleReadings<Simulation<Policies...>>,
                   public detail::RankAccess<Simulation<Policies...>>,
                   public detail::WallAccess<Simulation<Policies...>> {
 public:
  using Composition = typename detail::InOrder<Policies...>::OfSimulation;
  using ParticlesType = typename Composition::ParticlesType;
  using ContactsType = typename Composition::UserContacts;
  using Search = typename Composition::Search;
  using Domain = typename Composition::Domain;
  using Fluid = typename Composition::Fluid;
  using Precision = typename Composition::Precision;
  using Integrator = typename Composition::Integrator;
  using Rotation = typename Composition::Rotation;
  using Modules = typename Composition::Modules;
  using ShapeType = typename Composition::Shape;
  static constexpr bool has_bonds = Composition::has_bonds;
  static constexpr bool has_breakage = Composition::has_breakage;
  static constexpr bool has_ranks = Composition::has_ranks;
  /// Particles are rigid bodies with an orientation, of one part or several.
  static constexpr bool of_bodies = Composition::of_bodies;
  /// Bodies whose shape is not a set of spheres.
  static constexpr bool has_surfaces = Composition::has_surfaces;
  static constexpr bool has_ledger = Composition::has_ledger;
  static constexpr bool has_events = Composition::has_events;
  static constexpr bool rotates = Composition::rotates;
  static constexpr bool turned_by_fluid = detail::turns(Composition::from_fluid);
  static constexpr bool follows_fluid = detail::follows(Composition::from_fluid);
  static_assert(!follows_fluid || FollowingFluid<Fluid>,
                "a fluid that says it follows lacks start_of(), lose(), prepare_to_follow() or "
                "follow() (FollowingFluid, silt/coupling/concept.hpp)");
  static_assert(rotates || !detail::FluidTraits<Fluid>::needs_rotation,
                "a force of the fluid depends on the rotation of particles (SpinLift), but these "
                "spheres do not rotate: take a contact law with friction, or leave that force out");
  static_assert(
      detail::laws_fit_lanes<typename Composition::Contacts, typename Composition::Arch>());
  static_assert(
      detail::fluxes_fit_lanes<typename Composition::Arch>(static_cast<const Modules*>(nullptr)));
  using Engine = detail::Engine<typename detail::InOrder<Policies...>::OfEngine>;
  static_assert(
      !(Integrator::derivatives > 0 && detail::has_safeguard<typename ContactsType::Law>),
      "a law with a safeguard (Softened) turns a velocity within one step, which Gear spreads over "
      "several, beyond what is wanted: take Leapfrog");

  /// State of one particle, and in addition of one body of such parts [bytes].
  static constexpr std::size_t bytes_per_particle = Engine::State::bytes_per_particle;
  static constexpr std::size_t bytes_per_body =
      of_bodies ? sizeof(detail::Body) +
                      detail::bytes_of_row<detail::FluidLoads<Composition::from_fluid>>() +
                      detail::bytes_of_row<detail::ModuleColumns<Modules>>()
                : 0;
  /// State of one contact [bytes]: two indices and the history of the law.
  static constexpr std::size_t bytes_per_contact =
      2 * sizeof(std::uint32_t) + detail::history_numbers<typename Composition::Contacts> *
                                      sizeof(typename Precision::PairScalar);

  Vec3d gravity{0, 0, 0};           // [m/s2]
  std::optional<double> time_step;  // [s]; if not set: a 20th of the shortest contact
  int threads = default_threads();  // results do not depend on it
  Guard guard;
  /// Whether steps with an observer written by the user, and the last step of a run, record their
  /// contacts for for_each_contact(). Default: if the program calls that function anywhere.
  bool keep_contacts = detail::asks_for_contacts<Simulation>;

  template <class... Args>
  explicit Simulation(Args&&... policies)
      : contacts_(detail::take<ContactsType>(policies...)),
        search_(detail::take_or<Search>(policies...)),
        domain_(detail::take_or<Domain>(policies...)),
        fluid_(detail::take_or<Fluid>(policies...)),
        modules_(Modules::taken_from(policies...)) {
    if constexpr (requires { search_.check(); }) search_.check();
    if constexpr (has_ranks) {
      auto& ranks = detail::take<typename Composition::Ranks>(policies...);
      if constexpr (std::copy_constructible<typename Composition::Ranks>)
        engine_.ranks.set(ranks);
      else
        engine_.ranks.set(std::move(ranks));
      threads = std::max(threads / engine_.ranks.comm().on_this_machine(), 1);
    }
    if constexpr (has_bonds)
      this->set_bonds(detail::take<typename Composition::Bonds>(policies...));
    add(detail::take<ParticlesType>(policies...));
  }

  // --- the scene ----------------------------------------------------------------------------

  /// Adds a wall of material `solid`, which may move; returns its number. Pose 0 is that at time 0.
  /// See also WallSetup, and WallAccess for reading and changing walls.
  std::size_t add_wall(Surfaces surfaces, const typename ContactsType::Material& solid,
                       WallSetup setup = {});
  using detail::WallAccess<Simulation>::add_wall;  // with a motion in place of the setup

  /// Adds further particles now. Returns the number in forms() of each of their forms: a new one,
  /// or that of an equal form already present; empty for spheres.
  std::vector<std::size_t> add(const ParticlesType& more);
  /// Deforms the box from the next step on as described by `how` (DeformingBox).
  void deform(const Deformation& how) requires(detail::deforms<Domain>) {
    if constexpr (!has_bonds) detail::refuse_tension<typename ContactsType::Law>(how);
    domain_.deform(how), scene_changed_ = true;
  }
  /// Adds the particles placed by an inlet.
  double insert(const DynArray<PlacedSphere>& spheres, const DynArray<std::size_t>& kinds,
                const InletFlow& flow, Random& random);
  /// Whether several parts of a body that press on one partner share the stiffness of a contact
  /// (engine/contact/shared_contacts.hpp); default true. Otherwise a body becomes stiffer the more
  /// parts touch.
  void share_contacts(bool yes) requires(of_bodies && !SolidShape<ShapeType>) {
    engine_.share_contacts = yes;
  }

  // --- the run ------------------------------------------------------------------------------

  /// Runs for `duration` [s]; each observer is called at its times with this simulation
  /// (simulation/observing.hpp).
  template <class... Observers>
  void run(double duration, Observers&&... observers) {
    detail::run_observed(
        *this, past_runs_, [&] { run_steps(duration, observers...); },
        [this] { return kicked_ ? 0 : dt_; }, observers...);
  }

 private:
  template <class... Observers>
  void run_steps(double duration, Observers&... observers);

 public:
  // --- reading --------------------------------------------------------------------------

  double time() const { return time_; }        // [s]
  std::int64_t step() const { return step_; }  // [-] steps done
  double step_length() const { return dt_; }   // [s] in use
  /// True from a restart on until the end of the run that goes on from it.
  bool continued() const { return continued_; }
  /// For observers that begin to write a file or series: whether they add to it. They do after a
  /// restart and in later runs. InputError if another observer of this run writes it.
  bool continues(const std::string& file) const { return past_runs_.goes_on(file); }
  bool has_begun(const std::string& file) const { return past_runs_.has_begun(file); }
  /// Whether observers were called at this instant, in this run or the one before.
  bool observed() const { return observed_; }
  using Readings = detail::ParticleReadings<Simulation>;
  using Readings::size, Readings::rows, Readings::id, Readings::is_present, Readings::position,
      Readings::radius, Readings::mass, Readings::velocity, Readings::angular_velocity,
      Readings::material, Readings::find;
  /// The energy balance; call it when the simulation is not running, or in an observer
  /// (collective).
  EnergyBalance energy() const { return balance(); }
  /// The impulse of the fluid on particle k [N s] that velocity(k) does not yet include, because
  /// the flow is ahead of the particles; valid while they are observed, or after run().
  Vec3d due_from_fluid(std::size_t k) const;
  const ContactsType& contacts() const { return contacts_; }
  const Domain& domain() const { return domain_; }
  const Search& search() const { return search_; }
  Engine& engine() { return engine_; }
  const Engine& engine() const { return engine_; }
  /// [-] relative to the radius: in the last step, and the largest since the start.
  double largest_overlap() const { return engine_.largest_overlap; }
  double peak_overlap() const { return peak_overlap_; }
  /// The largest time step that guard allows at `speed` [m/s] of the fastest points of particles
  /// (docs/stability.md, Spin); empty if the law has no closed form for the contact time.
  std::optional<double> time_step_limit(double speed) const;

 private:
  void advance(bool observed);
  void forces(bool observed, std::size_t present);
  void finish_step();
  void renew_lists();
  std::size_t known(std::size_t k) const {
    if (k >= rows()) [[unlikely]]
      detail::refuse_row(k, rows());
    return k;
  }
  struct Kinetic {
    double translation, rotation;  // [J]
    double sum() const { return translation + rotation; }
  };
  detail::StepTimes times_of_step(bool observed) const;
  Kinetic kinetic(std::size_t k) const;
  EnergyBalance balance() const;
  template <class Particle, class Check>
  void check_new(std::span<const Particle> more, const Check& check) const;
  template <class Particle>
  void take_in(std::span<const Particle> more, std::span<const std::size_t> numbers);
  template <class Particle>
  void join(std::span<const Particle> more, std::span<const std::size_t> numbers,
            std::span<const char> own = {});
  void book_step(const detail::StepTimes& times, double bond_power);
  void book_leaving(std::size_t k);
  void couple();
  void break_bonds();
  void break_bonds_of_ranks();
  void push_modules();
  void act_in_pairs();
  void start_fields(std::size_t from);
  double power_of_modules() const;
  double longest_module_step() const;
  std::size_t present_for_fluxes() const;
  detail::FluxLook look_at_fluxes(std::size_t present_before) const;
  void choose_flux_steps();
  void check_module_rates() const;
  void renew_fluid();
  void take_fluid_loads(double span);
  void take_from_fluid(std::size_t k, double share);
  FluidPace pace_of_fluid(double speed) const;
  double kicked_to() const;
  void change_fluid_step(double dt);
  void follow_fluid();
  double gather_for_fluid();
  void gather_forms_for_fluid();
  ParticleHeat heat_in_fluid();
  void take_heat_of_fluid();
  double power_of_fluid() const;
  template <class Column>
  double work_of_first_kick(const Column& force) const;
  void prepare_fluid();
  double potential(std::size_t k) const { return -mass(k) * dot(gravity_booked_, position(k)); }
  void prepare();
  void check_start();
  void book_gravity();
  void begin_run();
  double chosen_time_step() const;
  double step_for(double speed, double contact) const;
  double coming_step() const;
  void change_step(double dt);
  bool follow_time_step(bool observed);
  void follow_sizes();
  std::int64_t last_step(double end) const {  // a difference within rounding is not a step
    return step_ + static_cast<std::int64_t>(std::ceil((end - time_) / dt_ - 1e-6));
  }
  detail::SurfaceSpeed surface_speed(std::size_t k) const;
  std::string tips_at(double speed) const;
  double expected_speed() const;
  double carried_speed(const Box& scene) const;
  void share_scene();
  void measure_scene();
  std::optional<detail::ShortestContact> shortest_contact(double speed) const;
  double longest_travel_step(double speed) const;
  double longest_step_in_fluid() const;
  bool is_step_too_long() const;
  bool is_longer_than_own() const;
  bool is_longer_than_chosen() const;
  void check_walls() const;
  void keep_limits();
  std::string step_advice() const;
  void keep_rates(double back);
  void keep_rates_of_walls();
  double time_at(std::int64_t step) const {
    return time_origin_ + static_cast<double>(step - step_origin_) * dt_;
  }

  template <class Sim>
  friend class Checkpoint;
  friend class detail::ContactAccess<Simulation>;
  friend class detail::ModuleAccess<Simulation>;
  friend class detail::NameAccess<Simulation>;
  friend class detail::ParticleEdits<Simulation>;
  friend class detail::BodyReadings<Simulation>;
  friend class detail::BondAccess<Simulation>;
  friend class detail::BreakAccess<Simulation>;
  friend class detail::FluidAccess<Simulation>;
  friend class detail::OpeningAccess<Simulation>;
  friend class detail::ParticleReadings<Simulation>;
  friend class detail::WallAccess<Simulation>;
  friend class detail::Openings<ShapeType, Domain>;
  using FluidIs = detail::FluidTraits<Fluid>;
  struct Nothing {};
  static auto particles_in_fluid() {
    if constexpr (Fluid::active)
      return typename FluidIs::Particles{};
    else
      return Nothing{};
  }

  ContactsType contacts_;
  Search search_;
  Domain domain_;
  [[no_unique_address]] Fluid fluid_;
  [[no_unique_address]] detail::ModuleStage<Modules, Domain> modules_;
  [[no_unique_address]] mutable typename detail::BondsOf<typename Composition::Bonds, Domain,
                                                         typename Composition::Arch>::type bonds_;
  [[no_unique_address]] std::conditional_t<has_bonds, DynArray<BondBreak>, Nothing>
      bonds_broken_;  // in this step
  [[no_unique_address]] typename detail::BreakStageOf<typename Composition::Breaking>::type breaks_;
  [[no_unique_address]] decltype(particles_in_fluid()) in_fluid_;
  Engine engine_;
  detail::Openings<ShapeType, Domain> openings_;
  [[no_unique_address]] std::conditional_t<has_ledger, detail::EnergyBook, Nothing> book_;
  static constexpr double clock_rounding = 1e-3;  // [-] of a step
  static constexpr double first_wall_kick =
      Integrator::derivatives > 0 ? 0.5 : Integrator::first_kick;
  Vec3d gravity_booked_{0, 0, 0};  // [m/s2] in the ledger
  double time_ = 0, dt_ = 0, time_origin_ = 0;
  std::int64_t step_ = 0, step_origin_ = 0;
  std::int64_t flux_every_ = 1;  // [steps] for which the fluxes of modules are held
  double checked_speed_ = 0, checked_overlap_ = 0, peak_overlap_ = 0;
  detail::NextIds next_;
  bool first_kick_ = true, kicked_ = false, observed_ = false, continued_ = false;
  bool running_ = false;                                       // in run(), with its observers
  mutable detail::PastRuns past_runs_;                         // continues()
  detail::ContactsKept kept_ = detail::ContactsKept::Nothing;  // of the present step
  bool scene_changed_ = false;                                 // since the last run began
  [[no_unique_address]] std::conditional_t<has_ranks, detail::RanksScene, Nothing> ranks_scene_;
  bool laws_changed_ = false;    // by a restart that accepted them, until its run begins
  std::int64_t scene_step_ = 0;  // when particles or walls were last added
  detail::OverlapLimits overlap_limits_;
};

}  // namespace silt

#include <silt/simulation/begin_run.hpp>
#include <silt/simulation/choose_time_step.hpp>
#include <silt/simulation/deduction.hpp>
#include <silt/simulation/keep_limits.hpp>
#include <silt/simulation/refused_simulation.hpp>
#include <silt/simulation/step.hpp>
#include <silt/simulation/take_in.hpp>
#include <silt/simulation/with_bonds.hpp>
#include <silt/simulation/with_fluid.hpp>
#include <silt/simulation/with_ledger.hpp>
#include <silt/simulation/with_modules.hpp>
