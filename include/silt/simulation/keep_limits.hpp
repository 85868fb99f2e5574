// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation: the limits that are checked in every step (Guard).

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
void Simulation<Policies...>::keep_limits() {
  peak_overlap_ = std::max(peak_overlap_, engine_.largest_overlap);
  const bool lets_pass = detail::lets_long_steps_pass(guard);
  if (!engine_.finite) detail::throw_not_finite(engine_, step_, time_, lets_pass);
  if (kicked_) detail::check_spins(engine_, step_, time_, lets_pass);
  // Unless observers look at this step, particles have moved on since the forces acted.
  const double back = kicked_ ? 0 : dt_;
  if (engine_.largest_overlap > overlap_limits_.least(guard.max_overlap))
    detail::check_overlaps(
        engine_, domain_, step_, time_, back, guard.max_overlap, overlap_limits_,
        detail::OverlapWords{
            step_ <= scene_step_ + (scene_step_ > 0), [this] { return is_longer_than_chosen(); },
            [this](std::size_t k) { return detail::name_of_material(contacts_, k); },
            [this](const Vec3d& p) { return openings_.inlet_at(p); },
            [this](ParticleId which) { return this->resized_by(which, step_); }});
  detail::check_crowded(engine_, step_, time_, back);
  if constexpr (Modules::flux)
    if (engine_.fluxes().measured()) {
      check_module_rates();
      if constexpr (!has_ranks) choose_flux_steps();  // several ranks do it later, together
    }
  if constexpr (Modules::in_pairs && !Modules::flux)
    if (modules_.near.measured()) check_module_rates();
  const double way = detail::wall_travel(engine_), dt = coming_step();
  const double wall_way = way * (dt / dt_), speed = std::max(engine_.largest_speed, way / dt_);
  if (speed > detail::checked_again * checked_speed_) {
    checked_speed_ = speed;
    const auto shortest = shortest_contact(checked_speed_);
    if (shortest && dt > guard.max_time_step * shortest->time) {
      const auto fastest = detail::fastest_particle(engine_).speed;
      throw SimulationError(
          detail::readable(
              "step ", step_, ", t = ", time_, " s: the time step ", dt, " s is above its limit ",
              guard.max_time_step * shortest->time, " s at the largest speed ", checked_speed_,
              " m/s",
              speed > engine_.largest_speed
                  ? text(" (of ",
                         detail::name_of_wall(engine_.walls, detail::fastest_wall(engine_)),
                         ", which was slower where the step was chosen; a motion that jumps has "
                         "to be made continuous)")
              : fastest.is_of_tips() ? fastest.words()
                                     : text(" (of particle ", fastest.id, ')'),
              ", guard.max_time_step of the shortest contact that can happen: that ",
              detail::describe(*shortest, contacts_), step_advice()),
          step_, {}, {});
    }
  }
  detail::check_travel(engine_, wall_way, step_, time_, dt, guard.max_travel);
  keep_rates(back);
  if (guard.domain && engine_.lists.upkeep.pruned_at == step_)
    detail::check_inside(engine_, *guard.domain, step_, time_);
}

/// What to change if the time step is above its limit, for a message.
template <class... Policies>
std::string Simulation<Policies...>::step_advice() const {
  std::string advice = "; ";
  if (!time_step) {
    advice += "silt chose the time step, for slower or heavier ones: ";
    if constexpr (has_breakage)
      if (!this->follows_sizes())
        advice += "take BreakageRules.step = BreakStep::SmallestLiving, which follows them, or ";
  }
  return advice + "set a smaller Simulation::time_step or a softer material";
}

/// The surface speed of particle k at time().
template <class... Policies>
detail::SurfaceSpeed Simulation<Policies...>::surface_speed(std::size_t k) const {
  if constexpr (rotates) {
    const Vec3d w = angular_velocity(k);
    const double tips = engine_.owner(k).tip_speed(w);
    return {norm(velocity(k)), tips, of_bodies ? norm(w) : 0, id(k)};
  } else {
    return {norm(velocity(k)), 0, 0, id(k)};
  }
}

/// The name of the particle with this surface speed [m/s] at time(), for a message.
template <class... Policies>
std::string Simulation<Policies...>::tips_at(double speed) const {
  for (std::size_t k = 0; k < rows(); ++k)
    if (is_present(k))
      if (const auto s = surface_speed(k); s.sum() == speed) return s.words();
  return {};
}

/// Checks the rates of all contacts, which costs as much as a few steps: at intervals, and when the
/// largest overlap has grown by a quarter.
template <class... Policies>
void Simulation<Policies...>::keep_rates(double back) {
  if (engine_.largest_overlap > 1.25 * checked_overlap_)
    checked_overlap_ = engine_.largest_overlap;
  else if (step_ % detail::looks_at_rates_every != 0)
    return;
  check_module_rates();
  const double dt = coming_step();
  if constexpr (!has_ranks) detail::check_free_walls(engine_, step_, time_, dt, guard.max_rate);
  if (engine_.largest_overlap > 0)
    detail::ContactRates<Engine, Domain>(engine_, domain_, back, dt)
        .check(step_, time_, guard.max_rate);
}

/// The same for free walls on several ranks (collective).
template <class... Policies>
void Simulation<Policies...>::keep_rates_of_walls() {
  if constexpr (has_ranks) {
    const double overlap = engine_.largest_overlap;
    double& checked = ranks_scene_.checked_overlap;
    if (overlap > 1.25 * checked)
      checked = overlap;
    else if (step_ % detail::looks_at_rates_every != 0)
      return;
    if (std::any_of(engine_.walls.begin(), engine_.walls.end(),
                    [](const Wall& wall) { return detail::is_free(wall.drive); }))
      detail::check_free_walls_together(engine_, step_, time_, coming_step(), guard.max_rate);
  }
}

template <class... Policies>
void Simulation<Policies...>::check_walls() const {
  for (std::size_t w = 0; w < engine_.walls.size(); ++w)
    if (engine_.walls[w].moves()) detail::check_pose(engine_.walls, w, step_, time_);
}

}  // namespace silt
