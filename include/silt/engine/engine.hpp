// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <vector>

#include <silt/engine/advance/box_flow.hpp>
#include <silt/engine/advance/power_on_fixed.hpp>
#include <silt/engine/advance/tables.hpp>
#include <silt/engine/advance/wall_motion.hpp>
#include <silt/engine/checks/wall_stiffness.hpp>
#include <silt/engine/contact/begin_contacts.hpp>
#include <silt/engine/contact/contact_memory.hpp>
#include <silt/engine/contact/pair_kinds_of.hpp>
#include <silt/engine/lists/near_lists.hpp>
#include <silt/engine/spheres/pair_pipeline.hpp>
#include <silt/engine/stages_of_shape.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The state of a simulation and the stages of its step, each a plain function of state. Knows the
/// policies, but neither observers nor files nor the order of the stages: that is Simulation's.
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
  static constexpr std::size_t history = ContactsType::history;  // Reals of a contact
  static constexpr ContactMemory<ContactsType> memory{};
  static_assert(memory.is_whole());
  using Scalar = typename Composition::Scalar;  // of the work on pairs
  static constexpr bool predicts = Integrator::derivatives > 0;
  static constexpr bool of_ranks = Composition::has_ranks;
  static constexpr bool of_bodies = Composition::of_bodies;  // rows are parts of them
  static constexpr bool convex = Composition::has_surfaces;  // with narrow phases of their own
  using Modules = typename Composition::Modules;
  using typename Tables<Composition>::State, typename Tables<Composition>::Mover;
  using Tables<Composition>::particles, Tables<Composition>::mover;
  using ParticleMotion = typename State::ParticleMotion;
  using Fluxes = FluxesOf<Modules, Arch, Scalar>;
  using WallStage =
      typename WallStageOf<convex>::template type<ShapeType, ContactsType, Arch, Scalar, Fluxes,
                                                  Domain::periodic && !deforms<Domain>>;
  using Lists = NearLists<ContactsType::history, history_in_rows<ContactsType>, Scalar, State,
                          Search, Domain, Arch, typename WallStage::Contacts, Mover>;

  std::vector<Wall> walls;
  [[no_unique_address]] RankStage<typename Composition::Ranks> ranks;
  Lists lists;
  CoefficientTable<ContactsType> coefficients;
  double largest_speed = 0;      // [m/s] of surfaces: Pace
  double largest_share = 0;      // [1/s] largest speed over inner reach
  double largest_overlap = 0;    // [-] over the smaller radius, in the last step
  bool finite = true;            // all velocities, after the last kick
  bool share_contacts = true;    // of bodies: SharedContacts
  ContactRecord record;          // of the last step, if somebody asks
  std::uint64_t safeguards = 0;  // [-] in which a law's safeguard has acted, since the start
  [[no_unique_address]] VirialOf<ContactsType> virial;  // of the last step
  EnergyOf<ContactsType, double> contact_energy = start_energy<ContactsType, double>();
  static constexpr bool has_events = keeps_events<ContactsType>;
  [[no_unique_address]] ImpactsOf<ContactsType> impacts;  // of the last step
  double parted = 0;                                      // [J] likewise
  [[no_unique_address]] std::conditional_t<has_events, ContactLog, NoContactLog> events;

  struct NoBreaks {};
  struct NoDue {};
  /// On many ranks whether bonds break in this step, on any of them.
  [[no_unique_address]] std::conditional_t<of_ranks && Composition::has_bonds, bool, NoBreaks>
      bonds_break{};
  /// ... whether particles are due to break.
  [[no_unique_address]] std::conditional_t<of_ranks && Composition::has_breakage, bool, NoDue>
      breaks_due{};

  void set_threads(int threads) {
    if (!team_ || team_->threads() != threads) team_ = std::make_unique<Team>(threads);
  }

  template <class Contacts>
  void set_coefficients(const Contacts& contacts) {
    coefficients = coefficients_of(contacts);
  }
  /// Likewise of what flows through contacts for modules.
  template <class Stage, class Contacts>
  void set_flux_coefficients([[maybe_unused]] const Stage& stage,
                             [[maybe_unused]] const Contacts& contacts) {
    if constexpr (Fluxes::active) fluxes_.set_coefficients(stage.modules, contacts);
  }
  template <class Contacts>
  static CoefficientTable<ContactsType> coefficients_of(const Contacts& contacts) {
    return coefficient_table<ContactsType>(contacts);
  }

  /// Brings the last `more` rows, which have just come, in front of the ghosts. The next step
  /// searches.
  void join_own(std::size_t more) requires(of_ranks) {
    const std::size_t own = particles.owned() - more, ghosts = particles.ghosts;
    std::vector<std::uint32_t> order(particles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::rotate(order.begin() + static_cast<std::ptrdiff_t>(own),
                order.end() - static_cast<std::ptrdiff_t>(more), order.end());
    if (more > 0 && ghosts > 0) particles.reorder(order, *team_);
    lists.pairs.make_way(own, more, particles.size()), ranks.make_way(more);
    if constexpr (of_bodies)
      if (more > 0 && ghosts > 0) {
        mover.follow(particles), follow_bodies(ranks.neighbours, particles);
        if (!mover.synchronous.empty()) mover.synchronous.resize(mover.owned());
      }
    lists.forget();
  }
  /// Takes the rows from `first` on, which have just come, into the lists.
  void join_lists(const Domain& domain, double time_step, std::size_t first) {
    lists.join(scene(domain, time_step), first);
    for (std::size_t row = first; row < particles.size(); ++row) include_share(row);
  }
  /// Takes in pairs that bonds held so far: what they overlap by now is left out of their contacts.
  void join_pairs(const Domain& domain, double time_step, std::span<const IndexPair> pairs) {
    std::array<Scalar, ContactsType::history> start{};
    start[ContactsType::offset_from] = static_cast<Scalar>(whole_overlap);
    lists.join_pairs(scene(domain, time_step), pairs, start), offsets_ = true;
  }
  /// The row of a sphere, its own or a ghost's; as many as there are rows where there is none.
  std::size_t row_of(ParticleId id) const {
    const std::size_t k = this->find(id);
    if constexpr (of_ranks) {
      if (k < this->owners()) return k;
      if (ghosts_of_ != particles.changes) {
        ghost_rows_.clear(), ghosts_of_ = particles.changes;
        for (std::size_t row = particles.owned(); row < particles.size(); ++row)
          ghost_rows_[particles.id[row]] = row;
      }
      const auto found = ghost_rows_.find(id);
      // One that was removed stands there until the next search.
      if (found == ghost_rows_.end() || particles.id[found->second] != id) return particles.size();
      return found->second;
    }
    return k;
  }
  /// Loads on the rows, 4 * chunks Scalars each, between the contacts and the integration.
  Scalar* load_sums() { return sums_.data(); }
  /// Takes the particle at place k away at any time; park() alone is for just before a pruning.
  void remove(std::size_t k, const Domain& domain, double time_step) {
    remove_all({&k, 1}, domain, time_step);
  }
  /// Likewise those at several places.
  void remove_all(std::span<const std::size_t> places, const Domain& domain, double time_step) {
    std::vector<std::uint32_t> rows;
    for (const std::size_t k : places) {
      if constexpr (of_bodies) {
        const auto of = mover.rows_of(mover.bodies[k]);
        rows.insert(rows.end(), of.begin(), of.end());
      } else {
        rows.push_back(static_cast<std::uint32_t>(k));
      }
      this->park(k);
    }
    if constexpr (Fluxes::active) fluxes_.renew();
    if (!rows.empty()) lists.leave(scene(domain, time_step), rows);
  }
  /// Takes ghosts out of all contacts whose particles, by their ids, are gone on their own ranks.
  template <class IsGone>
  void park_ghosts(const IsGone& is_gone) requires(of_ranks) {
    const std::size_t parked = particles.parked;
    std::size_t end = particles.size();
    if constexpr (of_bodies) end = mover.bodies.size();
    for (std::size_t k = this->owners(); k < end; ++k)
      if (const ParticleId id = this->owner(k).id(); id != no_particle && is_gone(id))
        this->park(k);
    particles.parked = parked;  // which counts own ones
  }
  /// Gives the particle at place k another radius [m], of bodies that of the bounding sphere.
  void set_radius(std::size_t k, double radius, const Domain& domain, double time_step) {
    Tables<Composition>::set_radius(k, radius, [&](std::size_t row, double growth, double way) {
      lists.follow_growth(scene(domain, time_step), row, growth, growth + way);
      include_share(row);
    });
    if constexpr (of_bodies) lists.follow_change();
  }
  void set_material(std::size_t k, std::size_t material) {
    Tables<Composition>::set_material(k, static_cast<std::uint16_t>(material));
    lists.follow_change();
  }
  /// After the motion of the particle at place k was changed.
  void follow_change(std::size_t k) {
    this->follow_motion(k);
    if constexpr (!of_bodies) include_share(k);  // bodies measure it when they drift
  }
  /// Renews what is stale of the lists, and what follows from them.
  void renew_lists(Search& search, const Domain& domain, std::int64_t step, double time_step) {
    if constexpr (of_ranks)
      if (!lists.hold(walls)) ranks.finish_refresh(particles, mover);
    lists.renew(scene(domain, time_step), search, step);
    if constexpr (Composition::has_bonds) begin_freed_at_walls(*this, ContactsType::offset_from);
    if (!lists.take_renewed()) return;
    if constexpr (of_bodies)
      if (lists.upkeep.searched_at == step) {
        this->follow(domain);
        if constexpr (of_ranks) follow_bodies(ranks.neighbours, particles);
      }
    if constexpr (shares) shared_.renew(lists.pairs, particles, mover.bodies.size());
    if constexpr (convex) {
      mover.renew_convex_rows(particles);
      if constexpr (of_ranks)
        ranks.meet("a look at bodies"), agree_on_convex_rows(ranks, particles, mover);
      lists.pairs.use_more_history(mover.convex_rows.has_area());
    }
    if constexpr (ContactsType::several_materials)
      make_kinds(lists.pairs, particles.material, coefficients.materials, *team_, kinds_);
    sums_.resize(particles.size() * 4 * chunks, 0);  // all zero between the steps
    particles.renew_pair_motion(*team_);
  }

  // --- forces -------------------------------------------------------------------------------

  /// Before the contacts of a step, and after them: what flows through them for modules.
  template <class Stage>
  void prepare_fluxes([[maybe_unused]] const Stage& stage, [[maybe_unused]] double time,
                      [[maybe_unused]] FluxLook look) {
    if constexpr (Fluxes::active || Fluxes::wears)
      fluxes_.prepare(
          stage.modules, this->modules(), particles.owned(),
          {time, walls.size(), look != FluxLook::Hold, look == FluxLook::Measure},
          [this](std::size_t row) { return this->owner_of(row); },
          [this, time](std::size_t k) { return this->seen(k, time); }, *team_);
  }
  void collect_fluxes() {
    if constexpr (Fluxes::active) {
      const auto owner_of = [this](std::size_t row) { return this->owner_of(row); };
      if constexpr (of_ranks)
        fluxes_.collect(this->modules(), particles.owned(), owner_of, [this](double own) {
          ranks.meet("what a wall gives");
          ranks.sum_of({&own, 1});
          return own;
        });
      else
        fluxes_.collect(this->modules(), particles.size(), owner_of, nullptr);
    }
  }
  /// When the ghosts have come: what flows to and from them.
  void prepare_ghost_fluxes([[maybe_unused]] double time) requires(of_ranks) {
    if constexpr (Fluxes::active)
      fluxes_.prepare_ghosts(
          this->modules(), particles.owned(), particles.size(),
          [this](std::size_t row) { return this->owner_of(row); },
          [this, time](std::size_t k) { return this->seen(k, time); }, *team_);
  }

  const Fluxes& fluxes() const { return fluxes_; }
  Fluxes& fluxes() { return fluxes_; }

  void pair_forces(const Domain& domain, const StepTimes& times) {
    if constexpr (of_ranks && !apart)
      ranks.finish_refresh(particles, mover), prepare_ghost_fluxes(times.now);
    if constexpr (convex) {
      using Pairs =
          ConvexPairs<typename ConvexRowsOf<ShapeType>::type, ContactsType, Domain, Arch, Fluxes>;
      mover.convex_rows.measure_pace(particles.motion.data(), *team_, has_agreed_mean());
      return take(Pairs::run({particles.position.data(), particles.motion.data(),
                              &mover.convex_rows, kinds_.data(), particles.material.data(), times},
                             lists.pairs, coefficients, domain, sums_.data(), *team_, &fluxes_));
    } else {
      constexpr PairsOf first = apart ? PairsOf::Own : PairsOf::All;
      take(sphere_pairs<first>(domain, times));
    }
  }
  /// The same of spheres' pairs with ghosts, when these have come.
  void ghost_forces(const Domain& domain, const StepTimes& times) requires(of_ranks) {
    if constexpr (apart) {
      ranks.finish_refresh(particles, mover);
      prepare_ghost_fluxes(times.now);
      if (particles.ghosts > 0) include(sphere_pairs<PairsOf::Ghosts>(domain, times));
    }
  }
  template <PairsOf Which>
  Tally<ContactsType> sphere_pairs(const Domain& domain, const StepTimes& times) {
    using Pipeline = PairPipeline<ContactsType, Domain, Arch, Scalar, Fluxes>;
    const bool large = Pipeline::working_set(particles.size(), lists.pairs.size()) > beyond_caches;
    return Pipeline::template run<Which>(
        {particles.position.data(), particles.pair_motion(), kinds_.data(),
         particles.largest_radius, particles.smallest_radius, times, large, share_pairs(domain),
         &fluxes_, offsets_},
        lists.pairs, coefficients, domain, sums_.data(), *team_);
  }
  void take(const Tally<ContactsType>& tally) {
    largest_overlap = tally.largest, contact_energy = tally.energy;
    safeguards += tally.safeguards;
    if constexpr (has_events) events.clear(), note(tally.notes);
    if constexpr (Composition::has_breakage) impacts.add(tally.impacts), parted += tally.parted;
    if constexpr (deforms<Domain>) virial = tally.virial;
  }

  void wall_forces(const StepTimes& times) {
    if (walls.empty()) return;
    include(wall_pipeline_.run(wall_input(times), lists.walls, coefficients, walls, sums_.data(),
                               *team_));
  }
  /// Adds what is known of more contacts.
  template <class MoreTally>
  void include(const MoreTally& tally) {
    largest_overlap = std::max(largest_overlap, tally.largest);
    contact_energy.add(tally.energy);
    safeguards += tally.safeguards;
    if constexpr (has_events) note(tally.notes);
    if constexpr (Composition::has_breakage) impacts.add(tally.impacts), parted += tally.parted;
  }

  /// Power [W] of the contacts on fixed particles that move, before the loads are integrated.
  double power_on_fixed() const {
    return detail::power_on_fixed<ContactsType>(particles, sums_.data());
  }

  std::optional<CrowdedContact> crowded() const {
    return walls.empty() ? std::nullopt : wall_pipeline_.crowded();
  }

  /// The kick of driven walls over `kick_time` [s] by the loads of this step; see push_wall(). On
  /// many ranks by those of all, when these are known.
  void push_walls(const Vec3d& gravity, double kick_time, double time_step, bool first_kick) {
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (walls[w].is_driven()) {
        if (is_servo(walls[w].drive))
          look_at_stiffness(walls[w], [&](const LinearContact& of_liquid) {
            if constexpr (of_ranks)
              return LinearContact{ranks.of_servos[w][0], ranks.of_servos[w][1]};
            else
              return linear_of_servo(*this, w, of_liquid);
          });
        push_wall(walls[w], gravity, kick_time, time_step, first_kick);
      }
  }
  /// Before particles move on: what push_walls() will need of the contacts of this rank.
  void look_at_servos() requires(of_ranks) {
    ranks.of_servos.assign(walls.size(), {});
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (is_servo(walls[w].drive)) {
        const LinearContact own = linear_of_servo(*this, w);
        ranks.of_servos[w] = {own.k, own.c};
      }
  }
  // --- integration --------------------------------------------------------------------------

  using Advance = detail::Advance;

  /// Kicks the particles for `kick_time` [s] by their loads, and lets them drift for `time_step`
  /// [s]; or stops between kick and drift and records the state at the whole step (kick_time: since
  /// then).
  void integrate(Advance how, const Vec3d& gravity, double kick_time, double time_step,
                 bool first_kick) {
    if constexpr (of_ranks) forget_loads_of_ghosts();
    const auto pace =
        mover.integrate({particles, sums_.data(), lists.upkeep.per_inner2.data(), *team_}, how,
                        {gravity, kick_time, time_step, first_kick});
    largest_speed = pace.largest_speed, largest_share = pace.largest_share, finite = pace.finite;
    if (how == Advance::KickAndDrift && !deforms<Domain> && !of_ranks)
      lists.upkeep.used += largest_share * time_step;
  }
  /// Does a step's work, which may find that observers see it, on all ranks or on none; then all
  /// know of each other's speeds and overlaps, or throw what one has thrown (collective).
  template <class Work>
  void together(const char* call, double time_step, const bool& observed,
                const Work& work) requires(of_ranks) {
    std::exception_ptr error;
    try {
      work();
    } catch (...) {
      error = std::current_exception();
    }
    agree(call, error);
    ranks.share_loads(walls, observed);
    if (!observed) lists.upkeep.used += largest_share * time_step;
  }
  void agree(const char* call, const std::exception_ptr& error = nullptr) requires(of_ranks) {
    std::array<double, 7> most{largest_speed,
                               largest_share,
                               largest_overlap,
                               lists.upkeep.searched_at < 0 ? 1.0 : 0.0,
                               0.0,
                               0.0,
                               0.0};
    if constexpr (Fluxes::active) most[4] = fluxes_.is_to_renew() ? 1.0 : 0.0;
    if constexpr (Composition::has_bonds) most[5] = bonds_break ? 1.0 : 0.0;
    if constexpr (Composition::has_breakage) most[6] = breaks_due ? 1.0 : 0.0;
    ranks.agree(call, error, most);
    if constexpr (Composition::has_bonds) bonds_break = most[5] > 0;
    if constexpr (Composition::has_breakage) breaks_due = most[6] > 0;
    largest_speed = most[0], largest_share = most[1], largest_overlap = most[2];
    if (most[3] > 0) lists.forget();
    if constexpr (Fluxes::active)
      if (most[4] > 0) fluxes_.renew();
  }
  /// Begins to give the ghosts the places and motions that they have on their own ranks.
  void refresh_ghosts() requires(of_ranks) { ranks.begin_refresh(particles, mover); }
  /// ... and ends: between kick and drift of a step that is observed, where ghosts are a kick
  /// behind.
  void refresh_ghosts_now() requires(of_ranks) {
    refresh_ghosts(), ranks.finish_refresh(particles, mover);
  }
  /// After an observed state: the step will be `ratio` times as long.
  void change_step(double ratio) {
    mover.change_step(particles, ratio);
    for (auto& wall : walls) change_wall_step(wall, ratio);
    particles.renew_pair_motion(*team_);
  }
  /// After velocities have changed between kick and drift, so that the lists know.
  void include_speeds() {
    for (std::size_t k = 0; !of_bodies && k < particles.size(); ++k) include_share(k);
  }
  /// Completes a step that was observed.
  void drift(double time_step) {
    // Particles that were added since the lists were made have no reach: a search comes next.
    const auto& reach = lists.upkeep.per_inner2;
    const double* const per_inner2 = reach.size() < particles.size() ? nullptr : reach.data();
    largest_share =
        mover.drift({particles, sums_.data(), per_inner2, *team_}, time_step, largest_share);
    if constexpr (of_ranks) agree("a drift");
    if constexpr (!deforms<Domain>) lists.upkeep.used += largest_share * time_step;
  }

  // --- a box that deforms -------------------------------------------------------------------

  /// Gives the box the rates of the next step, and the particles what these change.
  void kick_box(Domain& box, double time_step, bool first, bool observed) {
    box_kick_ = box.choose_rates({virial, largest_overlap}, time_step, first);
    add_flow(particles, box_kick_.all, box.centre(), *team_);
    if (!observed) box_kick_ = {};
  }
  /// After an observed kick: what was recorded is the velocity of this instant.
  void record_flow(const Domain& box) {
    for (std::size_t k = 0; k < particles.size(); ++k)
      if (!particles.is_parked(k))
        mover.synchronous[k].velocity -=
            box_kick_.too_much * (particles.position[k].centre() - box.centre());
  }
  /// After the particles have drifted for a step.
  void move_box(Domain& box, double time_step) {
    const auto& reach = lists.upkeep.per_inner2;
    const auto pace =
        pace_in_flow(particles, box, reach.size() < particles.size() ? nullptr : reach.data(),
                     time_step, *team_);
    box.set_kinetic(pace.kinetic, pace.mass);
    const double s = 1 - time_step * box.squeeze_rate();
    lists.flow.follow(box.advance(time_step), s);
    lists.upkeep.used += pace.largest_share * time_step / lists.flow.pruned;
  }

  /// Of pairs of two ranks those whose first particle is of this one.
  std::size_t touching_pairs(const Domain& domain) const {
    std::size_t count = 0;
    lists.pairs.for_each([&](std::size_t k) {
      if constexpr (of_ranks)
        if (lists.pairs.first()[k] >= particles.owned()) return;
      if constexpr (convex)
        count += lists.pairs.history(ContactsType::memory_radius, k) > 0;
      else
        count += within_reach(particles.position[lists.pairs.first()[k]],
                              particles.position[lists.pairs.second()[k]], 0, domain);
    });
    return count;
  }
  /// [m] of the smallest sphere, or of the largest one inside the thinnest convex body.
  double least_radius() const {
    if constexpr (convex)
      return mover.convex_rows.least_radius;
    else
      return particles.smallest_radius;
  }
  /// Of contacts on particle k [N], before the loads are integrated.
  Vec3d contact_force(std::size_t k) const {
    const auto of = [&](std::size_t row) { return load_part<chunks>(sums_.data(), row, 0); };
    if constexpr (of_bodies) {
      Vec3d sum{0, 0, 0};
      for (const std::uint32_t row : mover.rows_of(mover.bodies[k])) sum += of(row);
      return sum;
    } else {
      return of(k);
    }
  }
  const Team& team() const { return *team_; }
  /// Completes a restored state.
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
    if (row >= per_inner2.size()) return;  // a search comes next
    const Vec3d v = particles.motion[row].velocity();
    largest_share = std::max(largest_share, std::sqrt(dot(v, v) * per_inner2[row]));
  }
  /// What the lists are of, now.
  typename Lists::Scene scene(const Domain& domain, double time_step) {
    return {particles, walls,     domain,
            *team_,    time_step, largest_range(coefficients, particles.largest_radius),
            ranks,     mover};
  }
  /// On one rank that of the step is as good, and what one process takes.
  bool has_agreed_mean() const {
    if constexpr (of_ranks)
      return ranks.size() > 1;
    else
      return false;
  }
  /// They are kicked on their own ranks.
  void forget_loads_of_ghosts() {
    std::fill(sums_.begin() + static_cast<std::ptrdiff_t>(particles.owned() * 4 * chunks),
              sums_.begin() + static_cast<std::ptrdiff_t>(particles.size() * 4 * chunks),
              Scalar(0));
  }
  void note(const ContactNotes& notes) {
    const auto id_of = [this](std::size_t row) {
      return particles.is_parked(row) ? no_particle : this->id_of(row);
    };
    if constexpr (of_ranks)
      events.take(notes, id_of, [this](std::size_t row) { return row < particles.owned(); });
    else
      events.take(notes, id_of);
  }

  // From here on fetching ahead has paid: more than second-level caches hold, and than one may
  // count on of a last-level cache that others use too.
  static constexpr std::size_t beyond_caches = 4 << 20;

  // Pairs with ghosts come behind the others; what bodies share of contacts needs them all.
  static constexpr bool apart = of_ranks && !of_bodies;
  static constexpr bool shares = of_bodies && !convex;
  const Scalar* share_pairs([[maybe_unused]] const Domain& domain) {
    if constexpr (shares)
      if (share_contacts) {
        shared_.share_pairs(lists.pairs, particles, domain, energy_exponent<ContactsType>, *team_);
        return shared_.shares();
      }
    return nullptr;
  }
  const SharedContacts<Scalar>* share_walls() {
    if constexpr (shares)
      if (share_contacts) {
        shared_.share_walls(*this, energy_exponent<ContactsType>);
        return &shared_;
      }
    return nullptr;
  }
  auto wall_input(const StepTimes& times) {
    using Input = typename WallStage::Input;
    if constexpr (convex) {
      wall_pipeline_.fluxes = &fluxes_;
      return Input{particles.position.data(), particles.motion.data(),
                   &mover.convex_rows,        nullptr,
                   particles.material.data(), times};
    } else
      return Input{particles.position.data(),
                   particles.motion.data(),
                   particles.pair_motion(),
                   particles.material.data(),
                   times,
                   parts(),
                   share_walls(),
                   &fluxes_};
  }
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
  AlignedVector<Scalar> sums_;  // [N] load on each particle, zero between the steps
  std::vector<std::uint16_t> kinds_;
  bool offsets_ = Composition::has_breakage;  // of pairs: there may be some (WithOffset)
};

}  // namespace silt::detail
