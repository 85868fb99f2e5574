// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <type_traits>
#include <utility>

#include <silt/contact/contacts.hpp>
#include <silt/coupling/no_fluid.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/fill/particles.hpp>
#include <silt/module/concept.hpp>
#include <silt/motion/concept.hpp>
#include <silt/motion/rotation.hpp>
#include <silt/parallel/comm.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET {

/// The instruction set that the kernels use: an xsimd architecture, or OneLane.
template <class Arch>
struct KernelsFor {
  using type = Arch;
};

namespace detail {

template <class P>
struct IsParticles : std::false_type {};
template <class S>
struct IsParticles<Particles<S>> : std::true_type {};

template <class P>
struct IsContacts : std::bool_constant<is_contacts<P>> {};

/// A search policy is a finder itself, or contains one (a Verlet list).
template <class P>
        struct IsSearch : std::bool_constant < NeighbourSearch<P> ||
    requires(P p) {
  requires NeighbourSearch<decltype(p.finder)>;
} > {};

template <class P>
    struct IsDomain : std::bool_constant < requires {
  P::is_domain;
} > {};

/// Placeholder for a fluid. The engine only knows which loads a fluid gives, so it is the same
/// engine for all drag laws.
template <FromFluid What>
struct FluidThatGives {
  static constexpr bool active = What != FromFluid::Nothing, turns = detail::turns(What),
                        follows = detail::follows(What);
};

template <class P>
struct IsFluid : std::bool_constant<FluidCoupling<P>> {};
template <FromFluid What>
struct IsFluid<FluidThatGives<What>> : std::true_type {};

/// Which loads particles receive from a fluid.
template <class F>
inline constexpr FromFluid loads_of_fluid = [] {
  using Is = FluidTraits<F>;
  if constexpr (!Is::active)
    return FromFluid::Nothing;
  else if constexpr (Is::follows)
    return Is::turns ? FromFluid::FollowedForceAndTorque : FromFluid::FollowedForce;
  else
    return Is::turns ? FromFluid::ForceAndTorque : FromFluid::Force;
}();

template <class P>
struct IsKernels : std::false_type {};
template <class Arch>
struct IsKernels<KernelsFor<Arch>> : std::true_type {};

template <class P>
    struct IsPrecision : std::bool_constant < requires {
  typename P::PairScalar;
} > {};

template <class P>
    struct IsLedger : std::bool_constant < requires {
  requires P::is_ledger;
} > {};

template <class P>
    struct IsContactEvents : std::bool_constant < requires {
  requires P::is_contact_events;
} > {};

template <class P>
struct IsIntegrator : std::bool_constant<Integrator<P>> {};

template <class P>
struct IsRotation : std::bool_constant<RotationIntegrator<P>> {};

template <class P>
struct IsModule : std::bool_constant<Module<P>> {};

template <class P>
    struct IsBonds : std::bool_constant < requires {
  requires P::is_bonds;
} > {};

template <class P>
    struct IsBreakage : std::bool_constant < requires {
  requires P::is_breakage;
} > {};

template <class P>
    struct IsRanks : std::bool_constant < requires {
  requires P::is_ranks;
} > {};
template <>
struct IsRanks<NoRanks> : std::true_type {};

template <class P>
inline constexpr bool belongs_to_an_axis =
    IsParticles<P>::value || IsContacts<P>::value || IsSearch<P>::value || IsDomain<P>::value ||
    IsFluid<P>::value || IsKernels<P>::value || IsPrecision<P>::value || IsLedger<P>::value ||
    IsContactEvents<P>::value || IsIntegrator<P>::value || IsRotation<P>::value ||
    IsModule<P>::value || IsBonds<P>::value || IsRanks<P>::value;

template <template <class> class Is, class... Policies>
inline constexpr int count = (0 + ... + int{Is<Policies>::value});

/// At most one policy per axis (any number of modules); particles and contacts are required.
template <class... Policies>
inline constexpr bool make_a_simulation =
    count<IsParticles, Policies...> == 1 && count<IsContacts, Policies...> == 1 &&
    count<IsSearch, Policies...> <= 1 && count<IsDomain, Policies...> <= 1 &&
    count<IsFluid, Policies...> <= 1 && count<IsIntegrator, Policies...> <= 1 &&
    count<IsRotation, Policies...> <= 1 && count<IsPrecision, Policies...> <= 1 &&
    count<IsKernels, Policies...> <= 1 && count<IsLedger, Policies...> <= 1 &&
    count<IsContactEvents, Policies...> <= 1 && count<IsBonds, Policies...> <= 1 &&
    count<IsBreakage, Policies...> <= 1 && count<IsRanks, Policies...> <= 1 &&
    (belongs_to_an_axis<Policies> && ...);

template <template <class> class Is, class Default, class... Policies>
struct Pick {
  using type = Default;
};
template <template <class> class Is, class Default, class First, class... Rest>
struct Pick<Is, Default, First, Rest...> {
  using type = typename std::conditional_t<Is<First>::value, std::type_identity<First>,
                                           Pick<Is, Default, Rest...>>::type;
};
/// The policy of one axis, or its default.
template <template <class> class Is, class Default, class... Policies>
using pick = typename Pick<Is, Default, Policies...>::type;

/// The argument of type T among the given ones.
template <class T, class First, class... Rest>
T& take(First& first, Rest&... rest) {
  if constexpr (std::is_same_v<T, std::remove_cv_t<First>>)
    return const_cast<T&>(first);
  else
    return take<T>(rest...);
}
template <class T, class... Args>
T take_or(Args&... args) {
  if constexpr ((std::is_same_v<T, std::remove_cv_t<Args>> || ...))
    return take<T>(args...);
  else
    return T{};
}

}  // namespace detail
}  // namespace silt
