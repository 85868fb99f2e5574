// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that choose the time step.

#include <array>
#include <numbers>

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
std::optional<detail::ShortestContact> Simulation<Policies...>::shortest_contact(
    double speed) const {
  using Law = typename ContactsType::Law;
  if constexpr (detail::HasContactTime<Law>) {
    if (!(speed > 0)) return std::nullopt;
    auto meetings = [&] {
      if constexpr (has_ranks)
        return ranks_scene_.meetings;
      else
        return detail::meetings_of(engine_, openings_.inlets(), contacts_.materials());
    }();
    if constexpr (has_breakage && !has_ranks) this->include_fragments(meetings);
    const detail::ShortestContactSearch<Law, Integrator> search(
        Engine::coefficients_of(contacts_).law, meetings, speed,
        detail::InertiaOf<typename Engine::Contacts>::slip_mobility());
    if (std::isfinite(search.found().time)) return search.found();
  }
  return std::nullopt;
}

template <class... Policies>
std::optional<double> Simulation<Policies...>::time_step_limit(double speed) const {
  const auto shortest = shortest_contact(speed);
  return shortest ? std::optional<double>(guard.max_time_step * shortest->time) : std::nullopt;
}

/// The largest speed [m/s]: the present one of particles with their tips and of walls, or that of a
/// fall through the whole scene, whichever is greater. Particles from inlets do not rotate.
template <class... Policies>
double Simulation<Policies...>::expected_speed() const {
  double speed = 0, largest = 0;
  if constexpr (detail::deforms<Domain>) speed = domain_.fastest();
  Box scene;
  if constexpr (has_ranks) {
    const detail::SceneSize& all = ranks_scene_.size;
    speed = all.speed, largest = all.radius, scene = all.region;
  }
  // Infinite surfaces, such as planes, bound the scene in the directions normal to them.
  const auto include = [&scene](const Vec3d& p) {
    const auto widen = [](double& low, double& high, double x) {
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    };
    widen(scene.min.x, scene.max.x, p.x), widen(scene.min.y, scene.max.y, p.y);
    widen(scene.min.z, scene.max.z, p.z);
  };
  for (std::size_t k = 0; k < rows() && !has_ranks; ++k)
    if (is_present(k)) {
      speed = std::max(speed, surface_speed(k).sum()), include(position(k));
      largest = std::max(largest, radius(k));
    }
  for (const auto& inlet : openings_.inlets()) {
    speed = std::max(speed, norm(inlet.flow.velocity) + norm(inlet.flow.scatter));
    include(inlet.bounds.min), include(inlet.bounds.max);
  }
  // Walls where they may touch particles, whose surfaces extend beyond their centres.
  const Box near = scene.grown(largest);
  Vec3d period{0, 0, 0};  // of walls
  if constexpr (Domain::periodic && !detail::deforms<Domain>) period = detail::period_of(domain_);
  for (const auto& w : engine_.walls)
    speed =
        std::max(speed, detail::speed_near(w, detail::region_with_images(near, w, period), time_));
  for (const auto& w : engine_.walls)
    for (const auto& s : w.surfaces) {
      const Box b = detail::bounds_in_space(w, s);
      include(b.min), include(b.max);
    }
  speed = std::max(speed, carried_speed(scene));
  const double pushed = [this] {
    if constexpr (has_ranks)
      return ranks_scene_.size.acceleration;
    else
      return modules_.largest_acceleration(engine_, step_, time_);
  }();
  const auto fall = [this, pushed](const Box& box) {
    const auto height = [](double low, double high) { return high > low ? high - low : 0.0; };
    const double x = height(box.min.x, box.max.x), y = height(box.min.y, box.max.y),
                 z = height(box.min.z, box.max.z);
    return std::sqrt(2 * (std::abs(gravity.x) * x + std::abs(gravity.y) * y +
                          std::abs(gravity.z) * z + pushed * norm(Vec3d{x, y, z})));
  };
  speed = std::max(speed, fall(scene));
  // For a scene that is flat, or bounded by inclined walls only, at least the particle size is
  // known.
  return speed > 0 ? speed : fall(scene.grown(largest));
}

/// The speed [m/s] that the fluid can give to particles at rest on their way through the scene.
template <class... Policies>
double Simulation<Policies...>::carried_speed([[maybe_unused]] const Box& scene) const {
  double most = 0;
  if constexpr (FluidIs::carries) {
    if (!(scene.max.x >= scene.min.x)) return 0;
    const FastestFluid fluid = fluid_.fastest(scene);
    const auto include = [&](double r, double m) {
      if (std::isfinite(m)) most = std::max(most, fluid.carries(2 * r, m));
    };
    for (std::size_t k = 0; k < rows(); ++k)
      if (is_present(k)) include(radius(k), mass(k));
    if constexpr (!of_bodies)
      for (const auto& inlet : openings_.inlets())
        for (std::size_t k = 0; k < inlet.flow.kinds(); ++k) {
          const InletShare kind = inlet.flow.kind(k);
          const double r = kind.radius.min();
          include(r, kind.density * 4 * std::numbers::pi / 3 * r * r * r);
        }
  }
  return most;
}

