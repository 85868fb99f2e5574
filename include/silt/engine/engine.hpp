// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_map>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/advance/power_on_fixed.hpp>
#include <silt/engine/advance/tables.hpp>
#include <silt/engine/advance/wall_motion.hpp>
#include <silt/engine/checks/wall_stiffness.hpp>
#include <silt/engine/contact/contact_log.hpp>
#include <silt/engine/contact/contact_memory.hpp>
#include <silt/engine/lists/near_lists.hpp>
#include <silt/engine/lists/pair_list.hpp>
#include <silt/engine/spheres/pair_pipeline.hpp>
#include <silt/engine/stages_of_shape.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The state of a simulation, with one function per stage of a time step. The engine knows the
/// policies but neither observers nor files; Simulation calls the stages in order.
template <class Composition>
class Engine : public Tables<Composition> {
  using ContactsType = typename Composition::Contacts;
  using Search = typename Composition::Search;
  using Domain = typename Composition::Domain;
  using Arch = typename Composition::Arch;
  using Integrator = typename Composition::Integrator;

 public:
  using ShapeType = typename Composition::Shape;
  using Contacts = ContactsType;
  using IntegratorType = Integrator;
  using RotationType = typename Composition::Rotation;
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t history = ContactsType::history;  // Scalars of history per contact
  static constexpr ContactMemory<ContactsType> memory{};
  static_assert(memory.is_whole());
  using Scalar = typename Composition::Scalar;  // precision of the pair computations
  static constexpr bool predicts = Integrator::derivatives > 0;
  static constexpr bool of_ranks = Composition::has_ranks;
  static constexpr bool of_bodies = Composition::of_bodies;  // rows are parts of bodies
  static constexpr bool convex = Composition::has_surfaces;  // convex surfaces with narrow phases
  using Modules = typename Composition::Modules;
  using typename Tables<Composition>::State, typename Tables<Composition>::Mover;
  using Tables<Composition>::particles, Tables<Composition>::mover;
  using ParticleMotion = typename State::ParticleMotion;
  using Fluxes = FluxesOf<Modules, Arch, Scalar>;
  using WallStage =
      typename WallStageOf<convex>::template type<ShapeType, ContactsType, Arch, Scalar, Fluxes,
                                                  Domain::periodic && !deforms<Domain>>;
  using Lists =
      NearLists<Composition, PairList<ContactsType::history, Scalar, history_in_rows<ContactsType>>,
                typename WallStage::Contacts, Mover>;

  DynArray<Wall> walls;
  [[no_unique_address]] RankStage<typename Composition::Ranks> ranks;
  Lists lists;
  CoefficientTable<ContactsType> coefficients;
  double largest_speed = 0;           // [m/s] of particle surfaces: Pace
  double largest_share = 0;           // [1/s] largest ratio of speed to inner reach
  double largest_overlap = 0;         // [-] relative to the smaller radius, in the last step
  std::size_t came_from_outside = 0;  // [-] particles placed outside of a periodic box
  bool finite = true;                 // all velocities were finite after the last kick
  bool share_contacts = true;         // parts of one body share contact stiffness: SharedContacts
  ContactRecord record;               // of the last step, if it was requested
  std::uint64_t safeguards = 0;       // [-] contacts ended by a law's safeguard since the start
  [[no_unique_address]] VirialOf<ContactsType> virial;  // of the last step
  [[no_unique_address]] std::conditional_t<deforms<Domain>, DeformingBox::BondLoads, NoVirial>
      of_bonds{};
  EnergyOf<ContactsType, double> contact_energy = start_energy<ContactsType, double>();
  static constexpr bool has_events = keeps_events<ContactsType>;
  [[no_unique_address]] ImpactsOf<ContactsType> impacts;  // of the last step
  double parted = 0;  // [J] released by shrinking offsets, in the last step
  [[no_unique_address]] std::conditional_t<has_events, ContactLog, NoContactLog> events;

  struct NoBreaks {};
  struct NoDue {};
  /// With several ranks: whether bonds break in this step on any rank.
  [[no_unique_address]] std::conditional_t<of_ranks && Composition::has_bonds, bool, NoBreaks>
      bonds_break{};
  /// With several ranks: whether particles are due to break on any rank.
  [[no_unique_address]] std::conditional_t<of_ranks && Composition::has_breakage, bool, NoDue>
      breaks_due{};

