// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that are used with a fluid only.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <silt/coupling/left_particle.hpp>
#include <silt/simulation.hpp>
#include <silt/simulation/with_fluid_heat.hpp>

namespace silt::inline SILT_TARGET {

/// Refuses a fluid that does not fit the positions of the particles.
template <class... Policies>
void Simulation<Policies...>::prepare_fluid() {
  if constexpr (Fluid::active) {
    FluidScene scene;
    if constexpr (Domain::periodic) {
      scene.box = domain_.box();
      for (int d = 0; d < 3; ++d) scene.periodic[static_cast<std::size_t>(d)] = domain_.repeats(d);
    }
    scene.walls = &engine_.walls;
    fluid_.prepare(scene);
  }
  if constexpr (detail::heats_in_fluid<Modules>) detail::check_heat_of_fluid(fluid_);
}

/// Tells the fluid that a share [-] of particle k is there no more, since its last step.
template <class... Policies>
void Simulation<Policies...>::take_from_fluid(std::size_t k, double share) {
  const double displaced = engine_.fluid_loads().displaced[k];
  if (!(displaced > 0)) return;
  const double since =
      time_ - fluid_.clock.time + fluid_.clock.last_step - (1 - Integrator::first_kick) * dt_;
  fluid_.take_away(detail::left_particle<of_bodies>(engine_.owner(k), position(k),
                                                    share * displaced, std::max(since, 0.0)));
}

/// Evaluates the fluid and its loads on the particles anew when it is due.
template <class... Policies>
void Simulation<Policies...>::couple() {
  if constexpr (Fluid::active) {
    if (fluid_.clock.steps == 0) fluid_.clock.time = time_;
    const double before = power_of_fluid();
    if constexpr (follows_fluid) {
      auto& left = engine_.fluid_loads().left;
      fluid_.lose(left), left = {0, 0, 0};
      FluidIs::tell_gravity(fluid_, gravity);
    }
    if (fluid_.clock.time < kicked_to() + clock_rounding * dt_) renew_fluid();
    if constexpr (follows_fluid) follow_fluid();
    if constexpr (FluidIs::pushes_walls)
      for (std::size_t w = 0; w < engine_.walls.size(); ++w) {
        Wall& wall = engine_.walls[w];
        const auto load = fluid_.load_on_driven(w);
        wall.liquid_force = load.force, wall.liquid_torque = load.torque;
        wall.liquid_stiffness = load.stiffness, wall.liquid_damping = load.damping;
      }
    if constexpr (has_ledger)
      book_.fluid_worked(first_kick_ ? -work_of_first_kick(engine_.fluid_loads().force)
                                     : 0.5 * dt_ * (before + power_of_fluid()));
  }
}

/// The time [s] of the velocities before this step's kick: leapfrog velocities are half a step
/// behind, except at the start. Fluid steps end at such times, so that the impulse of the fluid in
/// a step equals that of the particles' kicks, including the first, shorter one.
template <class... Policies>
double Simulation<Policies...>::kicked_to() const {
  return first_kick_ ? time_ : time_ - (1 - Integrator::first_kick) * dt_;
}

/// Changes the particles' step from dt_ to dt [s]. Called when velocities are half an old step
/// ahead of time(), before they are moved to half a new step ahead with the last forces. The
/// impulse given by the fluid is unchanged.
template <class... Policies>
void Simulation<Policies...>::change_fluid_step([[maybe_unused]] double dt) {
  if constexpr (Fluid::active) {
    if (fluid_.clock.steps == 0) return;
    if constexpr (Integrator::first_kick != 0.5) {
      // velocities belong to whole steps of any length
      fluid_.clock.time = fluid_.clock.time + dt - dt_;
    } else {
      const double more = 0.5 * (dt - dt_);        // [s] further duration of the last force
      const auto kicks_of = [this](double step) {  // number of kicks to come
        return std::ceil((fluid_.clock.time - (time_ + 0.5 * step)) / step - clock_rounding);
      };
      const double ahead = kicks_of(dt_) * dt_ - more;  // [s] planned duration of the force
      const double kicks = kicks_of(dt);
      auto& loads = engine_.fluid_loads();
      // What couple() will book for the force of this instant, with the new step and a changed
      // force, is not its work.
      [[maybe_unused]] double missed = 0;  // [J]
      for (std::size_t k = 0; k < rows(); ++k) {
        if (!is_present(k) || !std::isfinite(mass(k))) continue;
        const Vec3d force = loads.force[k].vector();
        if constexpr (has_ledger) {
          const Vec3d now = velocity(k), kick = engine_.owner(k).velocity() - now;
          const Vec3d coming = now + (dt / dt_) * kick;
          const double of_longer_kick = 0.25 * (dt_ - dt * dt / dt_) * dot(force, kick);
          if (follows_fluid)
            missed += of_longer_kick;
          else if (kicks > 0)
            missed += 0.5 * (dt - ahead / kicks) * dot(force, coming) + of_longer_kick;
          else
            missed -= more * dot(force, coming - (more / mass(k)) * force);
        }
        if constexpr (follows_fluid) {
          const Vec3d drag = force - loads.held[k].vector();
          if (loads.given[k].fourth > 0)
            loads.taken[k] = detail::VectorRow::of(loads.taken[k].vector() + more * drag);
          const Vec3d unforced = loads.unforced[k].vector() + (more / mass(k)) * force;
          loads.unforced[k] = detail::VectorRow::of(unforced);
        } else if (kicks > 0) {
          loads.force[k] = detail::VectorRow::of((ahead / (kicks * dt)) * force);
        } else {
          // Taken back: more than the fluid has given.
          const Vec3d back = (dt_ / dt * ahead / mass(k)) * force;  // change_step scales it
          engine_.change_velocity(k, back);
        }
      }
      if constexpr (has_ledger) book_.fluid_worked(missed);
    }
  }
}

template <class... Policies>
FluidPace Simulation<Policies...>::pace_of_fluid(double speed) const {
  return {dt_, speed, [this] { return time_step_limit(checked_speed_); }};
}

template <class... Policies>
void Simulation<Policies...>::renew_fluid() {
  const FluidPace pace = pace_of_fluid(gather_for_fluid());
  const int steps = fluid_.steps_wanted(pace, engine_.team());
  const double behind = kicked_to() - fluid_.clock.time;  // [s] after a change of the time step
  double span = (first_kick_ ? steps - 1 + Integrator::first_kick : steps) * dt_;
  if (behind > clock_rounding * dt_) span += behind;
  FluidIs::tell_gravity(fluid_, gravity);
  auto& p = in_fluid_;
  try {
    auto view = p.view();
    ParticleHeat heat;
    if constexpr (detail::heats_in_fluid<Modules>) heat = heat_in_fluid(), view.heat = &heat;
    fluid_.advance(view, span, p.force, engine_.team(), p.torque);
    if constexpr (detail::heats_in_fluid<Modules>) take_heat_of_fluid();
  } catch (const InputError&) {
    throw;
  } catch (const FlowStepError& error) {
    const int fewer = static_cast<int>(error.longest / dt_);
    throw SimulationError(
        detail::readable("step ", step_, ", t = ", time_, " s: ", error.what(),
                         fewer >= 1 ? text(", ", fewer, " particle steps of now ", steps,
                                           ": by CoupledFlow.steps or most_steps")
                                    : text(", by a Simulation::time_step of less than that")),
        step_, {}, {});
  } catch (const Error& error) {
    throw SimulationError(detail::readable("step ", step_, ", t = ", time_, " s: ", error.what()),
                          step_, {}, {});
  }
  fluid_.clock.time = time_ + (steps - 1 + Integrator::first_kick) * dt_;  // exact to rounding
  take_fluid_loads(span);
  // Behind the loads: the fluid has made its step, which a run that goes on builds upon.
  if constexpr (FluidIs::checks_steps) try {
      fluid_.check_step(span, pace);
    } catch (const InputError&) {
      throw;
    } catch (const Error& error) {
      throw SimulationError(detail::readable("step ", step_, ", t = ", time_, " s: ", error.what()),
                            step_, {}, {});
    }
}

/// The loads of the fluid's step of `span` [s] for the particles' steps to come.
template <class... Policies>
void Simulation<Policies...>::take_fluid_loads(double span) {
  auto& p = in_fluid_;
  auto& loads = engine_.fluid_loads();
  engine_.team().for_ranges(p.place.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n) {
      using Row = detail::VectorRow;
      const std::size_t k = p.place[n];
      const double inv_m = std::isfinite(p.mass[n]) ? 1 / p.mass[n] : 0;
      loads.force[k] = Row::of(p.force[n]), loads.displaced[k] = p.displaced[n];
      if constexpr (follows_fluid) {
        const auto start = fluid_.start_of(n);
        const auto& drag = p.drag[n];
        loads.unforced[k] = Row::of(p.velocity[n]);
        loads.held[k] = Row::of(start.push), loads.held[k].fourth = drag.coefficient;
        loads.flow[k] = Row::of(start.velocity), loads.flow[k].fourth = start.voidage;
        loads.reference[k] = Row::of(drag.slip), loads.reference[k].fourth = drag.voidage;
        loads.given[k] = Row::of(span * start.drag + p.owed[n]);
        loads.given[k].fourth = start.voidage > 0 ? 2 * p.radius[n] : 0;
        loads.taken[k] = Row::of((inv_m > 0 ? -span : 0) * start.drag);
      } else {
        loads.unforced[k] = Row::of(p.velocity[n] + (span * inv_m) * p.force[n]);
      }
      if constexpr (turned_by_fluid) loads.torque[k] = Row::of(p.torque[n]);
    }
  });
}

