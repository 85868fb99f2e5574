// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/coupling/no_fluid.hpp>
#include <silt/engine/checks/contact_rates.hpp>
#include <silt/engine/checks/guard.hpp>
#include <silt/engine/checks/time_step.hpp>
#include <silt/engine/contact/ask_on_lanes.hpp>
#include <silt/engine/engine.hpp>
#include <silt/engine/population/openings.hpp>
#include <silt/fill/particles.hpp>
#include <silt/search/verlet_list.hpp>
#include <silt/simulation/axes.hpp>
#include <silt/simulation/energy_ledger.hpp>

namespace silt::inline SILT_TARGET {

/// A particle simulation, composed from one policy an axis. Policies come in any order:
///
///   silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
///
///   axis       policy                                         left out
///   particles  Particles<Shape>                               must be given
///   contact    Contacts<Law, Options...>                      must be given
///   search     VerletList<Finder>, or a finder itself         VerletList<CellGrid>, automatic skin
///   domain     OpenDomain, PeriodicBox                        OpenDomain
///   fluid      CoupledFlow<Drag, Mode, Forces...>             NoFluid
///   precision  Double, Mixed                                  Double
///   kernels    KernelsFor<Arch>                               what the compile flags allow
///   integrator Leapfrog, SymplecticEuler, Gear                Leapfrog
///   rotation   NoSquish, Spiral: of bodies                    NoSquish
///   ledger     EnergyLedger                                   no books of the energy
///
/// Lengths in m, times in s, masses in kg. Errors: InputError for values and combinations that
/// cannot be used, SimulationError for a run that breaks a limit of `guard`; policies that do not
/// make a simulation: a sentence at compile time (simulation/refused_simulation.hpp).
template <class... Policies>
class Simulation {
 public:
  using ParticlesType = detail::pick<detail::IsParticles, void, Policies...>;
  using ContactsType = detail::pick<detail::IsContacts, void, Policies...>;
  using Search = detail::pick<detail::IsSearch, VerletList<>, Policies...>;
  using Domain = detail::pick<detail::IsDomain, OpenDomain, Policies...>;
  using Fluid = detail::pick<detail::IsFluid, NoFluid, Policies...>;
  using Arch = typename detail::pick<detail::IsKernels, KernelsFor<DefaultArch>, Policies...>::type;
  using Precision = detail::pick<detail::IsPrecision, Double, Policies...>;
  using Integrator = detail::pick<detail::IsIntegrator, Leapfrog, Policies...>;
  using Rotation = detail::pick<detail::IsRotation, NoSquish, Policies...>;
  using ShapeType = typename ParticlesType::ShapeType;
  /// Particles are rigid bodies with an orientation, of one part or several.
  static constexpr bool has_bodies = BodyShape<ShapeType>;
  /// ... whose shape is no set of spheres.
  static constexpr bool has_surfaces = SolidShape<ShapeType>;
  static_assert(has_bodies || detail::count<detail::IsRotation, Policies...> == 0,
                "spheres have no orientation: leave the rotation out");
  static constexpr bool has_ledger = detail::count<detail::IsLedger, Policies...> > 0;
  static constexpr bool rotates = ContactsType::rotates || has_bodies;
  static constexpr detail::FromFluid from_fluid = detail::loads_of_fluid<Fluid>;
  static constexpr bool turned_by_fluid = detail::turns(from_fluid);
  static constexpr bool follows_fluid = detail::follows(from_fluid);
  static_assert(rotates || !turned_by_fluid,
                "a force of the fluid has a torque, but these spheres do not rotate: take a "
                "contact law with friction, or leave that force out");
  using BooksOrNot = std::conditional_t<has_ledger, detail::WithLedger<ContactsType>, ContactsType>;
  using EngineContacts = typename detail::ContactsOf<ShapeType, BooksOrNot>::type;
  static_assert(detail::laws_fit_lanes<EngineContacts, Arch>());
  using Engine = detail::Engine<ShapeType, EngineContacts, Search, Domain, Arch, Precision,
                                Integrator, Rotation, from_fluid>;

  static_assert(
      !(Integrator::derivatives > 0 && detail::has_safeguard<typename ContactsType::Law>),
      "a law with a safeguard (Softened) turns a velocity within one step, which Gear spreads over "
      "several, beyond what is wanted: take Leapfrog");

