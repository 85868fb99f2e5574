// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of CoupledFlow: heat exchange between particles and cells in a fluid step.

#include <silt/coupling/coupled_flow.hpp>

namespace silt::inline SILT_TARGET {

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::spread_heat(
    [[maybe_unused]] const CoupledParticles& of, [[maybe_unused]] double dt,
    [[maybe_unused]] const Team& team) {
  if constexpr (has_heat) {
    const ParticleHeat& heat = *of.heat;
    const std::size_t n = of.velocity.size();
    require(flow_.has_heat(),
            "CoupledFlow: particles exchange heat, but the flow has no temperature; give it one by "
            "FlowSolver::set_heat()");
    require(flow_.heat().conductivity > 0,
            "CoupledFlow: particles exchange heat, but FluidHeat.conductivity is 0 W/(m K), and "
            "no Nusselt number gives a heat transfer; set it to the fluid's conductivity");
    require(heat.temperature.size() == n && heat.capacity.size() == n,
            "ParticleHeat: ", heat.temperature.size(), " temperatures and ", heat.capacity.size(),
            " capacities for ", n, " velocities; give one each");
    conducts_.resize(n), gives_.resize(n);
    const FluidAtParticles& at = exchange_.at;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        conducts_[p] = gives_[p] = 0;
        if (exchange_.is_outside(p)) continue;
        const HeatedFluid here{vector_of(at.velocity, p) - of.velocity[p],
                               std::clamp(at.voidage[p], least_voidage, 1.0),
                               flow_.fluid().density,
                               flow_.fluid().viscosity,
                               flow_.heat().heat_capacity,
                               flow_.heat().conductivity,
                               2 * of.shape.radius[p]};
        conducts_[p] = ParticleHeat::coefficient(heat.conductance(p, here), heat.capacity[p], dt);
        gives_[p] = conducts_[p] * heat.temperature[p];
      }
    });
    const std::span<const double> from[] = {conducts_, gives_};
    CellField* const to[] = {&flow_.heat_exchange(), &flow_.heat_of_particles()};
    if constexpr (heats_apart) {
      if (!heats_ || opened_for_heat_ != opened_) {
        heats_.emplace(Kernel{.form = Kernel::Form::Cube}, flow_.grid(), *diameter);
        if (const CellField* open = flow_.open_cells()) heats_->open(*open, team);
        opened_for_heat_ = opened_;
      }
      heats_->place(of.shape, team);
    }
    averaging_of_heat().spread(from, to, team);
    share_out(to, team);
  }
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::take_heat(
    [[maybe_unused]] const ParticleHeat& heat, [[maybe_unused]] double dt,
    [[maybe_unused]] CoupledStep& done, [[maybe_unused]] const Team& team) {
  if constexpr (has_heat) {
    seen_.resize(heat.temperature.size());
    CellField& field = flow_.temperature_seen();
    join(field);
    const CellField* const from[] = {&field};
    const std::span<double> to[] = {seen_};
    averaging_of_heat().gather(from, to, team);
    for (std::size_t p = 0; p < seen_.size(); ++p) {
      const double q = dt * (conducts_[p] * seen_[p] - gives_[p]);  // [J]
      done.heat += q, done.heat_terms += dt * gives_[p];
      heat.temperature[p] += q / heat.capacity[p];
    }
    done.heat_error = done.heat + flow_.heat_from_particles();
  }
}

}  // namespace silt
