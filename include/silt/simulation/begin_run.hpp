// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation: checks and preparations before the first step of a run.

#include <utility>

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
void Simulation<Policies...>::prepare() {
  require(
      !running_,
      "Simulation::run was called by an observer of a run; the run goes on by itself: leave the "
      "call out, or make it after the run has ended");
  const auto check = [this] {
    check_start();
    modules_.check(*this), modules_.check_given(engine_, step_, time_);
  };
  if constexpr (has_ranks) {
    this->share_edits("the start of a run", check);
    share_scene();
    if constexpr (has_bonds) this->share_bonds();
    engine_.ranks.together("the time step of a run", [this] { begin_run(); });
  } else {
    check();
    begin_run();
  }
}

/// Checks the settings of a run and prepares fluid and threads.
template <class... Policies>
void Simulation<Policies...>::check_start() {
  detail::check_limits(guard);
  // A mesh is solid from both sides: an overlap larger than the radius is not recognised as one.
  for (const Wall& wall : engine_.walls)
    for (const auto& surface : wall.surfaces) {
      const double overlap = overlap_limits_.most(wall.material, guard.max_overlap);
      require(
          guard.through_meshes || overlap + guard.max_travel < 1 || !detail::is_mesh(surface),
          overlap > guard.max_overlap ? "the limit of set_max_overlap = " : "Guard.max_overlap = ",
          overlap, " and Guard.max_travel = ", guard.max_travel,
          " [-] must be less than 1 together where there are meshes: a "
          "particle could come out behind one unseen (guard.through_meshes = true lets them)");
    }
  this->check_inlets();
  if constexpr (Domain::periodic && !has_ranks)
    for (std::size_t k = 0; k < rows() && step_ == 0; ++k)
      if (is_present(k) && norm(domain_.wrapped(position(k)) - position(k)) > 1e-6 * radius(k))
        ++engine_.came_from_outside;
  if constexpr (detail::deforms<Domain>) {
    if constexpr (!has_bonds)
      detail::refuse_tension<typename ContactsType::Law>(domain_.deformation());
    detail::check_in_flow(engine_, gravity);
  }
  require(is_finite(gravity), "Simulation::gravity = ", gravity, " [m/s2] must be finite");
  book_gravity();
  detail::check_inertia<ShapeType>();
  if (step_ > 0 || kicked_) detail::check_given(engine_, gravity, step_, time_);
  prepare_fluid();
  engine_.set_threads(threads);
}

/// Computes what depends on the scene (with several ranks, on the whole scene): coefficients and
/// time step.
template <class... Policies>
void Simulation<Policies...>::begin_run() {
  past_runs_.begin_run();
  this->check_pairs();
  engine_.set_coefficients(contacts_);
  engine_.set_flux_coefficients(modules_, contacts_);
  if constexpr (has_breakage) this->prepare_breakage();
  if constexpr (!has_ranks) modules_.look_near(engine_, domain_, time_, true, true);
  const Vec3d before = std::exchange(past_runs_.gravity, gravity);
  const bool falls_faster = dot(gravity, gravity) > dot(before, before);
  if (dt_ == 0 || (time_step && *time_step != dt_) ||
      ((scene_changed_ || falls_faster) && is_step_too_long()) ||
      (laws_changed_ && is_longer_than_own()))
    change_step(chosen_time_step());
  if (scene_changed_ && !continued_) checked_speed_ = 0;  // a restart goes on with that of its file
  scene_changed_ = laws_changed_ = false;
  if (guard.domain) detail::check_inside(engine_, *guard.domain, step_, time_);
}

}  // namespace silt