/// Drag at the present velocities of the particles.
template <class... Policies>
void Simulation<Policies...>::follow_fluid() {
  if constexpr (follows_fluid) {
    auto& loads = engine_.fluid_loads();
    const double kick = first_kick_ ? Integrator::first_kick * dt_ : dt_;
    fluid_.prepare_to_follow(engine_.team());
    engine_.team().for_ranges(rows(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        if (!is_present(k) || loads.given[k].fourth == 0) continue;
        const auto owner = engine_.owner(k);
        const double inv_m = owner.inverse_mass();
        if (inv_m == 0) continue;
        const FollowedRow<detail::VectorRow> row{loads.held[k], loads.flow[k], loads.reference[k],
                                                 loads.given[k], loads.taken[k]};
        const Vec3d force = fluid_.follow(row, position(k), owner.velocity(), 1 / inv_m,
                                          engine_.contact_force(k), kick);
        loads.force[k] = detail::VectorRow::of(force);
        const Vec3d unforced = loads.unforced[k].vector() + (kick * inv_m) * force;
        loads.unforced[k] = detail::VectorRow::of(unforced);
      }
    });
  }
}

template <class... Policies>
Vec3d Simulation<Policies...>::due_from_fluid([[maybe_unused]] std::size_t k) const {
  if constexpr (Fluid::active) {
    const auto& loads = engine_.fluid_loads();
    const double ahead = fluid_.clock.time - time_;  // [s] velocity(k) is that of time()
    const Vec3d force = loads.force[k].vector();
    if constexpr (follows_fluid) {
      if (!std::isfinite(mass(k))) return {0, 0, 0};
      const Vec3d push = loads.held[k].vector();
      // The half of leapfrog's last kick after time() has been taken, but is not in velocity(k);
      // for other integrators the whole kick.
      const double pending = Integrator::first_kick * dt_;
      return ahead * push + pending * (force - push) - loads.taken[k].vector();
    } else {
      return ahead * force;
    }
  } else {
    return {0, 0, 0};
  }
}

