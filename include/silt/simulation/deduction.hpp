// silt - BSD-3-Clause, see LICENSE
#pragma once

// Deduction of the type of a Simulation from a list of policies.

#include <cstddef>
#include <type_traits>

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

// The kernels' instruction set is always part of the type, so that translation units with different
// flags do not share a name for different code.
template <class... Ps>
struct WithKernels {
  using type = Policies<Ps..., KernelsFor<DefaultArch>>;
};
template <class... Ps>
requires(count<IsKernels, Ps...> > 0) struct WithKernels<Ps...> {
  using type = Policies<Ps...>;
};
/// Policies in the order of their axes, without defaults: scenes written in a different order have
/// one type, which is compiled once (silt/precompiled.hpp). A list that makes no valid simulation
/// is kept as it is, for the message about it.
template <class List>
struct Ordered {
  using type = List;
};
template <class... Ps>
requires make_a_simulation<Ps...>
struct Ordered<Policies<Ps...>> {
  using type = typename InOrder<Ps...>::All;
};
template <class... Args>
using OrderedFor = typename Ordered<typename WithKernels<std::remove_cvref_t<Args>...>::type>::type;
/// The policy at a place of a list; void behind its end.
template <std::size_t k, class List>
struct PolicyOf {
  using type = void;
};
template <class First, class... Rest>
struct PolicyOf<0, Policies<First, Rest...>> {
  using type = First;
};
template <std::size_t k, class First, class... Rest>
requires(k > 0) struct PolicyOf<k, Policies<First, Rest...>> : PolicyOf<k - 1, Policies<Rest...>> {
};

template <class... Args>
inline constexpr std::size_t policies_in_order = OrderedFor<Args...>::number;
template <std::size_t k, class... Args>
using PolicyAt = typename PolicyOf<k, OrderedFor<Args...>>::type;

}  // namespace detail

// A deduction guide cannot name a list of types, only their places. Lists of more than five are
// kept as they are written.
template <class... Args>
requires(detail::policies_in_order<Args...> == 3) Simulation(Args&&...)
->Simulation<detail::PolicyAt<0, Args...>, detail::PolicyAt<1, Args...>,
             detail::PolicyAt<2, Args...>>;
template <class... Args>
requires(detail::policies_in_order<Args...> == 4) Simulation(Args&&...)
->Simulation<detail::PolicyAt<0, Args...>, detail::PolicyAt<1, Args...>,
             detail::PolicyAt<2, Args...>, detail::PolicyAt<3, Args...>>;
template <class... Args>
requires(detail::policies_in_order<Args...> == 5) Simulation(Args&&...)
->Simulation<detail::PolicyAt<0, Args...>, detail::PolicyAt<1, Args...>,
             detail::PolicyAt<2, Args...>, detail::PolicyAt<3, Args...>,
             detail::PolicyAt<4, Args...>>;
template <class... Args>
requires(detail::policies_in_order<Args...><3 || detail::policies_in_order<Args...>> 5) &&
    (detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> > 0) Simulation(Args&&...)
        ->Simulation<std::remove_cvref_t<Args>...>;
template <class... Args>
requires(detail::policies_in_order<Args...><3 || detail::policies_in_order<Args...>> 5) &&
    (detail::count<detail::IsKernels, std::remove_cvref_t<Args>...> == 0) Simulation(Args&&...)
        ->Simulation<std::remove_cvref_t<Args>..., KernelsFor<DefaultArch>>;

}  // namespace silt