  /// State of one particle [bytes]: no more than the policies need. Of bodies: of each part;
  /// bytes_per_body come once a body.
  static constexpr std::size_t bytes_per_particle = Engine::State::bytes_per_particle;
  static constexpr std::size_t bytes_per_body =
      has_bodies ? sizeof(detail::Body) + detail::FluidLoads<from_fluid>::bytes : 0;
  /// State of one contact [bytes]: two indices and the history of the law.
  static constexpr std::size_t bytes_per_contact =
      2 * sizeof(std::uint32_t) +
      detail::history_numbers<EngineContacts> * sizeof(typename Precision::PairScalar);

  Vec3d gravity{0, 0, 0};           // [m/s2]
  std::optional<double> time_step;  // [s]; left out: a 20th of the shortest contact
  int threads = default_threads();  // results do not depend on it
  Guard guard;

  template <class... Args>
  explicit Simulation(Args&&... policies)
      : contacts_(detail::take<ContactsType>(policies...)),
        search_(detail::take_or<Search>(policies...)),
        domain_(detail::take_or<Domain>(policies...)),
        fluid_(detail::take_or<Fluid>(policies...)) {
    if constexpr (requires { search_.check(); }) search_.check();
    add(detail::take<ParticlesType>(policies...));
  }

  // --- the scene ----------------------------------------------------------------------------

  /// Adds a wall of `material`, which may move; returns its number. Pose 0 is that at time 0.
  std::size_t add_wall(Surfaces surfaces, const typename ContactsType::Material& material,
                       Motion motion = {}) {
    for (const auto& part : surfaces.parts)
      detail::visit_surface(part, [](const auto& s) {
        if constexpr (requires { s.check(); }) s.check();
      });
    Wall wall{std::move(surfaces.parts), contacts_.add(material), std::move(motion)};
    if (wall.moves()) wall.pose = wall.last_pose = wall.motion(time_);
    engine_.walls.push_back(std::move(wall));
    engine_.lists.forget();
    scene_changed_ = true, scene_step_ = step_;
    return engine_.walls.size() - 1;
  }
  /// Takes away the surfaces of wall k: a lid that opens. Its number stays taken.
  void remove_wall(std::size_t k) {
    wall_at(k).surfaces.clear();
    engine_.lists.forget();
  }
  /// Lets particles and walls of these two materials overlap by up to `limit` [-] of the smaller
  /// radius, in place of guard.max_overlap: a heavy body that hits light grains.
  void set_max_overlap(const typename ContactsType::Material& a,
                       const typename ContactsType::Material& b, double limit);
  const Wall& wall(std::size_t k) const { return detail::at("wall", engine_.walls, k); }
  std::size_t walls() const { return engine_.walls.size(); }
  void set_reference(std::size_t k, const Vec3d& point) { wall_at(k).reference = point; }

  /// Particles whose centre enters `region` leave the simulation and are counted.
  std::size_t add_outlet(const Box& region) { return openings_.add_outlet(region); }
  const Outlet& outlet(std::size_t k) const { return openings_.outlet(k); }
  std::size_t outlets() const { return openings_.outlets().size(); }

  /// Places new particles at a rate; see Inlet.
  template <Region R>
  std::size_t add_inlet(const R& region, const InletFlow& flow) {
    if constexpr (has_bodies)
      require(flow.form < engine_.mover.forms.size(), "InletFlow.form = ", flow.form,
              " is none of the ", engine_.mover.forms.size(),
              " forms of the simulation; make it with add_form before");
    else
      require(flow.form == 0, "InletFlow.form = ", flow.form,
              ", but spheres have no form; leave it out");
    scene_changed_ = true;
    return openings_.add_inlet(region, flow, time_);
  }
  std::size_t add_inlet(const Box& region, const InletFlow& flow) {
    return add_inlet<Box>(region, flow);
  }
  const Inlet& inlet(std::size_t k) const { return openings_.inlet(k); }
  std::size_t inlets() const { return openings_.inlets().size(); }

  /// Adds more particles now. Returns the number in forms() of each of their forms: a new one, or
  /// that of an equal form which the simulation has already; of spheres nothing.
  std::vector<std::size_t> add(const ParticlesType& more);
  /// Adds what an inlet has placed.
  void insert(const std::vector<PlacedSphere>& spheres, const InletFlow& flow, Random& random);

  /// Whether several parts of a body that press on one partner share the stiffness of a contact
  /// (engine/contact/shared_contacts.hpp); true unless set. Without, a body is the stiffer the more
  /// parts it touches with.
  void share_contacts(bool yes) requires(has_bodies && !SolidShape<ShapeType>) {
    engine_.share_contacts = yes;
  }

