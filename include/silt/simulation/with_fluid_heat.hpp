// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation that exchange heat between particles and a fluid.

#include <concepts>
#include <tuple>

#include <silt/coupling/heat_exchange.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// The module of a simulation whose particles exchange heat with the fluid.
template <class M>
concept HeatsInFluid = Exchanges<M> && requires(const M& m, const Seen& p, const HeatedFluid& f) {
  { m.conductance(p, f) } -> std::convertible_to<double>;
  { m.capacity(p) } -> std::convertible_to<double>;
};
template <class List>
struct FindHeated;
template <class... Ms>
struct FindHeated<ModuleList<Ms...>> {
  static constexpr int count = (0 + ... + int{HeatsInFluid<Ms>});
  static_assert(count <= 1, "two modules exchange heat with the fluid: give one of them");
  static constexpr std::size_t at = [] {
    std::size_t k = 0, found = 0;
    ((HeatsInFluid<Ms> ? found = k++ : k++), ...);
    return found;
  }();
  using type = std::tuple_element_t<at, std::tuple<Ms..., void>>;
};
template <class List>
inline constexpr bool heats_in_fluid = FindHeated<List>::count > 0;
template <class List>
using HeatedModule = typename FindHeated<List>::type;

template <class Fluid>
void check_heat_of_fluid(const Fluid& fluid) {
  constexpr bool fits = requires { requires Fluid::has_heat; };
  static_assert(fits,
                "FluidConvection exchanges heat with a CoupledFlow: give the simulation one, whose "
                "flow has set_heat(); a gas of given temperature is silt::Convection");
  if constexpr (fits)
    require(fluid.flow().has_heat(),
            "FluidConvection: the flow of the CoupledFlow has no temperature; give it one by "
            "FlowSolver::set_heat()");
}

}  // namespace detail

/// The heat exchanged with particles in the fluid's step; after gather_for_fluid().
template <class... Policies>
ParticleHeat Simulation<Policies...>::heat_in_fluid() {
  ParticleHeat heat;
  if constexpr (detail::heats_in_fluid<Modules>) {
    using M = detail::HeatedModule<Modules>;
    auto& p = in_fluid_;
    const auto& fields = engine_.modules().template of<M>();
    p.temperature.resize(p.place.size()), p.capacity.resize(p.place.size());
    for (std::size_t n = 0; n < p.place.size(); ++n) {
      const std::size_t k = p.place[n];
      p.temperature[n] = fields[k].*M::exchanged;
      p.capacity[n] = modules_.template get<M>().capacity(engine_.seen(k, time_));
    }
    heat.temperature = p.temperature, heat.capacity = p.capacity;
    heat.conductance = [this](std::size_t n, const HeatedFluid& here) {
      return modules_.template get<M>().conductance(engine_.seen(in_fluid_.place[n], time_), here);
    };
  }
  return heat;
}
template <class... Policies>
void Simulation<Policies...>::take_heat_of_fluid() {
  if constexpr (detail::heats_in_fluid<Modules>) {
    using M = detail::HeatedModule<Modules>;
    auto& fields = engine_.modules().template of<M>();
    for (std::size_t n = 0; n < in_fluid_.place.size(); ++n)
      fields[in_fluid_.place[n]].*M::exchanged = in_fluid_.temperature[n];
  }
}

}  // namespace silt
