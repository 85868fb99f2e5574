// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <type_traits>

#include <silt/bond/concept.hpp>
#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET::detail {

/// As engine/contact/ask_on_lanes.hpp, for models of bonds: instantiates what is called for packs
/// of bonds with the probe; it is never run.
template <class Model>
void ask_bond_on_lanes(const Model& model, const BondStrain<ProbeLane>& s,
                       const typename Model::template Numbers<ProbeLane>& numbers) {
  const BondAnswer<ProbeLane> a = model.answer(s, numbers);
  model.load(a, s.normal, numbers);
  if constexpr (requires { model.holds(a, s.normal, numbers); }) model.holds(a, s.normal, numbers);
}

template <class Model>
concept BondOnLanes = requires(const Model& model, const BondStrain<ProbeLane>& s,
                               const BondAnswer<ProbeLane>& a,
                               const typename Model::template Numbers<ProbeLane>& numbers) {
  model.answer(s, numbers);
  model.load(a, s.normal, numbers);
};

/// True if a model of bonds compiles for packs of lanes; evaluated before any kernel is compiled.
template <class Model, class Arch>
constexpr bool bond_fits_lanes() {
  if constexpr (!std::is_same_v<Arch, OneLane>) {
    static_assert(BondOnLanes<Model>,
                  "the model of bonds works on one double, but not on a pack of lanes: make "
                  "answer() and load() templates of Real, as silt/bond/concept.hpp says, or give "
                  "KernelsFor<OneLane>");
    if constexpr (BondOnLanes<Model>) static_cast<void>(&ask_bond_on_lanes<Model>);
  }
  return true;
}

}  // namespace silt::detail