  // --- the run ------------------------------------------------------------------------------

  /// Runs for `duration` [s]; each observer is called at its times with this simulation.
  template <class... Observers>
  void run(double duration, Observers&&... observers) {
    require_not_negative("Simulation::run: duration", duration, "s");
    prepare();
    const std::int64_t last =
        step_ + static_cast<std::int64_t>(std::ceil(duration / dt_ * (1 - 1e-12)));
    (detail::begin(observers, *this, time_ + duration), ...);
    for (;; ++step_, time_ = time_at(step_)) {
      const bool stop = step_ >= last;
      if (!kicked_) advance(stop || (detail::is_due(observers, *this) || ...));
      if (kicked_) (detail::observe(observers, *this), ...);
      if (kicked_ && sizeof...(Observers) > 0) detail::check_given(engine_, gravity, step_, time_);
      if (stop) break;
      if (kicked_) engine_.drift(dt_);
      kicked_ = false;
    }
    (detail::end(observers, *this), ...);
    continued_ = false;
  }

  // --- what observers and users read --------------------------------------------------------

  double time() const { return time_; }        // [s]
  std::int64_t step() const { return step_; }  // [-] steps done
  double step_length() const { return dt_; }   // [s] in use
  /// True from a restart on until the end of the run that goes on from it.
  bool continued() const { return continued_; }
  std::size_t size() const {
    if constexpr (has_bodies)
      return static_cast<std::size_t>(std::count_if(
          bodies().begin(), bodies().end(), [](const auto& b) { return b.id != no_particle; }));
    else
      return engine_.particles.size() - engine_.particles.parked;
  }
  /// Places 0 ... rows()-1 in memory; those where id() is silt::no_particle have left.
  std::size_t rows() const { return engine_.rows_of_particles(); }
  ParticleId id(std::size_t k) const {
    if constexpr (has_bodies)
      return bodies()[known(k)].id;
    else
      return engine_.particles.id[known(k)];
  }
  bool is_present(std::size_t k) const { return id(k) != no_particle; }
  Vec3d position(std::size_t k) const {  // [m] of the centre of mass
    if constexpr (has_bodies)
      return bodies()[known(k)].centre;
    else
      return engine_.particles.position[known(k)].centre();
  }
  double radius(std::size_t k) const {  // [m] of bodies that of the bounding sphere
    if constexpr (has_bodies)
      return bodies()[known(k)].radius;
    else
      return engine_.particles.position[known(k)].r;
  }
  double mass(std::size_t k) const {  // [kg] infinite: fixed
    double inv_m;
    if constexpr (has_bodies)
      inv_m = bodies()[known(k)].inv_m;
    else
      inv_m = engine_.particles.motion[known(k)].inv_m;
    return inv_m > 0 ? 1 / inv_m : INFINITY;
  }
  Vec3d velocity(std::size_t k) const {  // [m/s] at time()
    if (kicked_) return engine_.mover.synchronous[known(k)].velocity;
    if constexpr (has_bodies)
      return bodies()[known(k)].velocity;
    else
      return engine_.particles.motion[known(k)].velocity();
  }
  Vec3d angular_velocity(std::size_t k) const  // [rad/s] at time()
      requires rotates {
    if constexpr (has_bodies) {
      return kicked_ ? engine_.mover.synchronous[known(k)].angular_velocity
                     : bodies()[known(k)].angular_velocity(bodies()[k].momentum);
    } else {
      const auto& m = engine_.particles.motion[known(k)];
      return (kicked_ ? engine_.mover.synchronous[k].spin_velocity : m.spin_velocity()) * m.inv_r;
    }
  }
  /// Turns the frame in which the form was given to space.
  Quaternion orientation(std::size_t k) const requires has_bodies {
    const auto& b = bodies()[known(k)];
    return b.orientation * conjugate(engine_.mover.forms[b.form].mass.axes);
  }
  std::size_t form(std::size_t k) const requires has_bodies { return bodies()[known(k)].form; }
  /// Size of the particle over that of its form as it was made [-].
  double scale(std::size_t k) const requires has_bodies { return bodies()[known(k)].scale; }
  const std::vector<BodyForm<ShapeType>>& forms() const requires has_bodies {
    return engine_.mover.forms;
  }
  std::size_t material(std::size_t k) const {
    if constexpr (ContactsType::several_materials)
      return engine_.particles.material[engine_.first_row(known(k))];
    else
      return 0;
  }
  /// The present place of the particle with this id; rows() if it has left, or never was. Takes
  /// constant time, but for the first call after places have changed (a search that sorts,
  /// particles that come or go), which takes O(rows()) and must not be made by several threads at
  /// once.
  std::size_t find(ParticleId wanted) const { return engine_.find(wanted); }
  /// Pairs of particles that touch [-]; of bodies, of their parts. O(pairs).
  std::size_t touching_pairs() const { return engine_.touching_pairs(domain_); }
  /// Where the energy is and where it went; when the simulation is not running, or in an observer.
  EnergyBalance energy() const requires has_ledger {
    require(step_ > 0 || kicked_,
            "Simulation::energy: run() first, if only for 0 s: the forces at the "
            "start are not known yet");
    double translation = 0, rotation = 0, potentials = 0;
    for (std::size_t k = 0; k < rows(); ++k) {
      if (!is_present(k) || !std::isfinite(mass(k))) continue;
      const auto part = kinetic(k);
      translation += part.translation, rotation += part.rotation, potentials += potential(k);
    }
    return book_.balance(translation, rotation, potentials);
  }
  /// The fluid and what it has done.
  Fluid& fluid() requires(Fluid::active) { return fluid_; }
  const Fluid& fluid() const requires(Fluid::active) { return fluid_; }
  /// What the fluid does to particle k at present [N].
  Vec3d fluid_force(std::size_t k) const requires(Fluid::active) {
    return engine_.fluid_loads().force[known(k)].vector();
  }
  /// What the fluid has given to particle k [N s] that velocity(k) does not have yet, as the flow
  /// is ahead of the particles; while they are observed, or after run().
  Vec3d due_from_fluid(std::size_t k) const;
  const ContactsType& contacts() const { return contacts_; }
  const Domain& domain() const { return domain_; }
  const Search& search() const { return search_; }
  Engine& engine() { return engine_; }
  const Engine& engine() const { return engine_; }
  double largest_overlap() const {
    return engine_.largest_overlap;
  }                                                      // [-] of the radius, last step
  double peak_overlap() const { return peak_overlap_; }  // [-] of the radius, since the start
  /// How many contacts the law's safeguard has ended since the start [-] (Softened).
  std::uint64_t safeguarded() const requires detail::has_safeguard<typename ContactsType::Law> {
    return engine_.safeguards;
  }
  /// The largest time step that guard allows at `speed` [m/s] of the fastest points of particles
  /// (docs/stability.md, Spin); none if the law has no closed form.
  std::optional<double> time_step_limit(double speed) const;

