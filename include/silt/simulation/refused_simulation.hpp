// silt - BSD-3-Clause, see LICENSE
#pragma once

// The type of a Simulation for policies that do not form a valid one: it emits the messages, and
// has enough members for the following lines of a user's program to compile, so that the message is
// the last thing that the compiler prints.

#include <silt/contact/concept.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// A class of its own, so that the compiler names the policy.
template <class P, bool belongs>
struct PolicyOfAnAxis {
  static_assert(belongs,
                "a policy given to Simulation belongs to no axis (the lines about PolicyOfAnAxis "
                "name its type): it must be Particles, Contacts, a NeighbourSearch, a domain, a "
                "FluidCoupling, a precision, an Integrator, a rotation, KernelsFor, EnergyLedger, "
                "ContactEvents, Bonds{model}, Breakage or a Module; the contracts are in "
                "silt/contact/, search/, boundary/, "
                "coupling/, motion/, module/ concept.hpp");
  static constexpr bool checked = true;
};
/// A flow that is not coupled with particles, as FlowSolver.
template <class P>
concept BareFlow = requires(P& flow, const Team& team) {
  flow.grid(), flow.voidage(), flow.drag(), flow.stable_step(team);
};
/// Types that look like a module also get the message about its functions.
template <class P, bool belongs>
inline constexpr bool looks_like_module = [] {
  if constexpr (!belongs) return is_meant_as_module<P>;
  return false;
}();
template <class P, bool looks>
struct FitsIfModule {
  static constexpr bool checked = true;
};
template <class P>
struct FitsIfModule<P, true> : ModuleFits<P> {};

}  // namespace detail

template <class... Policies>
requires(!detail::make_a_simulation<Policies...>) class Simulation<Policies...> {
  template <template <class> class Is>
  static constexpr int given = detail::count<Is, Policies...>;
  static constexpr bool has_particles = given<detail::IsParticles> == 1;
  static constexpr bool has_contacts = given<detail::IsContacts> == 1;
  static constexpr bool has_one_search = given<detail::IsSearch> <= 1;
  static constexpr bool has_one_domain = given<detail::IsDomain> <= 1;
  static constexpr bool has_one_fluid = given<detail::IsFluid> <= 1;
  static constexpr bool has_one_integrator = given<detail::IsIntegrator> <= 1;
  static constexpr bool has_one_rotation = given<detail::IsRotation> <= 1;
  static constexpr bool has_one_precision = given<detail::IsPrecision> <= 1;
  static constexpr bool has_one_of_the_rest = given<detail::IsKernels> <= 1 &&
                                              given<detail::IsLedger> <= 1 &&
                                              given<detail::IsContactEvents> <= 1;
  /// For types that declare to be a fluid: whether each part of FluidCoupling is present.
  template <class P, bool has>
  static constexpr bool if_fluid = [] {
    if constexpr (detail::MeantAsFluid<P>) return has || !P::active;
    return true;
  }();
  static constexpr bool fluid_has_clock = (if_fluid<Policies, detail::HasClock<Policies>> && ...);
  static constexpr bool fluid_prepares =
      (if_fluid<Policies, detail::PreparesFluid<Policies>> && ...);
  static constexpr bool fluid_paces = (if_fluid<Policies, detail::PacesFluid<Policies>> && ...);
  static constexpr bool fluid_advances =
      (if_fluid<Policies, detail::AdvancesFluid<Policies>> && ...);
  static constexpr bool fluid_keeps_state =
      (if_fluid<Policies, detail::KeepsFluidState<Policies>> && ...);
  /// A law without Contacts gets the message about that, and so does a fluid without its parts.
  template <class P>
  static constexpr bool belongs = detail::belongs_to_an_axis<P> || detail::MeantAsFluid<P> ||
                                  detail::BareFlow<P> || (ContactLaw<P> && !has_contacts);

  static_assert(has_particles,
                "Simulation needs the particles: give one silt::Particles<Shape> "
                "(silt/fill/particles.hpp; shapes: silt/shape/concept.hpp)");
  static_assert(has_contacts,
                "Simulation needs one contact law: give silt::Contacts<Law>{material} "
                "(silt/contact/contacts.hpp; laws: silt/contact/concept.hpp)");
  static_assert(has_one_search, "Simulation takes one neighbour search (silt/search/concept.hpp)");
  static_assert(has_one_domain, "Simulation takes one domain (silt/boundary/domain.hpp)");
  static_assert(has_one_fluid, "Simulation takes one fluid coupling (silt/coupling/concept.hpp)");
  static_assert(!(detail::BareFlow<Policies> || ...),
                "a flow given to Simulation is not coupled with the particles: wrap it in "
                "silt::CoupledFlow{drag law, averaging mode, flow} "
                "(silt/coupling/coupled_flow.hpp)");
  static_assert(fluid_has_clock,
                "a fluid given to Simulation (active = true) has no member `FluidClock clock` "
                "(FluidCoupling, silt/coupling/concept.hpp)");
  static_assert(fluid_prepares,
                "a fluid given to Simulation has no prepare(const FluidScene&), which checks its "
                "settings (FluidCoupling, silt/coupling/concept.hpp)");
  static_assert(fluid_paces,
                "a fluid given to Simulation has no steps_wanted(const FluidPace&, const Team&) "
                "const, the particle steps of its next step (FluidCoupling, "
                "silt/coupling/concept.hpp)");
  static_assert(fluid_advances,
                "a fluid given to Simulation has no advance(const CoupledParticles&, double dt, "
                "std::span<Vec3d> force, const Team&, std::span<Vec3d> torque) (FluidCoupling, "
                "silt/coupling/concept.hpp)");
  static_assert(fluid_keeps_state,
                "a fluid given to Simulation has no for_each_state(visit), for checkpoints "
                "(FluidCoupling, silt/coupling/concept.hpp)");
  static_assert(has_one_integrator, "Simulation takes one integrator (silt/motion/concept.hpp)");
  static_assert(has_one_rotation, "Simulation takes one rotation (silt/motion/rotation.hpp)");
  static_assert(has_one_precision,
                "Simulation takes one precision: Double or Mixed (silt/core/precision.hpp)");
  static_assert(has_one_of_the_rest,
                "Simulation takes one KernelsFor, one EnergyLedger and one ContactEvents");
  static_assert((detail::FitsIfModule<
                     Policies, detail::looks_like_module<Policies, belongs<Policies>>>::checked &&
                 ...));
  static_assert((detail::PolicyOfAnAxis<Policies, belongs<Policies>>::checked && ...));

 public:
  template <class... Args>
  explicit Simulation(Args&&...) {}

  Vec3d gravity{0, 0, 0};
  std::optional<double> time_step;
  int threads = 1;
  Guard guard;
  template <class... Args>
  std::size_t add_wall(Args&&...);
  std::size_t add_wall(Surfaces, std::initializer_list<double>);
  template <class... Args>
  std::size_t add_inlet(Args&&...);
  std::size_t add_outlet(const Box&);
  template <class... Args>
  void add(Args&&...);
  template <class... Args>
  void run(double, Args&&...);
  double time() const;
  std::int64_t step() const;
  std::size_t size() const;
  std::size_t rows() const;
  Vec3d position(std::size_t) const;
  Vec3d velocity(std::size_t) const;
};

}  // namespace silt