  // Defined outside of the class: silt::precompiled has them.
  Engine();
  Engine(Engine&&) = default;
  Engine& operator=(Engine&&) = default;
  ~Engine();

  void set_threads(int threads) {
    if (!team_ || team_->threads() != threads) team_ = std::make_unique<Team>(threads);
  }

  template <class Contacts>
  void set_coefficients(const Contacts& contacts) {
    coefficients = coefficients_of(contacts);
  }
  /// The same for module fluxes through contacts.
  template <class Stage, class Contacts>
  void set_flux_coefficients([[maybe_unused]] const Stage& stage,
                             [[maybe_unused]] const Contacts& contacts) {
    if constexpr (Fluxes::active) fluxes_.set_coefficients(stage.modules, contacts);
  }
  template <class Contacts>
  static CoefficientTable<ContactsType> coefficients_of(const Contacts& contacts) {
    return coefficient_table<ContactsType>(contacts);
  }

  /// Moves the last `more` rows, which were just added, in front of the ghosts. The next step runs
  /// a search.
  void join_own(std::size_t more) requires(Composition::has_ranks);
  /// Adds the new rows, from `first` on, to the lists.
  void join_lists(const Domain& domain, double time_step, std::size_t first);
  /// Adds pairs whose bonds have just broken to the lists. The present overlap of these pairs is
  /// excluded from their contacts.
  void join_pairs(const Domain& domain, double time_step, std::span<const IndexPair> pairs);
  /// The row of the sphere with this id, which may be a ghost; the number of rows if there is none.
  std::size_t row_of(ParticleId id) const;
  /// Load sums of the rows, 4 * chunks Scalars each; valid between contacts and integration.
  Scalar* load_sums() { return sums_.data(); }
  /// Removes the particle at place k; may be called at any time, unlike park(), which is allowed
  /// only just before a pruning.
  void remove(std::size_t k, const Domain& domain, double time_step) {
    remove_all({&k, 1}, domain, time_step);
  }
  /// The same for several places.
  void remove_all(std::span<const std::size_t> places, const Domain& domain, double time_step);
  /// Ends all contacts of ghosts whose particles were removed on their owning ranks; is_gone(id)
  /// identifies these particles.
  template <class IsGone>
  void park_ghosts(const IsGone& is_gone) requires(Composition::has_ranks);
  /// Sets the radius [m] of the particle at place k; for a body, that of its bounding sphere.
  void set_radius(std::size_t k, double radius, const Domain& domain, double time_step);
  void set_material(std::size_t k, std::size_t material) {
    Tables<Composition>::set_material(k, static_cast<std::uint16_t>(material));
    lists.follow_change();
  }
  /// Must be called after the velocity of the particle at place k was changed.
  void follow_change(std::size_t k) {
    this->follow_motion(k);
    if constexpr (!of_bodies) include_share(k);  // for bodies it is computed in drift()
  }
  /// Prunes or searches if the lists are no longer valid, and updates all data derived from them.
  void renew_lists(Search& search, const Domain& domain, std::int64_t step, double time_step);

  // --- forces -------------------------------------------------------------------------------

  /// Fluxes of modules through contacts: prepared before the contacts of a step, collected after
  /// them.
  template <class Stage>
  void prepare_fluxes(const Stage& stage, double time, FluxLook look);
  void collect_fluxes();
  /// The same for ghosts, once their state has arrived.
  void prepare_ghost_fluxes(double time) requires(Composition::has_ranks);

  const Fluxes& fluxes() const { return fluxes_; }
  Fluxes& fluxes() { return fluxes_; }

  void pair_forces(const Domain& domain, const StepTimes& times);
  /// Forces between owned spheres and ghosts, once the state of the ghosts has arrived.
  void ghost_forces(const Domain& domain, const StepTimes& times) requires(Composition::has_ranks);
  template <PairsOf Which>
  Tally<ContactsType> sphere_pairs(const Domain& domain, const StepTimes& times);
  void take(const Tally<ContactsType>& tally);

