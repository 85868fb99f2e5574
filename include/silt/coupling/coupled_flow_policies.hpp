// silt - BSD-3-Clause, see LICENSE
#pragma once

// CoupledFlow with policies in any order, and its messages if they do not fit together.

#include <concepts>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/coupling/coupled_flow.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Meant as a drag law of spheres; a law that compiles only for double has its own message.
template <class L>
concept NormalisesDoubles = requires(const L& law, const double& eps) {
  { law.normalised(eps, eps) } -> std::convertible_to<double>;
};
template <class L>
concept MeantAsDrag = NormalisesDoubles<L> || OrientedDragLaw<L>;
template <class L>
concept AnyDragLaw = DragLaw<L> || OrientedDragLaw<L>;

/// A class with a member of that name, whatever its signature.
struct NameOfDrag {
  int normalised;
};
template <class L>
struct BesideNameOfDrag : L, NameOfDrag {};
template <class L>
inline constexpr bool names_drag = [] {
  if constexpr (std::is_class_v<L> && !std::is_final_v<L>) return !requires {
      &BesideNameOfDrag<L>::normalised;
    };
  return false;
}();

struct NotGiven {};
struct NoFlowSolver {};  // placeholder, if there is no flow

/// Positions of drag, mode and flow among policies in any order; all others are forces. A type that
/// is only a drag law is the drag; otherwise the first that may be one, as SlowEllipsoid, which is
/// also a force.
template <class... Policies>
struct FluidPolicies {
  static constexpr std::size_t count = sizeof...(Policies), none = count;
  static constexpr std::size_t first(const bool (&is)[count + 1]) {
    std::size_t k = 0;
    while (k < count && !is[k]) ++k;
    return k;
  }
  static constexpr std::size_t drag = [] {
    const std::size_t alone = first({(MeantAsDrag<Policies> && !FluidForce<Policies>)..., false});
    return alone < none ? alone : first({MeantAsDrag<Policies>..., false});
  }();
  static constexpr std::size_t mode = first({AveragingMode<Policies>..., false});
  static constexpr std::size_t flow = first({FlowOnGrid<Policies>..., false});

  template <std::size_t k>
  using At = std::tuple_element_t<k, std::tuple<Policies..., NotGiven>>;
  using Drag = At<drag>;
  using Mode = At<mode>;
  using Flow = std::conditional_t < flow<none, At<flow>, FlowSolver>;
  static constexpr bool is_force(std::size_t k) { return k != drag && k != mode && k != flow; }
  static constexpr std::size_t forces = count - (drag < none) - (mode < none) - (flow < none);
  /// Position of force number `wanted`.
  static constexpr std::size_t force(std::size_t wanted) {
    std::size_t k = 0;
    while (!is_force(k) || wanted-- > 0) ++k;
    return k;
  }
  static constexpr bool fit =
      AnyDragLaw<Drag> && AveragingMode<Mode>&&[]<std::size_t... k>(std::index_sequence<k...>) {
    return (FluidForce<At<force(k)>> && ...);
  }
  (std::make_index_sequence<forces>());
};

template <class P, class Forces = std::make_index_sequence<P::forces>>
struct SortedFlow;
template <class P, std::size_t... k>
struct SortedFlow<P, std::index_sequence<k...>> {
  using Type = BasicCoupledFlow<typename P::Flow, typename P::Drag, typename P::Mode,
                                typename P::template At<P::force(k)>...>;
  template <class Args>
  static Type make(Args&& given) {
    static_assert(P::flow < P::count, "CoupledFlow needs the flow: give one silt::FlowSolver");
    if constexpr (P::flow < P::count)
      return {std::get<P::drag>(given), std::get<P::mode>(given),
              std::get<P::flow>(std::forward<Args>(given)), std::get<P::force(k)>(given)...};
  }
};

template <class T>
inline constexpr bool is_coupled_flow = false;

}  // namespace detail

