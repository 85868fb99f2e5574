// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <silt/module/concept.hpp>

// Messages for modules with wrong signatures. silt calls the members that it finds; a function with
// another signature would silently never be called. Tests: tests/compile/refused/module_*.

namespace silt::inline SILT_TARGET::detail {

/// A member of M with one of these names becomes ambiguous, whether a function, an overload set or
/// a template. This detects that M has one. (For a final M only members that have an address.)
struct NamesOfModules {
  int force, rate, start, update, flux, at_wall, exchanged, at_contact, given_by_wall,
      share_of_loss, worn, pair_force, pair_force_on_both, pair_flux, pair_stiffness, pair_slope,
      reach, gap_reach, check, divide;
};
template <class M>
struct BesideNames : M, NamesOfModules {};
template <class M>
struct MembersNamed {
  static constexpr bool force = !requires { &BesideNames<M>::force; };
  static constexpr bool rate = !requires { &BesideNames<M>::rate; };
  static constexpr bool start = !requires { &BesideNames<M>::start; };
  static constexpr bool divide = !requires { &BesideNames<M>::divide; };
  static constexpr bool update = !requires { &BesideNames<M>::update; };
  static constexpr bool flux = !requires { &BesideNames<M>::flux; };
  static constexpr bool at_wall = !requires { &BesideNames<M>::at_wall; };
  static constexpr bool exchanged = !requires { &BesideNames<M>::exchanged; };
  static constexpr bool at_contact = !requires { &BesideNames<M>::at_contact; };
  static constexpr bool given_by_wall = !requires { &BesideNames<M>::given_by_wall; };
  static constexpr bool share_of_loss = !requires { &BesideNames<M>::share_of_loss; };
  static constexpr bool worn = !requires { &BesideNames<M>::worn; };
  static constexpr bool pair_force = !requires { &BesideNames<M>::pair_force; };
  static constexpr bool pair_force_on_both = !requires { &BesideNames<M>::pair_force_on_both; };
  static constexpr bool pair_flux = !requires { &BesideNames<M>::pair_flux; };
  static constexpr bool pair_stiffness = !requires { &BesideNames<M>::pair_stiffness; };
  static constexpr bool pair_slope = !requires { &BesideNames<M>::pair_slope; };
  static constexpr bool reach = !requires { &BesideNames<M>::reach; };
  static constexpr bool gap_reach = !requires { &BesideNames<M>::gap_reach; };
  static constexpr bool check = !requires { &BesideNames<M>::check; };
};
template <class M>
requires std::is_final_v<M>
struct MembersNamed<M> {
  static constexpr bool force = requires { &M::force; };
  static constexpr bool rate = requires { &M::rate; };
  static constexpr bool start = requires { &M::start; };
  static constexpr bool divide = requires { &M::divide; };
  static constexpr bool update = requires { &M::update; };
  static constexpr bool flux = requires { &M::flux; };
  static constexpr bool at_wall = requires { &M::at_wall; };
  static constexpr bool exchanged = requires { &M::exchanged; };
  static constexpr bool at_contact = requires { &M::at_contact; };
  static constexpr bool given_by_wall = requires { &M::given_by_wall; };
  static constexpr bool share_of_loss = requires { &M::share_of_loss; };
  static constexpr bool worn = requires { &M::worn; };
  static constexpr bool pair_force = requires { &M::pair_force; };
  static constexpr bool pair_force_on_both = requires { &M::pair_force_on_both; };
  static constexpr bool pair_flux = requires { &M::pair_flux; };
  static constexpr bool pair_stiffness = requires { &M::pair_stiffness; };
  static constexpr bool pair_slope = requires { &M::pair_slope; };
  static constexpr bool reach = requires { &M::reach; };
  static constexpr bool gap_reach = requires { &M::gap_reach; };
  static constexpr bool check = requires { &M::check; };
};
/// A class that does not satisfy the concept, but has functions of a module.
template <class P>
inline constexpr bool is_meant_as_module = [] {
  if constexpr (std::is_class_v<P>) {
    using Named = MembersNamed<P>;
    return Named::force || Named::update || Named::worn || Named::pair_force || Named::pair_flux;
  }
  return false;
}();

/// Converts to double and to nothing else.
struct OnlyDouble {
  template <class T>
  requires std::same_as<T, double>
  operator T() const;
};
/// Whether all members of an aggregate are doubles: it takes as many as fit its size.
template <class F>
inline constexpr bool is_of_doubles = [] {
  if constexpr (std::is_empty_v<F> || !std::is_aggregate_v<F>)
    return true;
  else if constexpr (sizeof(F) % sizeof(double) != 0)
    return false;
  else
    return []<std::size_t... K>(std::index_sequence<K...>) {
      return requires { F{(static_cast<void>(K), OnlyDouble{})...}; };
    }
  (std::make_index_sequence<sizeof(F) / sizeof(double)>{});
}();

template <class M>
concept PushesWithVectors = Pushes<M> && requires(const M& m, const Seen& p, const FieldsOf<M>& f) {
  requires std::convertible_to<decltype(answer_of(m, p, f)), Vec3d> ||
      std::same_as<decltype(answer_of(m, p, f)), Push>;
};
template <class M>
concept StartsFields = requires(const M& m, const Seen& p, FieldsOf<M>& f) {
  f = m.start(p);
};
/// update() takes its fields by value or as const.
template <class M>
concept UpdatesACopy = requires(const M& m, const Seen& p, double dt) {
  m.update(p, FieldsOf<M>{}, dt);
}
|| requires(const M& m, const Seen& p, double dt) { m.update(p, FieldsOf<M>{}, dt, dt); };

/// One message for each pair function of M with a wrong signature.
template <class M>
struct PairsFit {
  using Named = MembersNamed<M>;
  static constexpr bool in_pairs = Named::pair_force || Named::pair_flux;  // or is meant so

