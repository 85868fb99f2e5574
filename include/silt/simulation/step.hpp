// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation: the time loop, and one time step with its stages (docs/architecture.md says
// where each stage is implemented).

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
template <class... Observers>
void Simulation<Policies...>::run_steps(double duration, Observers&... observers) {
  // What is left of a time, after a run that ended up to a step behind it.
  if (duration < 0 && duration > -dt_) duration = 0;
  require(std::isfinite(duration) && duration >= 0, "Simulation::run: duration = ", duration,
          " [s] must be finite and not negative; the time is ", time_, " s already");
  prepare();
  struct Running {
    bool& now;
    ~Running() { now = false; }
  };
  const Running running{running_};
  running.now = true;
  const double end = time_ + duration;
  std::int64_t last = step_ + static_cast<std::int64_t>(std::ceil(duration / dt_ * (1 - 1e-12)));
  if constexpr (has_events) engine_.events.wanted = (detail::wants_events(observers) || ...);
  const auto begin = [&] { (detail::begin(observers, *this, end), ...); };
  if constexpr (has_ranks)
    this->share_edits("the start of observers", begin);
  else
    begin();
  for (;; ++step_, time_ = time_at(step_)) {
    const bool stop = step_ >= last;
    if (!kicked_) {
      kept_ = std::max({detail::all_contacts_if(stop && keep_contacts),
                        detail::read_contacts(observers, *this, keep_contacts)...});
      advance(stop || (detail::is_due(observers, *this) || ...));
      if constexpr (has_events) detail::tell_of_rank(*this, engine_.events, observers...);
      if constexpr (has_bonds)
        if (!bonds_broken_.empty()) detail::tell_of_rank(*this, bonds_broken_, observers...);
      if constexpr (has_breakage)
        if (!breaks_.events.empty()) detail::tell_of_rank(*this, breaks_.events, observers...);
      if (step_ == 0) detail::started(*this, observers...);
    }
    detail::watch(*this, observers...);
    if (kicked_ && sizeof...(Observers) > 0) {
      [[maybe_unused]] const bool again = std::exchange(observed_, true);
      const auto observe = [&] {
        detail::observe_all(*this, again, observers...);
        detail::check_given(engine_, gravity, step_, time_);
        detail::check_limits(guard);
        modules_.check_given(engine_, step_, time_);
        book_gravity();
      };
      if constexpr (has_ranks)
        this->share_edits("observers", observe);
      else
        observe();
      if (scene_changed_) this->check_pairs();
    }
    if (stop) break;
    if (kicked_ && follow_time_step(sizeof...(Observers) > 0)) last = last_step(end);
    finish_step();
  }
  detail::on_all_ranks(*this, "the end of observers",
                       [&] { (detail::end(observers, *this), ...); });
  continued_ = false;
}

/// One time step: up to the kick, and on to the drift unless observers look at the step.
template <class... Policies>
void Simulation<Policies...>::advance(bool observed) {
  detail::move_walls(engine_.walls, time_, first_kick_ ? 0 : dt_);
  check_walls();
  if (first_kick_) detail::start_walls(engine_.walls, time_, dt_);
  std::size_t present = 0;
  if constexpr (Modules::flux) present = present_for_fluxes();
  bool looks = false;  // whether this step checks its own length
  const auto renew = [&] {
    openings_.update(engine_, *this);
    if constexpr (has_breakage) looks = this->break_due(), observed |= looks;
    renew_lists();
    if constexpr (has_ranks && has_breakage)  // weaker particles may have come from other ranks
      if (engine_.lists.upkeep.searched_at == step_) breaks_.measure(engine_);
    if constexpr (has_breakage)
      if (has_ranks ? breaks_.some_born : !breaks_.events.empty())
        detail::leave_out_overlaps(engine_, breaks_.newborn_from);
  };
  const auto act = [&] {
    forces(observed, present);
    first_kick_ = false;
    kicked_ = observed;
    if constexpr (has_bonds && !has_ranks) break_bonds();
    if (looks) follow_sizes();
    keep_limits();
  };
  if constexpr (has_ranks) {
    const bool first = first_kick_;
    [[maybe_unused]] const double checked = checked_speed_;  // [m/s]
    engine_.together(observed ? "a step that observers see" : "a step", dt_, observed,
                     [&] { renew(), act(); });
    peak_overlap_ = std::max(peak_overlap_, engine_.largest_overlap);
    if constexpr (has_breakage) {  // follow_sizes() starts from what one process has checked
      const double speed = std::max(engine_.largest_speed, detail::wall_travel(engine_) / dt_);
      checked_speed_ = speed > detail::checked_again * checked ? speed : checked;
    }
    if constexpr (Modules::flux)
      if (engine_.fluxes().measured()) choose_flux_steps();
    if constexpr (has_bonds)
      if (!looks) break_bonds_of_ranks();  // else follow_sizes() has done so
    engine_.push_walls(gravity, first ? first_wall_kick * dt_ : dt_, dt_, first);
    keep_rates_of_walls();
    if constexpr (has_ledger && !of_bodies)  // EndedContacts of edits
      if (observed) engine_.refresh_ghosts_now();
  } else {
    renew(), act();
  }
}