 private:
  /// One step up to the kick; then either drifts at once or stops for the observers.
  void advance(bool observed) {
    engine_.move_walls(time_);
    check_walls();
    if (first_kick_) engine_.start_walls(time_, dt_);
    openings_.update(engine_, *this);
    engine_.renew_lists(search_, domain_, step_, dt_);
    const detail::StepTimes times{dt_, first_kick_ ? 0 : dt_,
                                  observed || first_kick_ || step_ % detail::ledger_asks_every == 0,
                                  Integrator::lag, step_ % detail::StepTimes::areas_every == 0};
    engine_.pair_forces(domain_, times);
    engine_.wall_forces(times);
    if constexpr (Fluid::active) couple();
    book_step(times);
    using Advance = typename Engine::Advance;
    const double kick = first_kick_ ? Integrator::first_kick * dt_ : dt_;
    engine_.integrate(observed ? Advance::KickAndRecord : Advance::KickAndDrift, gravity, kick, dt_,
                      first_kick_);
    first_kick_ = false;
    kicked_ = observed;
    keep_limits();
  }

  std::size_t known(std::size_t k) const {
    if (k >= rows()) [[unlikely]]
      detail::refuse_row(k, rows());
    return k;
  }
  Wall& wall_at(std::size_t k) { return const_cast<Wall&>(wall(k)); }
  struct Kinetic {
    double translation, rotation;  // [J]
    double sum() const { return translation + rotation; }
  };
  Kinetic kinetic(std::size_t k) const {
    const double m = mass(k);
    const Vec3d v = velocity(k);
    Kinetic part{0.5 * m * dot(v, v), 0};
    if constexpr (has_bodies) {
      const auto& b = bodies()[k];
      const Vec3d w = rotate(conjugate(b.orientation), angular_velocity(k));
      part.rotation =
          0.5 * (b.inertia.x * w.x * w.x + b.inertia.y * w.y * w.y + b.inertia.z * w.z * w.z);
    } else if constexpr (rotates) {
      const Vec3d w = angular_velocity(k);
      part.rotation = 0.5 * ShapeType::inertia_factor() * m * radius(k) * radius(k) * dot(w, w);
    }
    return part;
  }
  const std::vector<detail::Body>& bodies() const requires has_bodies {
    return engine_.mover.bodies;
  }
  template <class Particle, class Check>
  void check_new(std::span<const Particle> more, const Check& check) const;
  template <class Form>
  std::vector<std::size_t> add_forms(const std::vector<Form>& more);
  template <class Particle>
  void add_bodies(std::span<const Particle> more, std::span<const std::size_t> numbers = {});
  void book_step(const detail::StepTimes& times);
  void book_leaving(std::size_t k);
  void couple();
  void renew_fluid();
  double longest_held_step(double longest) const;
  void check_held_step(double span) const;
  double kicked_to() const;
  void change_fluid_step(double dt);
  void follow_fluid();
  double gather_for_fluid();
  double power_of_fluid() const;
  double work_of_first_kick() const;
  void check_fluid() const;
  double potential(std::size_t k) const { return -mass(k) * dot(gravity_booked_, position(k)); }
  void prepare();
  double chosen_time_step() const;
  detail::SurfaceSpeed surface_speed(std::size_t k) const;
  std::string tips_at(double speed) const;
  double expected_speed() const;
  detail::Meetings meetings() const;
  std::optional<detail::ShortestContact> shortest_contact(double speed) const;
  double longest_travel_step(double speed) const;
  bool is_step_too_long() const;
  bool is_longer_than_chosen() const;
  void check_walls() const;
  void keep_limits();
  void keep_rates(double back);
  double time_at(std::int64_t step) const {
    return time_origin_ + static_cast<double>(step - step_origin_) * dt_;
  }