  static_assert(!Named::pair_force || PushesPairs<M>,
                "a module's pair_force() does not fit: it must be `silt::Vec3d pair_force(const "
                "silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&, const Fields&) "
                "const`, or without both Fields (it has no torque), and public: "
                "silt/module/concept.hpp");
  static_assert(!Named::pair_force_on_both || PushesBoth<M>,
                "a module's pair_force_on_both() does not fit: it must be `silt::Vec3d "
                "pair_force_on_both(const silt::Apart&, const silt::Seen&, const Fields&, const "
                "silt::Seen&, const Fields&) const`, public, and beside pair_force() and `bool "
                "pushes_both() const`: silt/module/concept.hpp");
  static_assert(!Named::pair_flux || FlowsInPairs<M>,
                "a module's pair_flux() does not fit: it must be `double pair_flux(const "
                "silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&, const Fields&) "
                "const`, public, and in a module with Fields: silt/module/concept.hpp");
  static_assert(!Named::pair_flux || UpdatesByFlux<M>,
                "a module with pair_flux() needs update(seen, fields, received, dt), which gets "
                "what a particle received: silt/module/concept.hpp");
  static_assert(!Named::pair_stiffness || (SaysPairStiffness<M> && Named::pair_force),
                "a module's pair_stiffness() does not fit: it must be `double pair_stiffness(const "
                "silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&, const Fields&) "
                "const`, or without both Fields, public, and beside pair_force(): "
                "silt/module/concept.hpp");
  static_assert(!Named::pair_slope || (SaysPairSlope<M> && Named::pair_flux),
                "a module's pair_slope() does not fit: it must be `double pair_slope(const "
                "silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&, const Fields&) "
                "const`, public, and beside pair_flux(): silt/module/concept.hpp");
  static_assert(!in_pairs || !Named::reach || SaysReach<M>,
                "a module's reach() does not fit: it must be `double reach() const` [m], and "
                "public: silt/module/concept.hpp");
  static_assert(!in_pairs || !Named::gap_reach || SaysGapReach<M>,
                "a module's gap_reach() does not fit: it must be `double gap_reach() const` [m], "
                "and public: silt/module/concept.hpp");
  static_assert(!in_pairs || Named::reach != Named::gap_reach,
                "a module with pair_force() or pair_flux() needs either `double reach() const` or "
                "`double gap_reach() const` [m], not both: silt/module/concept.hpp");
  static_assert(in_pairs || !(SaysReach<M> || SaysGapReach<M>),
                "a module with reach() or gap_reach() needs pair_force() or pair_flux(), which act "
                "within it: silt/module/concept.hpp");
  static constexpr bool checked = true;
};

/// One message for each function of M with a wrong signature.
template <class M>
struct ModuleFits : PairsFit<M> {
  using Named = MembersNamed<M>;
  static_assert(is_of_doubles<FieldsOf<M>>,
                "the Fields of a module are only doubles and silt::Vec3d: keep an int or a bool in "
                "a double");
  static_assert(
      !Named::force || PushesWithVectors<M>,
      "a module's force() does not fit: it must be `silt::Vec3d force(const silt::Seen&) "
      "const` or `silt::Vec3d force(const silt::Seen&, const Fields&) const` (or return a "
      "silt::Push), and public: silt/module/concept.hpp");
  static_assert(!Named::rate || SaysItsRate<M> || SaysItsFluxRate<M>,
                "a module's rate() does not fit: it must be `double rate(const silt::Seen&) const` "
                "or `double rate(const silt::Seen&, const Fields&) const`, and public: "
                "silt/module/concept.hpp");
  static_assert(!Named::start || !has_fields<M> || StartsFields<M>,
                "a module's start() does not fit: it must be `Fields start(const silt::Seen&) "
                "const`, and public: silt/module/concept.hpp");
  static_assert(!Named::divide || !has_fields<M> || DividesFields<M>,
                "a module's divide() does not fit: it must be `void divide(Fields&, double share) "
                "const`, and public: silt/module/concept.hpp");
  static_assert(!Named::update || Updates<M> || UpdatesByFlux<M>,
                "a module's update() does not fit: it must be `void update(const silt::Seen&, "
                "Fields&, double dt) const`, with `exchanged` `void update(const silt::Seen&, "
                "Fields&, double received, double dt) const`, and public: silt/module/concept.hpp");
  static_assert(!(Updates<M> && UpdatesByFlux<M>),
                "a module has one update(): with `received` if it has `exchanged`, else without");
  static_assert(!has_fields<M> || !UpdatesACopy<M>,
                "a module's update() takes its Fields by value or as const, and so cannot change "
                "them: write Fields&");
  static_assert(
      !Named::exchanged || Exchanges<M>,
      "a module's `exchanged` must point to a double of its Fields: `static constexpr auto "
      "exchanged = &Fields::temperature;`; a vector does not flow");
  static_assert(!Exchanges<M> || UpdatesByFlux<M>,
                "a module with `exchanged` needs update(seen, fields, received, dt): "
                "silt/module/concept.hpp");
  static_assert(Named::exchanged || Named::pair_flux || !UpdatesByFlux<M>,
                "a module whose update() takes what it `received` needs `exchanged` and flux(), or "
                "pair_flux(): silt/module/concept.hpp");
  static_assert(Named::flux == Named::exchanged,
                "a module with a flux has both `exchanged` and flux(): "
                "silt/module/concept.hpp");
  static_assert(!Exchanges<M> || !Named::flux || FluxOnLanes<M, double>,
                "a module's flux() does not fit: it must be `template <class Real> Real flux(const "
                "silt::Touching<Real>&, const Real& a, const Real& b) const`, and public: "
                "silt/module/concept.hpp");
  static_assert(!Named::at_wall || (HasWallEnds<M> && Named::exchanged),
                "a module's at_wall() does not fit: it must be `double at_wall(std::size_t wall, "
                "double time) const`, public, and beside `exchanged`: silt/module/concept.hpp");
  static_assert(!Named::at_contact || HasContactValue<M>,
                "a module's at_contact() does not fit: it must be `double at_contact(const "
                "silt::Seen&, const Fields&) const`, public, and beside `exchanged`: "
                "silt/module/concept.hpp");
  static_assert(
      !Named::given_by_wall || (HasGivingWalls<M> && Named::exchanged),
      "a module's given_by_wall() does not fit: it must be `std::optional<double> "
      "given_by_wall(std::size_t wall, double time) const`, public, and beside at_wall(): "
      "silt/module/concept.hpp");
  static_assert(!Named::share_of_loss || TakesLoss<M>,
                "a module's share_of_loss() does not fit: it must be `template <class Real> Real "
                "share_of_loss(const Coefficients<Real>&) const`, public, and beside `exchanged` "
                "and Coefficients: silt/module/concept.hpp");
  static_assert(!Named::worn || WearsWalls<M>,
                "a module's worn() does not fit: it must be `double worn(const silt::WallRub&, "
                "std::size_t wall) const`, and public: silt/module/concept.hpp");
  static constexpr bool checked = true;
};

}  // namespace silt::detail
