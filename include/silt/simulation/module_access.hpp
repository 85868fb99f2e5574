// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/module/heat/temperature.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Access to the modules of a Simulation; member functions of Simulation.
template <class Sim>
class ModuleAccess {
 public:
  /// The fields of a module for particle k, to read and to set: sim.field<Residence>(k).seconds. Or
  /// a quantity, whichever module provides it: sim.field<Temperature>(k) = 350.
  template <class M>
  auto& field(std::size_t k) {
    return of<M>(sim(), k);
  }
  template <class M>
  const auto& field(std::size_t k) const {
    return of<M>(sim(), k);
  }
  /// The Field of this name: sim.field<"charge">(k) = 1e-12.
  template <FixedName Name>
  auto& field(std::size_t k) {
    return field<typename Sim::Modules::template named<Name>>(k).value;
  }
  template <FixedName Name>
  const auto& field(std::size_t k) const {
    return field<typename Sim::Modules::template named<Name>>(k).value;
  }
  /// Calls visit.operator()<Components>(name, value) for each field of each module; value(k) is a
  /// double or, for a vector field, three of them.
  template <class Visit>
  void for_each_field(const Visit& visit) const {
    sim().engine_.modules().for_each_field(visit);
  }
  /// A module itself; its parameters may be changed between runs and in observers.
  template <class M>
  M& module() {
    return sim().modules_.template get<M>();
  }
  template <class M>
  const M& module() const {
    return sim().modules_.template get<M>();
  }
  /// What a wall gives to the particles through a module with a flux, now and in total: heat [W],
  /// [J]. Negative: the wall receives. M is the module, or a quantity that it provides:
  /// given_by_wall<Temperature>(wall). With several ranks, to all particles (collective).
  template <class M>
  WallGiven given_by_wall(const WhichWall& which) const {
    if constexpr (FieldQuantity<M>) {
      return given_by_wall<typename Sim::Modules::template having<typename M::Of>>(which);
    } else {
      static_assert(flows_at_walls<M>,
                    "nothing flows from walls for this module: it has no at_wall()");
      const std::size_t w = sim().wall_number(which);
      const auto& all = sim().engine_.fluxes().template from_walls<M>();
      WallGiven given = w < all.size() ? all[w] : WallGiven{};
      if constexpr (Sim::has_ranks) {
        std::array<double, 2> both{given.rate, given.sum};
        sim().sum_over_ranks(std::span<double>(both));
        given.rate = both[0], given.sum = both[1];
      }
      return given;
    }
  }
  /// Changes the thermal condition of a wall, between runs or in observers: held_at(), heated_by()
  /// or insulated(). It takes effect in the next step and is saved in checkpoints. InputError: no
  /// such wall, or its material is unknown to the heat module.
  void set_wall_heat(const WhichWall& which, WallHeat heat) {
    auto& module =
        sim().modules_.template get<typename Sim::Modules::template having<HeatFields>>();
    static_assert(
        requires { module.walls.of(0); },
        "set_wall_heat: the module of heat of this simulation knows no walls; take "
        "silt::HeatConduction, or one that adds to it");
    const std::size_t w = sim().wall_number(which);
    module.check_wall(sim(), w, heat);
    module.walls.set(sim(), w, std::move(heat), "HeatConduction.walls");
    sim().flux_every_ = 1;  // evaluate fluxes anew
  }
  /// The sum of module forces on particle k at present [N].
  Vec3d module_force(std::size_t k) const {
    static_assert(Sim::Modules::push, "no module of this simulation has a force");
    return sim().engine_.modules().force[sim().known(k)].vector();
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  template <class M, class S>
  static auto& of(S& sim, std::size_t k) {
    if constexpr (FieldQuantity<M>)
      return column<typename Sim::Modules::template having<typename M::Of>>(sim)[sim.known(k)].*
             M::member;
    else
      return column<M>(sim)[sim.known(k)];
  }
  template <class M, class S>
  static auto& column(S& sim) {
    static_assert(has_fields<M>, "this module has no Fields");
    static_assert(Sim::Modules::template times<M> == 1, "this simulation has no such module");
    return sim.engine_.modules().template of<M>();
  }
};

}  // namespace silt::detail
