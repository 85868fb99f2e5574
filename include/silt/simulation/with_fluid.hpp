// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that only a fluid needs.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Refuses a fluid that does not fit to where the particles are.
template <class... Policies>
void Simulation<Policies...>::check_fluid() const {
  if constexpr (Fluid::active) {
    require(!fluid_.steps || *fluid_.steps >= 1, "CoupledFlow.steps = ", fluid_.steps.value_or(0),
            " particle steps a fluid step must be at least 1, or left out");
    require(fluid_.most_steps >= 1, "CoupledFlow.most_steps = ", fluid_.most_steps,
            " must be at least 1");
    if constexpr (Domain::periodic) {
      const auto& g = fluid_.flow().grid();
      const Vec3d low = g.box().min, extent = g.box().extent();
      const double from[3] = {low.x, low.y, low.z}, length[3] = {extent.x, extent.y, extent.z};
      const Vec3d corner = domain_.box().min;
      const double begins[3] = {corner.x, corner.y, corner.z};
      for (int d = 0; d < 3; ++d)
        require(!domain_.repeats(d) ||
                    (g.periodic(d) && std::abs(length[d] - domain_.length(d)) < 1e-9 * length[d] &&
                     std::abs(from[d] - begins[d]) < 1e-9 * length[d]),
                "the PeriodicBox repeats in ", "xyz"[d], " from ", begins[d], " m on, after ",
                domain_.length(d), " m, but the flow's grid from ", from[d], " m on has ",
                length[d], " m and is ", g.periodic(d) ? "" : "not ",
                "periodic there; give both the same");
    }
  }
}

/// Asks the fluid anew for what it does to the particles, if it is time.
template <class... Policies>
void Simulation<Policies...>::couple() {
  if constexpr (Fluid::active) {
    if (fluid_.fluid_steps() == 0) fluid_.start_at(time_);
    const double before = power_of_fluid();
    if constexpr (follows_fluid) {
      auto& left = engine_.fluid_loads().left;
      fluid_.lose(left), left = {0, 0, 0};
      fluid_.gravity = gravity;
    }
    if (fluid_.time() < kicked_to() + clock_rounding * dt_) renew_fluid();
    if constexpr (follows_fluid) follow_fluid();
    if constexpr (has_ledger)
      book_.fluid_worked(first_kick_ ? -work_of_first_kick(engine_.fluid_loads().force)
                                     : 0.5 * dt_ * (before + power_of_fluid()));
  }
}

/// The time [s] of the velocities before this step's kick: those of leapfrog are half a step
/// behind, but for the first. Fluid steps end at such times, so that what the fluid gives in a step
/// of its own is what the particles' kicks take, the first, shorter one included.
template <class... Policies>
double Simulation<Policies...>::kicked_to() const {
  return first_kick_ ? time_ : time_ - (1 - Integrator::first_kick) * dt_;
}

