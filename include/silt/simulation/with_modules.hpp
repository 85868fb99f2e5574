// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that are used with modules only.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
std::size_t Simulation<Policies...>::present_for_fluxes() const {
  if constexpr (has_ranks) return engine_.ranks.present();
  return engine_.present();
}

/// Sets the initial field values of the particles from place `from` on.
template <class... Policies>
void Simulation<Policies...>::start_fields([[maybe_unused]] std::size_t from) {
  if constexpr (Modules::exist)
    for (std::size_t k = from; k < rows(); ++k) {
      Seen p = engine_.seen(k, time_);
      p.velocity = velocity(k);
      if constexpr (rotates) p.angular_velocity = angular_velocity(k);
      modules_.start(engine_.modules(), p, k);
    }
}

/// Evaluates the pair interactions of modules.
template <class... Policies>
void Simulation<Policies...>::act_in_pairs() {
  if constexpr (Modules::in_pairs) {
    constexpr std::int64_t measure_every = 100;  // [steps]
    bool asked = true, measure = first_kick_ || step_ % measure_every == 0;
    if constexpr (Modules::flux) asked = engine_.fluxes().asked();
    modules_.look_near(engine_, domain_, time_, asked, measure);
    if constexpr (has_ranks) modules_.near.weigh(domain_, engine_.ranks.near_work);
    modules_.near.receive(engine_.modules(), asked);
  }
}

/// Computes the forces of modules in this step.
template <class... Policies>
void Simulation<Policies...>::push_modules() {
  if constexpr (Modules::push) {
    const double before = power_of_modules();
    const bool between = Integrator::first_kick == 0.5 && !first_kick_;
    modules_.push(engine_, {step_, time_, between ? 0.5 * dt_ : 0, gravity}, [this](std::size_t k) {
      Vec3d force = engine_.contact_force(k);
      if constexpr (Fluid::active) force += engine_.fluid_loads().force[k].vector();
      return force;
    });
    if constexpr (has_ledger)
      book_.modules_worked(first_kick_ ? -work_of_first_kick(engine_.modules().force)
                                       : 0.5 * dt_ * (before + power_of_modules()));
  }
}

/// [W] of modules on mobile particles; for the ledger only.
template <class... Policies>
double Simulation<Policies...>::power_of_modules() const {
  double power = 0;
  if constexpr (has_ledger && Modules::push)
    for (std::size_t k = 0; k < rows(); ++k) {
      const auto p = engine_.owner(k);
      if (!p.is_there() || p.inverse_mass() == 0) continue;
      power += dot(engine_.modules().force[k].vector(), p.velocity());
      if constexpr (Modules::turn)
        power += dot(engine_.modules().torque[k].vector(), p.angular_velocity());
    }
  return power;
}

/// The longest step [s] that resolves module forces as well as contacts, with a 20th of half a
/// period, and fluxes with 1 over their estimated rate; infinite if modules do not give their rate.
template <class... Policies>
double Simulation<Policies...>::longest_module_step() const {
  using Stage = detail::ModuleStage<Modules, Domain>;
  double rate;
  if constexpr (has_ranks)
    rate = ranks_scene_.size.module_rate;
  else
    rate = modules_.fastest(engine_, time_, Stage::OfFluxes::Estimated).rate;
  return rate > 0 ? std::numbers::pi / 20 / rate : INFINITY;
}

/// How fluxes through contacts are treated in the coming step. If particles have come or left they
/// are evaluated anew, so that no particle receives a flux that no partner gives.
template <class... Policies>
detail::FluxLook Simulation<Policies...>::look_at_fluxes(
    [[maybe_unused]] std::size_t present_before) const {
  constexpr std::int64_t measure_every = 100;  // [steps]
  if constexpr (Modules::flux) {
    if (first_kick_ || step_ % measure_every == 0) return detail::FluxLook::Measure;
    if (step_ % flux_every_ == 0 || present_for_fluxes() != present_before)
      return detail::FluxLook::Ask;
  }
  return detail::FluxLook::Hold;
}

/// After fluxes were measured: number of steps for which they may be held from now on (collective).
template <class... Policies>
void Simulation<Policies...>::choose_flux_steps() {
  if constexpr (Modules::flux) {
    constexpr double most_change = 0.01;  // [-] of a value while its flux is held
    const auto most = static_cast<double>(engine_.fluxes().most_steps(modules_.modules));
    double rate = modules_.fastest_flux(engine_, time_);
    if constexpr (has_ranks) rate = engine_.ranks.max_of(rate);
    flux_every_ = static_cast<std::int64_t>(
        std::clamp(most_change / std::max(rate * dt_, 1e-300), 1.0, most));
  }
}

/// Aborts a run whose step does not resolve the module forces.
template <class... Policies>
void Simulation<Policies...>::check_module_rates() const {
  using OfFluxes = typename detail::ModuleStage<Modules, Domain>::OfFluxes;
  OfFluxes measured = OfFluxes::LeftOut;
  if constexpr (Modules::flux)
    if (engine_.fluxes().measured()) measured = OfFluxes::Measured;
  if constexpr (Modules::in_pairs && !Modules::flux)
    if (modules_.near.measured()) measured = OfFluxes::Measured;
  const auto most = modules_.fastest(engine_, time_, measured);
  const double dt = coming_step();
  if (most.rate * dt <= guard.max_rate) return;
  const auto p = engine_.owner(most.particle);
  throw SimulationError(
      detail::readable("step ", step_, ", t = ", time_, " s: the modules' rate of particle ",
                       p.id(), " is ", most.rate, " 1/s, ", most.rate * dt,
                       " over the time step of ", dt, " s, where guard.max_rate is ",
                       guard.max_rate, "; set Simulation::time_step to less than ",
                       detail::below(guard.max_rate / most.rate), " s"),
      step_, {p.id()}, p.centre());
}

}  // namespace silt
