// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/boundary/deforming_box.hpp>
#include <silt/boundary/domain.hpp>
#include <silt/core/precision.hpp>
#include <silt/engine/state/axes.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/motion/leapfrog.hpp>
#include <silt/search/verlet_list.hpp>
#include <silt/shape/concept.hpp>
#include <silt/shape/sphere.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What contacts store and provide in addition to the law, depending on the shape.
template <class ShapeType, class Contacts>
struct ContactsOf;
template <class ContactsType>
struct WithOffset;
template <class ContactsType>
struct WithLedger;
template <class ContactsType>
struct WithEvents;
template <class ContactsType>
struct WithVirial;
template <class ContactsType, bool ByForce>
struct WithImpacts;
template <bool Watched, class Contacts>
using WatchedIf = typename std::conditional_t<Watched, std::type_identity<WithEvents<Contacts>>,
                                              std::type_identity<Contacts>>::type;

template <bool Kept, class Contacts>
using WithOffsetIf = typename std::conditional_t<Kept, std::type_identity<WithOffset<Contacts>>,
                                                 std::type_identity<Contacts>>::type;

template <class Breaking, class Contacts>
struct WithImpactsOf {
  using type = WithImpacts<Contacts, Breaking::by_force>;
};

template <bool Summed, class Contacts>
using WithVirialIf = typename std::conditional_t<Summed, std::type_identity<WithVirial<Contacts>>,
                                                 std::type_identity<Contacts>>::type;

/// Used without Bonds.
struct NoBonds {};
/// Used without Breakage.
struct NoBreakage {};
template <class Contacts>
struct WithImpactsOf<NoBreakage, Contacts> {
  using type = Contacts;
};

template <class List, class... Policies>
struct OnlyModules {
  using type = List;
};
template <class... Ms, class First, class... Rest>
struct OnlyModules<ModuleList<Ms...>, First, Rest...> {
  using type = typename std::conditional_t<IsModule<First>::value,
                                           OnlyModules<ModuleList<Ms..., First>, Rest...>,
                                           OnlyModules<ModuleList<Ms...>, Rest...>>::type;
};

/// The policies of a simulation by axis, and everything derived from their types. It is the
/// template argument of the engine's parts. SIMD kernels receive only what changes their code, so
/// that simulations share compiled kernels.
template <class... Policies>
struct Composition {
  using ParticlesType = pick<IsParticles, void, Policies...>;
  using UserContacts = pick<IsContacts, void, Policies...>;
  using Search = pick<IsSearch, VerletList<>, Policies...>;
  using Domain = pick<IsDomain, OpenDomain, Policies...>;
  using Fluid = pick<IsFluid, NoFluid, Policies...>;
  using Arch = typename pick<IsKernels, KernelsFor<DefaultArch>, Policies...>::type;
  using Precision = pick<IsPrecision, Double, Policies...>;
  using Integrator = pick<IsIntegrator, Leapfrog, Policies...>;
  using Rotation = pick<IsRotation, NoSquish, Policies...>;
  using Modules = typename OnlyModules<ModuleList<>, Policies...>::type;
  using Bonds = pick<IsBonds, NoBonds, Policies...>;
  using Breaking = pick<IsBreakage, NoBreakage, Policies...>;
  using Ranks = pick<IsRanks, NoRanks, Policies...>;
  using Shape = typename ParticlesType::ShapeType;
  using Scalar = typename Precision::PairScalar;  // precision of the pair computations

  static constexpr bool of_bodies = BodyShape<Shape>;      // rows are parts of rigid bodies
  static constexpr bool has_surfaces = SolidShape<Shape>;  // with their own narrow phases
  static constexpr bool has_ledger = count<IsLedger, Policies...> > 0;
  static constexpr bool has_events = count<IsContactEvents, Policies...> > 0;
  static constexpr bool has_bonds = count<IsBonds, Policies...> > 0;
  static constexpr bool has_breakage = count<IsBreakage, Policies...> > 0;
  static constexpr bool has_ranks = !std::is_same_v<Ranks, NoRanks>;
  static constexpr bool rotates = UserContacts::rotates || of_bodies;
  static constexpr FromFluid from_fluid = loads_of_fluid<Fluid>;

  // Each wrapper adds history values behind those of the type it wraps (contact_memory.hpp).
  using LedgerContacts = std::conditional_t<has_ledger, WithLedger<UserContacts>, UserContacts>;
  using ShapeContacts = typename ContactsOf<Shape, LedgerContacts>::type;
  using OffsetContacts = WithOffsetIf<has_bonds || has_breakage, ShapeContacts>;
  using ImpactContacts = typename WithImpactsOf<Breaking, OffsetContacts>::type;
  using Contacts = WithVirialIf<deforms<Domain>, WatchedIf<has_events, ImpactContacts>>;
  static constexpr bool several_materials = Contacts::several_materials;