/// The particles' steps will be dt [s] long instead of dt_; called where velocities are half an old
/// step ahead of time(), before they are made half a new one ahead with the last forces. What the
/// fluid has given stays what it is.
template <class... Policies>
void Simulation<Policies...>::change_fluid_step([[maybe_unused]] double dt) {
  if constexpr (Fluid::active) {
    if (fluid_.fluid_steps() == 0) return;
    if constexpr (Integrator::first_kick != 0.5) {
      fluid_.start_at(fluid_.time() + dt -
                      dt_);  // velocities are of whole steps, whatever those are
    } else {
      const double more = 0.5 * (dt - dt_);  // [s] that the last force will act on
      const double ahead = fluid_.time() - (time_ + 0.5 * dt);  // [s] of the kicks to come
      const double kicks = std::ceil(ahead / dt - clock_rounding);
      auto& loads = engine_.fluid_loads();
      for (std::size_t k = 0; k < rows(); ++k) {
        if (!is_present(k) || !std::isfinite(mass(k))) continue;
        const Vec3d force = loads.force[k].vector();
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
    }
  }
}

/// Light or stiffly coupled particles in contact: what the fluid gives them is held over its step
/// and knows only the contacts of the step before, so that a step of up to `longest` [s] must
/// either leave the fluid's answer small or resolve the contacts.
template <class... Policies>
double Simulation<Policies...>::longest_held_step(double longest) const {
  if constexpr (!follows_fluid) {
    const auto& held = fluid_.held_answer();
    const double lag = held.in_contact, small = held.most_lag * fluid_.last_step_length();
    if (lag * longest > small)
      if (const auto limit = time_step_limit(checked_speed_))
        return std::min(longest, std::max(small / lag, held_share_of_contact * *limit));
  }
  return longest;
}

/// The same of a number of steps that was set.
template <class... Policies>
void Simulation<Policies...>::check_held_step(double span) const {
  if constexpr (!follows_fluid) {
    const auto held = fluid_.held_answer();
    if (!(held.lag > held.most_lag && held.density_ratio < 1)) return;
    const auto limit = time_step_limit(checked_speed_);
    if (!limit || span <= held_share_of_contact * *limit) return;
    throw SimulationError(
        text("step ", step_, ", t = ", time_, " s: CoupledFlow.steps = ", *fluid_.steps,
             " particle steps a fluid step are too many for particles of ", held.density_ratio,
             " of the fluid's density: what it gives them is held for ", span,
             " s, longer than an eighth of a contact, and would make their contacts swing; set it "
             "to "
             "at most ",
             static_cast<int>(held_share_of_contact * *limit / dt_), " or leave it out",
             Fluid::has_added_mass ? "" : ", or add FollowedDrag"),
        step_, {}, {});
  }
}

template <class... Policies>
void Simulation<Policies...>::renew_fluid() {
  const double fastest = gather_for_fluid();
  int steps = 1;
  if (fluid_.steps)
    steps = *fluid_.steps;
  else if (fluid_.fluid_steps() > 0)
    steps = static_cast<int>(
        std::clamp(longest_held_step(fluid_.longest_step(fastest, engine_.team())) / dt_, 1.0,
                   static_cast<double>(fluid_.most_steps)));
  const double behind = kicked_to() - fluid_.time();  // [s] after a change of the time step
  double span = (first_kick_ ? steps - 1 + Integrator::first_kick : steps) * dt_;
  if (behind > clock_rounding * dt_) span += behind;
  fluid_.gravity = gravity;
  auto& p = in_fluid_;
  try {
    fluid_.advance(p.view(), span, p.force, engine_.team(), p.torque);
  } catch (const InputError&) {
    throw;
  } catch (const FlowStepError& error) {
    const int fewer = static_cast<int>(error.longest / dt_);
    throw SimulationError(text("step ", step_, ", t = ", time_, " s: ", error.what(),
                               fewer >= 1 ? text(", ", fewer, " particle steps of now ", steps,
                                                 ": by CoupledFlow.steps or most_steps")
                                          : text(", by a Simulation::time_step of less than that")),
                          step_, {}, {});
  } catch (const Error& error) {
    throw SimulationError(text("step ", step_, ", t = ", time_, " s: ", error.what()), step_, {},
                          {});
  }
  if (fluid_.steps) check_held_step(span);
  fluid_.start_at(time_ + (steps - 1 + Integrator::first_kick) * dt_);  // to the last digit
  auto& loads = engine_.fluid_loads();
  engine_.team().for_ranges(p.place.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n) {
      using Row = detail::VectorRow;
      const std::size_t k = p.place[n];
      const double inv_m = std::isfinite(p.mass[n]) ? 1 / p.mass[n] : 0;
      loads.force[k] = Row::of(p.force[n]);
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

/// Drag at the particles' present velocities.
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
        const Vec3d force = fluid_.follow(loads, k, position(k), owner.velocity(), 1 / inv_m,
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
    const double ahead = fluid_.time() - time_;  // [s] velocity(k) is that of time()
    const Vec3d force = loads.force[k].vector();
    if constexpr (follows_fluid) {
      if (!std::isfinite(mass(k))) return {0, 0, 0};
      const Vec3d push = loads.held[k].vector();
      // Of leapfrog's last kick the half beyond time() is taken, but not in velocity(k); of others'
      // all of it.
      const double pending = Integrator::first_kick * dt_;
      return ahead * push + pending * (force - push) - loads.taken[k].vector();
    } else {
      return ahead * force;
    }
  } else {
    return {0, 0, 0};
  }
}

/// Returns the largest speed [m/s].
template <class... Policies>
double Simulation<Policies...>::gather_for_fluid() {
  auto& p = in_fluid_;
  const auto& loads = engine_.fluid_loads();
  p.place.clear();
  for (std::size_t k = 0; k < rows(); ++k)
    if (is_present(k)) p.place.push_back(k);
  p.resize(p.place.size(), of_bodies, turned_by_fluid, follows_fluid);
  if constexpr (of_bodies)
    while (p.forms.size() < engine_.mover.forms.size()) {
      const auto& shape = engine_.mover.forms[p.forms.size()].shape;
      if constexpr (Fluid::sees_forms) p.forms_in_flow.push_back(form_in_flow(shape));
      p.add_form(shape);
    }
  if constexpr (!of_bodies) p.inertia_factor = ShapeType::inertia_factor();
  const double span = fluid_.last_step_length();
  std::array<double, Team::most_ranges> fastest{};
  engine_.team().for_ranges(p.place.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n) {
      const std::size_t k = p.place[n];
      p.position[n] = fluid_.at_the_side(position(k), radius(k)), p.mass[n] = mass(k);
      p.id[n] = id(k);
      const auto owner = engine_.owner(k);
      p.volume[n] = owner.volume(), p.velocity[n] = owner.velocity();
      if constexpr (of_bodies) {
        p.radius[n] = std::cbrt(p.volume[n] * (0.75 / std::numbers::pi));
        p.orientation[n] = owner.principal_axes(), p.form[n] = owner.form();
      } else {
        p.radius[n] = owner.radius();
      }
      if constexpr (turned_by_fluid) p.spin[n] = owner.angular_velocity();
      // What has acted besides the fluid since it was asked, on average.
      const Vec3d unforced = loads.unforced[k].vector();
      const bool known = span > 0 && !std::isnan(unforced.x);
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
  return *std::max_element(fastest.begin(), fastest.end());
}

/// [J] by which the work of forces of a fluid, or of modules, in leapfrog's first half kick is less
/// than with the velocity at its end, with which the next step books it: of a sudden start half of
/// all.
template <class... Policies>
template <class Column>
double Simulation<Policies...>::work_of_first_kick(const Column& forces) const {
  double work = 0;
  if constexpr (has_ledger && Integrator::first_kick == 0.5) {
    for (std::size_t k = 0; k < rows(); ++k) {
      if (!is_present(k) || !std::isfinite(mass(k))) continue;
      const Vec3d force = forces[k].vector();
      // A blow is over before gravity and contacts have moved anything.
      const Vec3d a = (1 / mass(k)) * (force + 2 * engine_.contact_force(k)) + 2 * gravity;
      work += 0.125 * dt_ * dt_ * dot(force, a);
    }
  }
  return work;
}

/// [W] of the fluid on the particles that are not fixed; for the ledger alone.
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