/// Prunes or searches if the lists are no longer valid.
template <class... Policies>
void Simulation<Policies...>::renew_lists() {
  if constexpr (has_ranks)  // even if this rank has failed: its neighbours wait for the ghosts
    engine_.refresh_ghosts(), engine_.ranks.throw_late();
  if constexpr (has_ranks && has_bonds) {
    detail::RankBonds at_search(bonds_, engine_);
    engine_.renew_lists(search_, domain_, step_, dt_);
  } else {
    engine_.renew_lists(search_, domain_, step_, dt_);
  }
}

template <class... Policies>
detail::StepTimes Simulation<Policies...>::times_of_step(bool observed) const {
  detail::StepTimes t{.step = dt_,
                      .worked = first_kick_ ? 0 : dt_,
                      .ask = observed || first_kick_ || step_ % detail::ledger_asks_every == 0,
                      .lag = Integrator::lag,
                      .now = time_,
                      .renew_areas = step_ % detail::StepTimes::areas_every == 0};
  if constexpr (has_breakage)
    t.parting = this->breakage().rules.separation_speed, t.weak_from = breaks_.weak_from;
  if constexpr (has_events) {
    constexpr int every = detail::StepTimes::look_at_rest_every;
    const int since = static_cast<int>(step_ % every);
    t.watched = engine_.events.wanted;
    t.look_at_rest = since == 0, t.since_look = since == 0 ? every : since;
    // Contacts come to rest only in steps that evaluate those; so no step counts twice.
    t.at_rest_from = time_at(step_ - since - detail::StepTimes::at_rest_after);
  }
  return t;
}

/// The forces of a step, and the integration.
template <class... Policies>
void Simulation<Policies...>::forces(bool observed, [[maybe_unused]] std::size_t present) {
  detail::StepTimes times = times_of_step(observed);
  times.record = engine_.record.begin(kept_, step_);
  engine_.prepare_fluxes(modules_, time_, look_at_fluxes(present));
  engine_.pair_forces(domain_, times);
  engine_.wall_forces(times);
  if constexpr (has_ranks) engine_.ghost_forces(domain_, times);
  if constexpr (has_breakage) breaks_.weigh(engine_, this->breakage(), time_);
  if constexpr (has_breakage && has_ranks) engine_.breaks_due = !breaks_.due.empty();
  [[maybe_unused]] double bond_power = 0;
  if constexpr (has_bonds)
    bond_power = bonds_.push(engine_, domain_, dt_, first_kick_ ? 0 : Integrator::lag * dt_);
  if constexpr (has_bonds && has_ranks) engine_.bonds_break = bonds_.any_broken();
  engine_.collect_fluxes();
  if constexpr (Modules::in_pairs) act_in_pairs();
  if constexpr (has_events) engine_.events.sort();
  if constexpr (Fluid::active) couple();
  if constexpr (Modules::push) push_modules();
  book_step(times, bond_power);
  using Advance = typename Engine::Advance;
  if constexpr (detail::deforms<Domain>) engine_.kick_box(domain_, dt_, first_kick_, observed);
  const double kick = first_kick_ ? Integrator::first_kick * dt_ : dt_;
  if constexpr (has_ranks)
    engine_.look_at_servos();  // they are kicked when the loads of all ranks are known
  else
    engine_.push_walls(gravity, first_kick_ ? first_wall_kick * dt_ : dt_, dt_, first_kick_);
  engine_.integrate(observed ? Advance::KickAndRecord : Advance::KickAndDrift, gravity, kick, dt_,
                    first_kick_);
  if constexpr (detail::deforms<Domain>)
    observed ? engine_.record_flow(domain_) : engine_.move_box(domain_, dt_);
}

/// The rest of a step after observers were called: the drift, and updates that follow from the
/// motion.
template <class... Policies>
void Simulation<Policies...>::finish_step() {
  if (kicked_) engine_.drift(dt_);
  if constexpr (has_bonds) bonds_.turn(engine_, dt_);
  if constexpr (detail::deforms<Domain>)
    if (kicked_) engine_.move_box(domain_, dt_);
  // As observers may have changed the parameters of modules, or added a wall of a new material.
  if (kicked_) engine_.set_flux_coefficients(modules_, contacts_);
  if constexpr (has_ranks && Modules::in_pairs)
    if (kicked_) engine_.ranks.until_later([this] { engine_.follow_reach(modules_); });
  kicked_ = observed_ = false;
  const auto update = [this] { modules_.update(engine_, step_ + 1, time_at(step_ + 1), dt_); };
  if constexpr (has_ranks)
    engine_.ranks.until_later(update);
  else
    update();
  if constexpr (Modules::flux) engine_.fluxes().book(dt_);
}

}  // namespace silt
