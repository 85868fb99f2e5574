// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation: the energy of its particles, and the balance of an EnergyLedger.

#include <algorithm>
#include <cmath>

#include <silt/coupling/left_particle.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

template <class... Policies>
EnergyBalance Simulation<Policies...>::balance() const {
  static_assert(has_ledger,
                "energy() reads the books of a policy that is missing: give the simulation "
                "silt::EnergyLedger{} among its policies");
  require(step_ > 0 || kicked_,
          "Simulation::energy: run() first, if only for 0 s: the forces at the "
          "start are not known yet");
  double translation = 0, rotation = 0, potentials = 0, walls = 0;
  for (const Wall& wall : engine_.walls) walls += detail::energy_of(wall, gravity_booked_).sum();
  for (std::size_t k = 0; k < rows(); ++k) {
    if (!is_present(k) || !std::isfinite(mass(k))) continue;
    const auto part = kinetic(k);
    translation += part.translation, rotation += part.rotation, potentials += potential(k);
  }
  EnergyBalance balance{};
  if constexpr (has_ledger)
    balance = book_.balance(translation, rotation, potentials, walls, this->rank() == 0);
  if constexpr (has_ledger && has_bonds) balance.bonds = this->own_bond_energy();
  if constexpr (has_ledger && has_breakage) balance.parting = breaks_.parted;
  if constexpr (has_ledger && detail::deforms<Domain>) balance.box = domain_.work();
  if constexpr (has_ranks) {
    auto numbers = std::bit_cast<std::array<double, sizeof balance / sizeof(double)>>(balance);
    this->sum_over_ranks(std::span<double>(numbers));
    balance = std::bit_cast<EnergyBalance>(numbers);
  }
  return balance;
}

template <class... Policies>
typename Simulation<Policies...>::Kinetic Simulation<Policies...>::kinetic(std::size_t k) const {
  return {this->translational_energy(k), this->rotational_energy(k)};
}

template <class... Policies>
void Simulation<Policies...>::book_step([[maybe_unused]] const detail::StepTimes& times,
                                        [[maybe_unused]] double bond_power) {
  if constexpr (has_ledger) {
    double start = 0;
    if (first_kick_) {
      for (std::size_t k = 0; k < rows(); ++k)
        if (is_present(k) && std::isfinite(mass(k))) start += kinetic(k).sum() + potential(k);
      if constexpr (has_bonds) start += this->own_bond_energy();
    }
    if constexpr (Domain::periodic && !detail::deforms<Domain>) {
      const Vec3d moment = engine_.take_wrapped();
      if (!first_kick_) book_.went_round(-dot(gravity_booked_, moment));
    }
    if constexpr (has_bonds) book_.bonds_damped(bond_power, times.worked);
    engine_.contact_energy.worked(0.5 * times.worked);
    book_.book(engine_.contact_energy, engine_.walls, dt_,
               engine_.power_on_fixed() - detail::power_of_belts(engine_.walls),
               first_kick_ ? &start : nullptr, times.ask,
               [this](std::span<double> numbers) { this->sum_over_ranks(numbers); });
  }
}

/// Books a change of `gravity` since the last call.
template <class... Policies>
void Simulation<Policies...>::book_gravity() {
  if constexpr (has_ledger) {
    if (gravity == gravity_booked_) return;
    double change = 0;
    for (std::size_t k = 0; k < rows() && !first_kick_; ++k)
      if (is_present(k) && std::isfinite(mass(k)))
        change -= mass(k) * dot(gravity - gravity_booked_, position(k));
    book_.change_gravity(change);
    gravity_booked_ = gravity;
  }
}

template <class... Policies>
void Simulation<Policies...>::book_leaving([[maybe_unused]] std::size_t k) {
  if constexpr (has_breakage) this->note_leaving(k);
  if constexpr (FluidIs::sees_leaving) take_from_fluid(k, 1);
  if constexpr (has_ledger) {
    if (first_kick_ || !std::isfinite(mass(k))) return;
    // Unless the step is observed, rows hold the velocity of half a step ago, corrected here by
    // free fall.
    const double ago = !kicked_ && Integrator::first_kick == 0.5 ? 0.5 * dt_ : 0;  // [s]
    const Vec3d v = velocity(k), now = v + ago * gravity;
    book_.bring_in(0.5 * mass(k) * (dot(v, v) - dot(now, now)) - kinetic(k).sum() - potential(k));
    if (kicked_) return;
    // Work since the last forces, up to those velocities: the next step will not see the particle.
    const auto p = engine_.owner(k);
    const auto work_of = [&](const auto& loads, auto turns) {
      double power = dot(loads.force[k].vector(), p.velocity());
      if constexpr (decltype(turns)::value)
        power += dot(loads.torque[k].vector(), p.angular_velocity());
      return 0.5 * dt_ * power;
    };
    if constexpr (Fluid::active)
      book_.fluid_worked(work_of(engine_.fluid_loads(), std::bool_constant<turned_by_fluid>{}));
    if constexpr (Modules::push)
      book_.modules_worked(work_of(engine_.modules(), std::bool_constant<Modules::turn>{}));
  }
}

}  // namespace silt