  template <class Sim>
  friend class Checkpoint;
  friend class detail::Openings<ShapeType>;
  struct NoBook {};
  struct NoParticles {};
  static auto particles_in_fluid() {
    if constexpr (Fluid::active)
      return typename Fluid::Particles{};
    else
      return NoParticles{};
  }

  ContactsType contacts_;
  Search search_;
  Domain domain_;
  [[no_unique_address]] Fluid fluid_;
  [[no_unique_address]] decltype(particles_in_fluid()) in_fluid_;
  Engine engine_;
  detail::Openings<ShapeType> openings_;
  [[no_unique_address]] std::conditional_t<has_ledger, detail::EnergyBook, NoBook> book_;
  static constexpr double clock_rounding = 1e-3;  // [-] of a step
  Vec3d gravity_booked_{0, 0, 0};                 // [m/s2] that the ledger reckons with
  double time_ = 0, dt_ = 0, time_origin_ = 0;
  std::int64_t step_ = 0, step_origin_ = 0;
  /// Fluid steps that resolve contacts, over the limit of the particles' steps, an eighth of one:
  /// omega dt = 0.4 of a pair's, some 1.1 of a packing's fastest motion, where 1.7 is stable.
  static constexpr double held_share_of_contact = 1;
  double checked_speed_ = 0, checked_overlap_ = 0, peak_overlap_ = 0;
  ParticleId next_id_ = 0, next_part_ = 0;
  bool first_kick_ = true, kicked_ = false, continued_ = false;
  bool scene_changed_ = false;   // since the last run began
  std::int64_t scene_step_ = 0;  // when particles or walls were last added
  detail::OverlapLimits overlap_limits_;
};

// The kernels' instruction set is always part of the type, so that translation units with different
// flags do not share a name for different code.
template <class... Args>
requires(detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> > 0) Simulation(Args&&...)
->Simulation<std::remove_cvref_t<Args>...>;
template <class... Args>
requires(detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> == 0) Simulation(Args&&...)
->Simulation<std::remove_cvref_t<Args>..., KernelsFor<DefaultArch>>;

}  // namespace silt

#include <silt/simulation/bodies.hpp>
#include <silt/simulation/choose_time_step.hpp>
#include <silt/simulation/parts.hpp>
#include <silt/simulation/refused_simulation.hpp>
#include <silt/simulation/with_fluid.hpp>