/// Fluid of a Simulation: a drag law, an averaging mode, a flow (FlowSolver, or any FlowOnGrid) and
/// further forces, in any order. Equations: BasicCoupledFlow (coupled_flow.hpp).
///
///   silt::CoupledFlow fluid{silt::Gidaspow{}, silt::Kernel{}, flow, silt::VirtualMass{}};
///
/// As a type, FlowSolver may be left out: CoupledFlow<Gidaspow, Kernel>.
/// Tests: tests/coupling/simulation.cpp, tests/compile/refused/.
template <class... Policies>
class CoupledFlow : public detail::SortedFlow<detail::FluidPolicies<Policies...>>::Type {
  using Sorted = detail::SortedFlow<detail::FluidPolicies<Policies...>>;

 public:
  template <class... Args>
  requires(!(detail::is_coupled_flow<std::remove_cvref_t<Args>> ||
             ...)) explicit CoupledFlow(Args&&... args)
      : Sorted::Type(detail::SortedFlow<detail::FluidPolicies<std::remove_cvref_t<Args>...>>::make(
            std::forward_as_tuple(std::forward<Args>(args)...))) {}
};
template <class... Policies>
inline constexpr bool detail::is_coupled_flow<CoupledFlow<Policies...>> = true;

/// Arguments that do not fit together: gives the message, and no further errors.
template <class... Policies>
requires(!detail::FluidPolicies<Policies...>::fit) class CoupledFlow<Policies...> {
  using P = detail::FluidPolicies<Policies...>;
  static constexpr bool has_drag = P::drag < P::count, has_mode = P::mode < P::count;
  static constexpr bool fits_lanes = !has_drag || detail::AnyDragLaw<typename P::Drag>;
  static constexpr bool has_flow = !(std::is_same_v<Policies, detail::NoFlowSolver> || ...);
  static constexpr bool misnamed = !has_drag && (detail::names_drag<Policies> || ...);
  static_assert(!misnamed,
                "a drag law's normalised() does not fit: it must be `template <class Real> Real "
                "normalised(const Real& eps, const Real& Re) const`, or `double normalised(const "
                "silt::InFluid&, double Re) const`, and public: silt/coupling/drag/concept.hpp, "
                "oriented.hpp");
  static_assert(has_drag || misnamed,
                "CoupledFlow needs a drag law (silt/coupling/drag/concept.hpp, oriented.hpp)");
  static_assert(
      fits_lanes,
      "the drag law compiles for double only: make normalised(eps, Re) a template of Real, which "
      "must "
      "work for any type of number: double, float and packs of them, one lane a particle, as "
      "silt/coupling/drag/concept.hpp says");
  static_assert(has_mode,
                "CoupledFlow needs an averaging mode: Unresolved, TwoGrid, Kernel or Diffusion "
                "(silt/coupling/averaging/concept.hpp)");
  static_assert(has_flow, "CoupledFlow needs the flow: give one silt::FlowSolver");
  static_assert(
      !(has_drag && fits_lanes && has_mode && has_flow),
      "an argument of CoupledFlow is of a wrong type, or there is one too many: it takes one "
      "drag law, one averaging mode, one flow, and forces, in any order "
      "(silt/coupling/fluid_force.hpp)");

 public:
  static constexpr bool active = false;  // avoids further errors in Simulation
  template <class... Args>
  explicit CoupledFlow(Args&&...) {}
};

template <class... Args>
requires(FlowOnGrid<std::remove_cvref_t<Args>> || ...) CoupledFlow(Args&&...)
->CoupledFlow<std::remove_cvref_t<Args>...>;
template <class... Args>
requires(!((FlowOnGrid<std::remove_cvref_t<Args>> ||
            detail::is_coupled_flow<std::remove_cvref_t<Args>>) ||
           ...)) CoupledFlow(Args&&...)
->CoupledFlow<std::remove_cvref_t<Args>..., detail::NoFlowSolver>;

}  // namespace silt