  static_assert(of_bodies || count<IsRotation, Policies...> == 0,
                "spheres have no orientation: leave the rotation out");
  static_assert(rotates || !turns(from_fluid),
                "a force of the fluid has a torque, but these spheres do not rotate: take a "
                "contact law with friction, or leave that force out");
  static_assert(rotates || !Modules::turn,
                "a module's force has a torque, but these spheres do not rotate: take a contact "
                "law with friction, or let its force() return a silt::Vec3d");
  static_assert(!has_bonds || (rotates && !of_bodies),
                "Bonds join spheres that rotate: take Particles<Sphere> and a contact law with "
                "friction");
  static_assert(!has_bonds || Integrator::derivatives == 0,
                "Bonds turn particles by the velocities of half steps; take Leapfrog");
  static_assert(
      !has_breakage || !of_bodies || requires { Shape::is_cut_into_cells; },
      "Breakage is for spheres and polyhedra: other bodies do not break; take "
      "Particles<Sphere> or Particles<Polyhedron>");
  static_assert(!deforms<Domain> || !has_breakage,
                "Breakage knows no DeformingBox; take PeriodicBox");
  static_assert(!deforms<Domain> || from_fluid == FromFluid::Nothing,
                "DeformingBox cannot be coupled to a fluid, whose grid does not deform; take "
                "PeriodicBox, or leave the fluid out");
  static_assert(!deforms<Domain> || Integrator::derivatives == 0,
                "DeformingBox changes velocities at each step, which Gear spreads over several; "
                "take Leapfrog");
  static_assert(!deforms<Domain> || !has_ledger || !Modules::push,
                "EnergyLedger cannot book the work of modules in a DeformingBox, where energies "
                "are relative to its flow; leave one of them out");
  static_assert(!has_ranks || std::is_same_v<Fluid, NoFluid> || !FluidTraits<Fluid>::active,
                "Ranks cannot be coupled to a fluid so far: each rank would need the flow of all; "
                "leave one of them out");
  static_assert(!has_ranks || !deforms<Domain>,
                "Ranks does not go with a DeformingBox so far; take PeriodicBox");
  static_assert(!has_surfaces || std::is_same_v<Scalar, double>,
                "Mixed precision is for spheres and bodies made of spheres; leave it out");
};

/// Policies in the order of their axes, without those equal to the default. However a user orders
/// them, a simulation has one composition, and its engine is compiled once.
template <class... Ps>
struct Policies {
  template <class... More>
  static Policies<Ps..., More...> with(Policies<More...>);
  using Composed = Composition<Ps...>;
  static constexpr std::size_t number = sizeof...(Ps);
};
/// The policies among `Ps` that belong to an axis, without its default.
template <template <class> class Is, class Default, class... Ps>
struct OfAxis {
  using type = Policies<>;
};
template <template <class> class Is, class Default, class First, class... Rest>
struct OfAxis<Is, Default, First, Rest...> {
  using Own = std::conditional_t<Is<First>::value && !std::is_same_v<First, Default>,
                                 Policies<First>, Policies<>>;
  using type = decltype(Own::with(typename OfAxis<Is, Default, Rest...>::type{}));
};
template <class... Lists>
struct PoliciesOf {
  using type = Policies<>;
};
template <class First, class... Rest>
struct PoliciesOf<First, Rest...> {
  using type = decltype(First::with(typename PoliciesOf<Rest...>::type{}));
};
template <class... Ps>
struct InOrder {
  using Fluid = pick<IsFluid, NoFluid, Ps...>;
  template <class OfFluid>
  using with = typename PoliciesOf<typename OfAxis<IsParticles, void, Ps...>::type,
                                   typename OfAxis<IsContacts, void, Ps...>::type,
                                   typename OfAxis<IsSearch, VerletList<>, Ps...>::type,
                                   typename OfAxis<IsDomain, OpenDomain, Ps...>::type, OfFluid,
                                   typename OfAxis<IsPrecision, Double, Ps...>::type,
                                   typename OfAxis<IsIntegrator, Leapfrog, Ps...>::type,
                                   typename OfAxis<IsRotation, NoSquish, Ps...>::type,
                                   typename OfAxis<IsLedger, void, Ps...>::type,
                                   typename OfAxis<IsContactEvents, void, Ps...>::type,
                                   typename OfAxis<IsModule, void, Ps...>::type,
                                   typename OfAxis<IsBonds, void, Ps...>::type,
                                   typename OfAxis<IsRanks, NoRanks, Ps...>::type,
                                   typename OfAxis<IsKernels, void, Ps...>::type>::type;
  using All = with<typename OfAxis<IsFluid, NoFluid, Ps...>::type>;
  using OfSimulation = typename All::Composed;
  using OfEngine =
      typename with<std::conditional_t<std::is_same_v<Fluid, NoFluid>, Policies<>,
                                       Policies<FluidThatGives<loads_of_fluid<Fluid>>>>>::Composed;
};

}  // namespace silt::detail