template <class... Policies>
void Simulation<Policies...>::gather_forms_for_fluid() {
  [[maybe_unused]] auto& p = in_fluid_;
  if constexpr (of_bodies)
    for (std::size_t f = 0; f < engine_.mover.forms.size(); ++f) {
      const auto& form = engine_.mover.forms[f];
      if (f < p.made.size() && p.made[f] == form.made()) continue;
      if constexpr (FluidIs::sees_forms) p.put(p.forms_in_flow, f, form_in_flow(form.shape));
      if constexpr (FluidIs::template takes_forms<ShapeType>) fluid_.take_form(f, form.shape);
      p.put(p.forms, f, averaged_form(form.shape)), p.put(p.made, f, form.made());
    }
  else
    p.inertia_factor = ShapeType::inertia_factor();
}

/// Returns the largest speed [m/s].
template <class... Policies>
double Simulation<Policies...>::gather_for_fluid() {
  auto& p = in_fluid_;
  const auto& loads = engine_.fluid_loads();
  p.place.clear();
  for (std::size_t k = 0; k < rows(); ++k)
    if (is_present(k)) p.place.push_back(k);
  p.resize(p.place.size(), of_bodies, FluidIs::needs_spin, turned_by_fluid, follows_fluid);
  gather_forms_for_fluid();
  const double span = fluid_.clock.last_step;
  std::array<double, Team::most_ranges> fastest{};
  std::array<bool, Team::most_ranges> put_in{}, taken_out{};
  engine_.team().for_ranges(p.place.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n) {
      const std::size_t k = p.place[n];
      p.position[n] = position(k);
      bool is_inside = true;
      if constexpr (FluidIs::has_sides) {
        p.position[n] = fluid_.at_the_side(position(k), radius(k));
        is_inside = fluid_.reaches(p.position[n]);
      }
      p.mass[n] = mass(k);
      p.id[n] = id(k);
      const auto owner = engine_.owner(k);
      p.volume[n] = owner.volume(), p.velocity[n] = owner.velocity();
      if constexpr (of_bodies) {
        p.radius[n] = std::cbrt(p.volume[n] * (0.75 / std::numbers::pi));
        p.orientation[n] = owner.principal_axes(), p.form[n] = owner.form();
      } else {
        p.radius[n] = owner.radius();
      }
      if constexpr (FluidIs::needs_spin) p.spin[n] = owner.angular_velocity();
      // Mean effect of the other forces since the fluid was last evaluated.
      const Vec3d unforced = loads.unforced[k].vector();
      const bool known = span > 0 && !loads.is_new(k);
      p.displaced[n] = is_inside ? p.volume[n] : 0;
      p.put_in[n] = span > 0 ? p.displaced[n] - loads.displaced[k] : 0;
      put_in[r] = put_in[r] || p.put_in[n] > 0, taken_out[r] = taken_out[r] || p.put_in[n] < 0;
      if constexpr (follows_fluid) {
        const bool in_fluid = known && loads.given[k].fourth > 0;
        p.owed[n] = in_fluid && std::isfinite(p.mass[n]) ? loads.taken[k].vector() : Vec3d{0, 0, 0};
        p.drag[n] = {loads.held[k].fourth, loads.reference[k].vector(), loads.reference[k].fourth};
      }
      p.acceleration[n] = known ? (1 / span) * (p.velocity[n] - unforced) : gravity;
      if (!std::isfinite(p.mass[n])) p.acceleration[n] = {0, 0, 0};
      fastest[r] = std::max(fastest[r], norm(p.velocity[n]));
    }
  });
  const auto any = [](const auto& of) { return std::find(of.begin(), of.end(), true) != of.end(); };
  p.any_put_in = any(put_in), p.taken_out.clear();
  const std::size_t looked_at = any(taken_out) ? p.place.size() : 0;
  for (std::size_t n = 0; n < looked_at; ++n)
    if (p.put_in[n] < 0) {
      const std::size_t k = p.place[n];
      p.taken_out.push_back(detail::left_particle<of_bodies>(engine_.owner(k), position(k),
                                                             -std::exchange(p.put_in[n], 0.0),
                                                             p.displaced[n] > 0 ? 0 : span));
    }
  return *std::max_element(fastest.begin(), fastest.end());
}