  void wall_forces(const StepTimes& times);
  /// Adds the tally of further contacts to that of the step.
  template <class MoreTally>
  void include(const MoreTally& tally);

  /// Power [W] of contact forces on prescribed (fixed) particles that move; call before loads are
  /// integrated.
  double power_on_fixed() const {
    return detail::power_on_fixed<ContactsType>(particles, sums_.data());
  }

  /// [kg m] Mass times displacement of particles wrapped into a periodic box since the last call.
  Vec3d take_wrapped() {
    Vec3d all = std::exchange(lists.wrapped, Vec3d{0, 0, 0});
    if constexpr (of_bodies) all += std::exchange(mover.wrapped, Vec3d{0, 0, 0});
    return all;
  }

  std::optional<CrowdedContact> crowded() const {
    return walls.empty() ? std::nullopt : wall_pipeline_.crowded();
  }

  /// Kicks driven walls for `kick_time` [s] by the loads of this step (push_wall()). With several
  /// ranks the loads of all ranks must have been summed before.
  void push_walls(const Vec3d& gravity, double kick_time, double time_step, bool first_kick);
  /// Records the contact stiffness at this rank's servo walls, which push_walls() needs; must be
  /// called before particles move on.
  void look_at_servos() requires(Composition::has_ranks);
  /// Must be called after modules that act in pairs may have been given another reach: if it is
  /// longer, the next step searches, for more ghosts.
  template <class Stage>
  void follow_reach(const Stage& stage) requires(Composition::has_ranks);
  // --- integration --------------------------------------------------------------------------

  using Advance = detail::Advance;

  /// Kicks particles for `kick_time` [s] by their loads and drifts them for `time_step` [s]. For an
  /// observed step it stops between kick and drift and records the state at the whole step
  /// (kick_time: time since then).
  void integrate(Advance how, const Vec3d& gravity, double kick_time, double time_step,
                 bool first_kick);
  /// Runs `work`, which may set `observed`, on all ranks (collective). Afterwards every rank knows
  /// the largest speed and overlap over all ranks; if one rank has thrown, all ranks throw.
  template <class Work>
  void together(const char* call, double time_step, const bool& observed,
                const Work& work) requires(Composition::has_ranks);
  void agree(const char* call,
             const std::exception_ptr& error = nullptr) requires(Composition::has_ranks);
  /// Starts sending ghosts the positions and velocities of their owning ranks.
  void refresh_ghosts() requires(Composition::has_ranks) { ranks.begin_refresh(particles, mover); }
  /// Starts the update of ghosts and waits for it. Used between kick and drift of an observed step,
  /// when ghosts lag by one kick.
  void refresh_ghosts_now() requires(Composition::has_ranks) {
    refresh_ghosts(), ranks.finish_refresh(particles, mover);
  }
  /// Prepares a time step that is `ratio` times as long; call after an observed state.
  void change_step(double ratio) {
    mover.change_step(particles, ratio);
    for (auto& wall : walls) change_wall_step(wall, ratio);
    particles.renew_pair_motion(*team_);
  }
  /// Informs the lists of velocities that were changed between kick and drift.
  void include_speeds() {
    for (std::size_t k = 0; !of_bodies && k < particles.size(); ++k) include_share(k);
  }
  /// Completes a step that was observed.
  void drift(double time_step);

  // --- deforming box ------------------------------------------------------------------------

  /// Chooses the box's rates for the next step and changes particle velocities accordingly.
  void kick_box(Domain& box, double time_step, bool first, bool observed);
  /// Corrects the recorded velocities to the present time, after an observed kick.
  void record_flow(const Domain& box);
  /// Deforms the box by one step, after the particles have drifted.
  void move_box(Domain& box, double time_step);

