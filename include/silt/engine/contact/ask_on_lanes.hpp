// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/contacts.hpp>
#include <silt/core/lanes.hpp>
#include <silt/engine/contact/contact_energy.hpp>
#include <silt/engine/state/module_columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Instantiates all functions of a law that the engine calls, with a probe type for the lanes; it
/// is never run.
template <class ContactsType, class Law = typename ContactsType::Law>
void ask_law_on_lanes(const Contact<ProbeLane>& c,
                      const typename Law::template Coefficients<ProbeLane>& p,
                      typename HistoryOf<Law, ProbeLane>::type& h) {
  law_force<Law, ProbeLane>(c, p, h);
  if constexpr (ActsAtDistance<Law>) Law::range(p, c.R_eff);
  if constexpr (has_safeguard<Law>) Law::safeguarded(h, h);
  if constexpr (ContactsType::has_rolling) Law::stiffness(c, p);
  if constexpr (ContactsType::has_rolling || keeps_ledger<ContactsType>)
    if constexpr (requires { Law::pressing(c, p, c.overlap); }) Law::pressing(c, p, c.overlap);
  if constexpr (keeps_ledger<ContactsType> && SaysWhatItStores<Law>)
    stored_by<Law, ProbeLane>(c, p, h);
}

template <class Model>
concept TorqueOnLanes = requires(const RollingContact<ProbeLane>& c,
                                 const OwnRotations<ProbeLane>& own,
                                 const typename Model::template Coefficients<ProbeLane>& p,
                                 typename HistoryOf<Model, ProbeLane>::type& h) {
  requires requires { Model::torque(c, p); } || requires {
    Model::torque(c, p, h);
  } || requires {
    Model::torque(c, own, p);
  };
};

template <class ContactsType, class Model = typename ContactsType::Rolling>
void ask_rolling_on_lanes(const RollingContact<ProbeLane>& c, const OwnRotations<ProbeLane>& own,
                          const typename Model::template Coefficients<ProbeLane>& p,
                          typename HistoryOf<Model, ProbeLane>::type& h) {
  if constexpr (of_own_rotation<Model>)
    Model::torque(c, own, p);
  else if constexpr (HasHistory<Model>)
    Model::torque(c, p, h);
  else
    Model::torque(c, p);
  if constexpr (keeps_ledger<ContactsType>)
    if constexpr (requires { Model::stored(c, p, h); }) Model::stored(c, p, h);
}

/// True if the law and the rolling model of a Contacts type compile for packs of lanes. If not, the
/// compiler reports the place in their code, with the explanation of the probe. It is evaluated in
/// a constant expression, before the kernels and without generating code. A scene that names
/// OneLane is not tested.
template <class ContactsType, class Arch>
constexpr bool laws_fit_lanes() {
  if constexpr (!std::is_same_v<Arch, OneLane>) {
    using Law = typename ContactsType::Law;
    using Rolling = typename ContactsType::Rolling;
    static_assert(
        WorksOnLanes<Law, ProbeLane>,
        "the contact law works on one double, but not on a pack of lanes: make force() a template "
        "of Real, as silt/contact/concept.hpp says, or give KernelsFor<OneLane>");
    static_assert(
        !ContactsType::has_rolling || TorqueOnLanes<Rolling>,
        "the rolling model works on one double, but not on a pack of lanes: make torque() a "
        "template of Real, as silt/contact/concept.hpp says, or give KernelsFor<OneLane>");
    if constexpr (WorksOnLanes<Law, ProbeLane>) static_cast<void>(&ask_law_on_lanes<ContactsType>);
    if constexpr (ContactsType::has_rolling && TorqueOnLanes<Rolling>)
      static_cast<void>(&ask_rolling_on_lanes<ContactsType>);
  }
  return true;
}

/// Instantiates a module's flux with the probe; it is never run.
template <class M>
void ask_flux_on_lanes(const M& m, const Touching<ProbeLane>& c,
                       const typename CoefficientsOf<M>::template type<ProbeLane>& p,
                       const ProbeLane& a) {
  flux_of<M, ProbeLane>(m, c, p, a, a);
}
template <class M>
constexpr void ask_module_on_lanes() {
  if constexpr (Exchanges<M> && FluxOnLanes<M, double>) {
    static_assert(FluxOnLanes<M, ProbeLane>,
                  "a module's flux() works on one double, but not on a pack of lanes: make it a "
                  "template of Real, as silt/module/concept.hpp says");
    if constexpr (FluxOnLanes<M, ProbeLane>) static_cast<void>(&ask_flux_on_lanes<M>);
  }
}
/// The same for the fluxes of modules.
template <class Arch, class... Ms>
constexpr bool fluxes_fit_lanes(const ModuleList<Ms...>*) {
  if constexpr (!std::is_same_v<Arch, OneLane>) (ask_module_on_lanes<Ms>(), ...);
  return true;
}

}  // namespace silt::detail