/// [J] by which the work of fluid or module forces in leapfrog's first half kick is smaller than
/// with the velocity at its end, which the next step uses for booking: half of all work for a
/// sudden start.
template <class... Policies>
template <class Column>
double Simulation<Policies...>::work_of_first_kick(const Column& forces) const {
  double work = 0;
  if constexpr (has_ledger && Integrator::first_kick == 0.5) {
    for (std::size_t k = 0; k < rows(); ++k) {
      if (!is_present(k) || !std::isfinite(mass(k))) continue;
      const Vec3d force = forces[k].vector();
      // A sudden change is over before gravity and contacts have moved anything.
      const Vec3d a = (1 / mass(k)) * (force + 2 * engine_.contact_force(k)) + 2 * gravity;
      work += 0.125 * dt_ * dt_ * dot(force, a);
    }
  }
  return work;
}

/// [W] of the fluid on mobile particles; for the ledger only.
template <class... Policies>
double Simulation<Policies...>::power_of_fluid() const {
  double power = 0;
  if constexpr (has_ledger) {
    const auto& loads = engine_.fluid_loads();
    for (std::size_t k = 0; k < rows(); ++k) {
      if (!is_present(k) || !std::isfinite(mass(k))) continue;
      const auto p = engine_.owner(k);
      power += dot(loads.force[k].vector(), p.velocity());
      if constexpr (turned_by_fluid) power += dot(loads.torque[k].vector(), p.angular_velocity());
    }
  }
  return power;
}

}  // namespace silt