/// The quantities that determine the time step, over the particles of all ranks (collective).
template <class... Policies>
void Simulation<Policies...>::share_scene() {
  engine_.set_flux_coefficients(modules_, contacts_);
  if constexpr (has_ranks && Modules::in_pairs) {
    detail::NearOthers<Modules>::look(modules_.near, modules_.modules, engine_, domain_, time_);
    engine_.follow_reach(modules_);
  }
  measure_scene();
}

/// The same in a step, with the rates that modules which act in pairs have measured last.
template <class... Policies>
void Simulation<Policies...>::measure_scene() {
  if constexpr (has_ranks) {
    auto& ranks = engine_.ranks;
    ranks.measure(engine_.particles);
    detail::SceneSize own;
    ranks.together("a look at the scene", [&] {
      for (std::size_t k = 0; k < rows(); ++k)
        if (is_present(k)) {
          own.speed = std::max(own.speed, surface_speed(k).sum());
          own.region.include(position(k)), own.radius = std::max(own.radius, radius(k));
        }
      using Stage = detail::ModuleStage<Modules, Domain>;
      own.acceleration = modules_.largest_acceleration(engine_, step_, time_);
      own.module_rate = modules_.fastest(engine_, time_, Stage::OfFluxes::Estimated).rate;
    });
    std::array<double, 4> most{own.speed, own.radius, own.acceleration, own.module_rate};
    ranks.max_of(most);
    ranks_scene_.size = {ranks.union_of(own.region), most[0], most[1], most[2], most[3]};
    auto meetings = detail::meetings_of(engine_, openings_.inlets(), contacts_.materials());
    if constexpr (has_breakage) this->include_fragments(meetings);
    ranks_scene_.meetings = ranks.union_of_meetings(meetings);
    engine_.agree("the start of a run");
  }
}

template <class... Policies>
double Simulation<Policies...>::chosen_time_step() const {
  const double speed = expected_speed();
  const auto shortest = shortest_contact(speed);
  if (time_step) {
    require_positive("Simulation::time_step", *time_step, "s");
    if (shortest)
      require(*time_step <= guard.max_time_step * shortest->time,
              "Simulation::time_step = ", *time_step, " [s] is above the limit ",
              detail::below(guard.max_time_step * shortest->time),
              " s, guard.max_time_step = ", guard.max_time_step,
              " of the shortest contact that can happen at ", speed, " m/s", tips_at(speed),
              ": that ", detail::describe(*shortest, contacts_),
              "; lower it, leave it out, or soften the material");
    this->check_bond_step(*time_step);
    return *time_step;
  }
  require(size() > 0 || !openings_.inlets().empty(),
          "the time step cannot be chosen: there are no particles; add some, or an inlet, or set "
          "Simulation::time_step [s]");
  bool all_fixed = openings_.inlets().empty() && !has_ranks;
  for (std::size_t k = 0; k < rows() && all_fixed; ++k)
    all_fixed = !is_present(k) || !std::isfinite(mass(k));
  require(
      !all_fixed,
      "the time step cannot be chosen: all particles are fixed, so that none has a contact that "
      "it must resolve; add one that is free, or set Simulation::time_step [s]");
  if (!(speed > 0) && std::isfinite(this->longest_bond_step()))
    return step_for(0, INFINITY);  // bonds alone set it, such as of a net that a force loads
  require(speed > 0,
          "the time step cannot be chosen: nothing moves and there is no gravity; set "
          "sim.gravity = {0, 0, -9.81} [m/s2] or a velocity, or Simulation::time_step [s] where "
          "nothing is to move, or a flow or a module moves it later");
  require(shortest.has_value(),
          "the time step cannot be chosen: the contact law does not say how long a contact lasts; "
          "give it contact_time() (silt/contact/concept.hpp), or set Simulation::time_step [s]");
  return step_for(speed, shortest->time);
}

/// silt's time step at this speed [m/s], if the shortest contact lasts `contact` [s].
template <class... Policies>
double Simulation<Policies...>::step_for(double speed, double contact) const {
  double of_springs = INFINITY;
  for (const Wall& wall : engine_.walls)
    of_springs = std::min(of_springs, detail::spring_step(wall.drive));
  return std::min({contact / 20, 0.5 * longest_travel_step(speed), longest_module_step(),
                   of_springs, this->longest_bond_step(), longest_step_in_fluid()});
}

/// [s] The longest step in which the loads of the fluid on all particles may be constant.
template <class... Policies>
double Simulation<Policies...>::longest_step_in_fluid() const {
  double least = INFINITY;
  if constexpr (FluidIs::limits_steps)
    for (std::size_t k = 0; k < rows(); ++k)
      if (is_present(k)) least = std::min(least, fluid_.longest_particle_step(radius(k), mass(k)));
  return least;
}

/// The time step of the next drift [s].
template <class... Policies>
double Simulation<Policies...>::coming_step() const {
  if constexpr (has_breakage)
    if (breaks_.sizes.coming_step > 0) return breaks_.sizes.coming_step;
  return dt_;
}