  /// [-] that overlap. A pair shared by two ranks is counted by the owner of its first particle.
  std::size_t touching_pairs(const Domain& domain) const;
  /// [m] radius of the smallest sphere, or of the smallest inscribed sphere of the convex bodies.
  double least_radius() const {
    if constexpr (convex)
      return mover.convex_rows.least_radius;
    else
      return particles.smallest_radius;
  }
  /// The contact force [N] on particle k; valid before the loads are integrated.
  Vec3d contact_force(std::size_t k) const;
  const Team& team() const { return *team_; }
  /// Completes a state restored from a checkpoint.
  void restored(double speed, double overlap, double share) {
    largest_speed = speed, largest_overlap = overlap, largest_share = share;
    record.forget();
    this->forget_places();
    if constexpr (of_ranks) ghosts_of_ = std::numeric_limits<std::uint64_t>::max();
    lists.restored();
    offsets_ |= any_offset<ContactsType>(lists.pairs);
  }

  std::size_t bytes() const {
    return particles.position.capacity() * sizeof(PositionRow) +
           particles.motion.capacity() * sizeof(ParticleMotion) +
           sums_.capacity() * sizeof(Scalar) + lists.bytes();
  }

 private:
  void include_share(std::size_t row) {
    const auto& per_inner2 = lists.upkeep.per_inner2;
    if (row >= per_inner2.size()) return;  // the next step searches anyway
    const Vec3d v = particles.motion[row].velocity();
    largest_share = std::max(largest_share, std::sqrt(dot(v, v) * per_inner2[row]));
  }
  /// The present input of the lists.
  typename Lists::Scene scene(const Domain& domain, double time_step) {
    return {particles, walls,     domain,
            *team_,    time_step, largest_range(coefficients, particles.largest_radius),
            ranks,     mover};
  }
  /// Whether body speeds are measured relative to the mean velocity that all ranks have agreed on.
  /// A single rank uses the mean of the step, as a single process does.
  bool has_agreed_mean() const {
    if constexpr (of_ranks)
      return ranks.size() > 1;
    else
      return false;
  }
  /// Ghosts are kicked on their own ranks.
  void forget_loads_of_ghosts() {
    std::fill(sums_.begin() + static_cast<std::ptrdiff_t>(particles.owned() * 4 * chunks),
              sums_.begin() + static_cast<std::ptrdiff_t>(particles.size() * 4 * chunks),
              Scalar(0));
  }
  void note(const ContactNotes& notes);

  // [bytes] Prefetching pays off above this size, which exceeds second-level caches and a fair
  // share of a last-level cache.
  static constexpr std::size_t beyond_caches = 4 << 20;

  // Pairs with ghosts are computed after the others, except for bodies: SharedContacts needs all
  // pairs at once.
  static constexpr bool apart = of_ranks && !of_bodies;
  static constexpr bool shares = of_bodies && !convex;
  const Scalar* share_pairs(const Domain& domain);
  const SharedContacts<Scalar>* share_walls();
  auto wall_input(const StepTimes& times);
  const PartRow* parts() const {
    if constexpr (of_bodies)
      return particles.part.data();
    else
      return nullptr;
  }

  std::unique_ptr<Team> team_ = std::make_unique<Team>(1);
  WallStage wall_pipeline_;
  [[no_unique_address]] Fluxes fluxes_;
  struct NoShares {};
  [[no_unique_address]] std::conditional_t<shares, SharedContacts<Scalar>, NoShares> shared_;
  struct NoRows {};
  [[no_unique_address]] mutable std::conditional_t<
      of_ranks, std::unordered_map<ParticleId, std::size_t>, NoRows>
      ghost_rows_;
  [[no_unique_address]] mutable std::conditional_t<of_ranks, std::uint64_t, NoGhosts> ghosts_of_{};
  struct NoKick {};
  [[no_unique_address]] std::conditional_t<deforms<Domain>, DeformingBox::Kick, NoKick> box_kick_{};
  AlignedVector<Scalar> sums_;  // [N] load on each particle; zero between steps
  DynArray<std::uint16_t> kinds_;
  bool offsets_ = Composition::has_breakage;  // some pairs may have an offset (WithOffset)
};

template <class Composition>
Engine<Composition>::Engine() {}
template <class Composition>
Engine<Composition>::~Engine() {}

}  // namespace silt::detail

#include <silt/engine/contact_forces.hpp>
#include <silt/engine/integration.hpp>
#include <silt/engine/on_many_ranks.hpp>
#include <silt/engine/renew_lists.hpp>