/// From the next drift on steps are dt [s] long. The leapfrog velocities, half an old step ahead of
/// time(), are moved with the last forces to half a new step ahead: second order.
template <class... Policies>
void Simulation<Policies...>::change_step(double dt) {
  if (kicked_ && dt_ > 0) {
    if (!first_kick_) change_fluid_step(dt);
    engine_.change_step(dt / dt_);
  }
  time_origin_ = time_, step_origin_ = step_;
  dt_ = dt;
  if constexpr (has_breakage) breaks_.sizes.coming_step = 0;
}

/// Between kick and drift: takes a time_step that observers have set, with the checks of the start
/// of a run (ranks must set the same), or the step that breakage has chosen. Returns whether the
/// step has changed.
template <class... Policies>
bool Simulation<Policies...>::follow_time_step(bool observed) {
  if (observed && time_step && *time_step != dt_) {
    const auto change = [this] { change_step(chosen_time_step()), engine_.include_speeds(); };
    if constexpr (has_ranks) {
      share_scene();
      if constexpr (has_bonds) this->share_bonds();
      engine_.ranks.together("a time step that observers set", change);
    } else {
      change();
    }
    return true;
  }
  if (coming_step() == dt_) return false;
  change_step(coming_step()), engine_.include_speeds();
  return true;
}

/// Checks, in a step that stops between kick and drift, whether the time step still suits the
/// smallest particles present; needed if the smallest or the fastest have changed. If a law's
/// safeguard has ended a contact in this very step, which needs the whole kick, the check is
/// postponed to the next step, a few times at most. With several ranks it is collective, and all
/// choose the same step.
template <class... Policies>
void Simulation<Policies...>::follow_sizes() {
  if constexpr (has_breakage) {
    auto& sizes = breaks_.sizes;
    std::array<double, 3> most{engine_.safeguards != sizes.safeguards ? 1.0 : 0.0,
                               std::max(checked_speed_, engine_.largest_speed), 0};
    if constexpr (has_ranks && has_bonds) most[2] = engine_.bonds_break ? 1 : 0;
    if constexpr (has_ranks) engine_.ranks.agree("a look at particle sizes", nullptr, most);
    if constexpr (has_ranks && has_bonds) engine_.bonds_break = most[2] > 0, break_bonds_of_ranks();
    const double turned = most[0], fastest = most[1];
    if (turned > 0 && ++sizes.postponed <= sizes.most_postponed) return sizes.forget();
    sizes.postponed = 0;
    if (!sizes.measure(engine_, contacts_.materials()) && fastest <= sizes.speed) return;
    const std::array<double, 3> own{engine_.largest_speed, engine_.largest_share,
                                    engine_.largest_overlap};
    measure_scene();
    if constexpr (has_ranks && has_bonds) this->share_bonds();
    engine_.largest_speed = own[0], engine_.largest_share = own[1];  // keep_limits() checks its own
    engine_.largest_overlap = own[2];
    sizes.speed = std::max(fastest, expected_speed());
    const auto shortest = shortest_contact(sizes.speed);
    if (!shortest) return;
    const double chosen = step_for(sizes.speed, shortest->time);
    if (dt_ > sizes.longer * chosen || dt_ < sizes.shorter * chosen) sizes.coming_step = chosen;
  }
}

/// The longest step [s] in which nothing at this speed [m/s] moves farther than guard.max_travel
/// allows.
template <class... Policies>
double Simulation<Policies...>::longest_travel_step(double speed) const {
  double least = engine_.least_radius();  // of convex bodies: known from the first step on
  if constexpr (has_breakage)
    if (!this->follows_sizes())
      least = std::min(
          least, detail::SmallestCell::inner_of<Simulation>() * this->breakage().rules.dust_below);
  return least > 0 ? guard.max_travel * least / speed : INFINITY;
}

/// Includes what has been added since the last run.
template <class... Policies>
bool Simulation<Policies...>::is_step_too_long() const {
  const double speed = expected_speed();
  const auto limit = time_step_limit(speed);
  const double dt = coming_step();
  return (limit && dt > *limit) || dt > longest_travel_step(speed) ||
         dt > this->longest_stable_bond_step();
}

/// Whether the time step is longer than silt would choose now, by more than the change of speeds
/// since the choice can explain.
template <class... Policies>
bool Simulation<Policies...>::is_longer_than_own() const {
  constexpr double by_speeds = 1.05;  // [-]
  const double speed = expected_speed();
  const auto shortest = shortest_contact(speed);
  return !time_step && shortest && dt_ > by_speeds * step_for(speed, shortest->time);
}

/// Whether the time step is longer than silt would choose for the speeds so far.
template <class... Policies>
bool Simulation<Policies...>::is_longer_than_chosen() const {
  const auto limit =
      shortest_contact(std::max({checked_speed_, engine_.largest_speed, expected_speed()}));
  return !limit || dt_ > (1 + 1e-9) * limit->time / 20;
}

}  // namespace silt
