// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/core/storage.hpp>
#include <silt/engine/state/axes.hpp>
#include <silt/engine/state/columns.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/module/field.hpp>
#include <silt/module/fits.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The module whose only field has this name, as for Field and BodyForce.
template <FixedName Name, class... Ms>
struct Named {
  static_assert(sizeof...(Ms) > 0,
                "this simulation has no Field of this name: give it one, as "
                "silt::Field<\"charge\">{}");
  using type = void;
};
template <class M>
inline constexpr std::string_view name_of_only_field = [] {
  if constexpr (
      requires(FieldsOf<M> f) { f.value; } && requires { M::names.size(); })
    return std::string_view(M::names[0]);
  else
    return std::string_view();
}();
template <FixedName Name, class First, class... Rest>
struct Named<Name, First, Rest...> {
  using type = typename std::conditional_t<name_of_only_field<First> == Name.view(),
                                           std::type_identity<First>, Named<Name, Rest...>>::type;
};

/// The module with this Fields type.
template <class Fields, class... Ms>
struct Having {
  static_assert(sizeof...(Ms) > 0,
                "no module of this simulation has this quantity: give it one that has, as "
                "silt::HeatConduction for silt::Temperature");
  using type = void;
};
template <class Fields, class First, class... Rest>
struct Having<Fields, First, Rest...> {
  using type =
      typename std::conditional_t<std::is_same_v<FieldsOf<First>, Fields>,
                                  std::type_identity<First>, Having<Fields, Rest...>>::type;
};

/// The modules of a simulation, by type.
template <class... Ms>
struct ModuleList {
  static constexpr std::size_t count = sizeof...(Ms);
  static constexpr bool push = ((Pushes<Ms> || PushesPairs<Ms>) || ...);
  static constexpr bool in_pairs = (ActsInPairs<Ms> || ...);
  static constexpr bool turn = (turns_particles<Ms> || ...);
  static constexpr bool update = ((Updates<Ms> || UpdatesByFlux<Ms>) || ...);
  static constexpr bool flux = (Exchanges<Ms> || ...);
  static constexpr bool wear = (WearsWalls<Ms> || ...);
  static_assert((ModuleFits<Ms>::checked && ...));
  template <class M>
  static constexpr std::size_t index_of = [] {
    std::size_t at = 0, found = sizeof...(Ms);
    ((std::is_same_v<M, Ms> ? found = std::min(found, at++) : at++), ...);
    return found;
  }();
  /// The number of modules that wear walls, and the index of this one among them.
  static constexpr std::size_t wearing = (std::size_t{0} + ... + std::size_t{WearsWalls<Ms>});
  template <class M>
  static constexpr std::size_t wear_index = [] {
    std::size_t at = 0, found = wearing;
    ((std::is_same_v<M, Ms> ? found = at : at += std::size_t{WearsWalls<Ms>}), ...);
    return found;
  }();
  static constexpr bool exist = count > 0;
  template <class M>
  static constexpr int times = (0 + ... + int{std::is_same_v<M, Ms>});
  static_assert(((times<Ms> == 1) && ...),
                "two modules of one type: give each a struct, or a Field a name, of its own");

  /// Calls visit(std::type_identity<M>{}) for each module.
  template <class Visit>
  static void for_each_type(const Visit& visit) {
    (visit(std::type_identity<Ms>{}), ...);
  }
  /// The modules among the policies of a simulation.
  template <class... Args>
  static std::tuple<Ms...> taken_from(Args&... args) {
    return std::tuple<Ms...>{take<Ms>(args...)...};
  }
  /// The one whose only field has this name.
  template <FixedName Name>
  using named = typename Named<Name, Ms...>::type;
  /// The module with this Fields type.
  template <class Fields>
  using having = typename Having<Fields, Ms...>::type;
};

/// The type that stands behind `mark` in a compiler's name of a function. It ends at a semicolon or
/// bracket that is neither in quotes nor in brackets of its own.
inline std::string_view type_in(std::string_view function, std::string_view mark) {
  const std::string_view rest = function.substr(function.find(mark) + mark.size());
  bool quoted = false;
  int open = 0;
  for (std::size_t k = 0; k < rest.size(); ++k) {
    const char c = rest[k];
    if (quoted && c == '\\')
      ++k;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && open == 0 && (c == ';' || c == ']'))
      return rest.substr(0, k);
    else if (!quoted)
      open += c == '[' ? 1 : c == ']' ? -1 : 0;
  }
  return rest;
}

/// The name of a module in messages and files.
template <class M>
std::string name_of_module() {
  std::string name(type_in(__PRETTY_FUNCTION__, "M = "));
  if (const auto arguments = name.find('<'); arguments != name.npos) name.erase(arguments);
  if (const auto colon = name.rfind("::"); colon != name.npos) name.erase(0, colon + 2);
  return name;
}
/// Number of doubles in the fields of a module.
template <class M>
inline constexpr std::size_t numbers_of_fields = has_fields<M> ? sizeof(FieldsOf<M>) / 8 : 0;

/// Names and component counts of the fields of a module, as written to files.
template <class M>
struct FieldNames {
  static constexpr std::size_t numbers = numbers_of_fields<M>;
  static_assert(sizeof(FieldsOf<M>) % sizeof(double) == 0 || !has_fields<M>,
                "the Fields of a module are only doubles and silt::Vec3d");
  static constexpr bool given = requires { M::names.size(); };
  static constexpr std::size_t count = [] {
    if constexpr (given)
      return M::names.size();
    else
      return numbers;
  }();
  static_assert(
      count == 0 || numbers == count || numbers == 3 * count,
      "the `names` of a module's Fields: one for each double, or, if all are vectors, one "
      "for each vector");
  static constexpr std::size_t components = count == 0 ? 1 : numbers / count;
  static std::string at(std::size_t k) {
    if constexpr (given)
      return std::string(M::names[k]);
    else
      return numbers == 1 ? name_of_module<M>() : text(name_of_module<M>(), " ", k + 1);
  }
};

/// Names of modules in a checkpoint, with those of their fields: `Field 'age [s]', BodyForce`.
/// `name_of` gives the name of a type with its arguments. They are left out where compilers write
/// texts and functions in their own ways, functions even by the line of the program.
template <class... Ms, class NameOf>
std::string names_of_modules(const ModuleList<Ms...>*, const NameOf& name_of) {
  std::string all;
  [[maybe_unused]] const auto add = [&]<class M>(const M*) {
    const std::string full = name_of(static_cast<const M*>(nullptr));
    const bool own_way = full.find('{') != full.npos || full.find("lambda") != full.npos;
    all += text(all.empty() ? "" : ", ", own_way ? name_of_module<M>() : full);
    if constexpr (has_fields<M>)
      for (std::size_t k = 0; k < FieldNames<M>::count; ++k)
        all += text(k == 0 ? " " : " and ", "'", FieldNames<M>::at(k), "'",
                    FieldNames<M>::components == 3 ? " (vector)" : "");
  };
  (add(static_cast<const Ms*>(nullptr)), ...);
  return all;
}

/// The columns of modules, one row per sphere or body: their fields, their force, and the flux
/// received through contacts. The fields of a new particle are zero until its modules initialise
/// them.
template <class List>
struct ModuleColumns;
template <class... Ms>
struct ModuleColumns<ModuleList<Ms...>> {
  using List = ModuleList<Ms...>;
  template <class M>
  using Values = std::conditional_t<has_fields<M>, AlignedVector<FieldsOf<M>>, NoFields>;
  [[no_unique_address]] std::tuple<Values<Ms>...> fields;
  std::array<AlignedVector<double>, sizeof...(Ms)> received;  // through contacts, of each flux
  AlignedVector<VectorRow> force;                             // [N] sum over modules, in this step
  AlignedVector<VectorRow> torque;                            // [N m]

  template <class M>
  auto& of() {
    return std::get<List::template index_of<M>>(fields);
  }
  template <class M>
  const auto& of() const {
    return std::get<List::template index_of<M>>(fields);
  }

  template <class M>
  auto& received_of() {
    return received[List::template index_of<M>];
  }
  template <class M>
  const auto& received_of() const {
    return received[List::template index_of<M>];
  }
  const VectorRow* forces() const { return force.data(); }
  const VectorRow* torques() const { return torque.data(); }
  static constexpr auto columns() {
    return std::tuple_cat(columns_if<has_fields<Ms>>([] {
                            return std::tuple{column<FieldsOf<Ms>>(
                                {"module", List::template index_of<Ms>, ".fields"},
                                [](auto& t) -> auto& { return t.template of<Ms>(); })};
                          })...,
                          columns_if<Receives<Ms>>([] {
                            return std::tuple{column<double>(
                                {"module", List::template index_of<Ms>, ".received"},
                                [](auto& t) -> auto& { return t.template received_of<Ms>(); })};
                          })...,
                          columns_if<List::push>([] {
                            return std::tuple{column<VectorRow>(
                                "modules.force", [](auto& t) -> auto& { return t.force; })};
                          }),
                          columns_if<List::turn>([] {
                            return std::tuple{column<VectorRow>(
                                "modules.torque", [](auto& t) -> auto& { return t.torque; })};
                          }));
  }
  /// Calls visit.operator()<Components>(name, value) for each field; value(k) is a double or three.
  template <class Visit>
  void for_each_field(const Visit& visit) const {
    (visit_fields<Ms>(visit), ...);
  }

  /// The part of the fields that ghosts receive in each step: a single number if the module names
  /// one for its flux; all fields if it computes its contact value from them or acts in pairs.
  template <class M>
  static constexpr bool reads_all = HasContactValue<M> || ActsInPairs<M>;
  template <class M>
  static constexpr std::size_t numbers_for_flux = reads_all<M>   ? numbers_of_fields<M>
                                                  : Exchanges<M> ? 1
                                                                 : 0;
  using ForFlux = std::array<double, (std::size_t{0} + ... + numbers_for_flux<Ms>)>;
  ForFlux for_flux(std::size_t k) const {
    ForFlux numbers;
    double* next = numbers.data();
    (give_for_flux<Ms>(k, next), ...);
    return numbers;
  }
  void set_for_flux(std::size_t k, const ForFlux& numbers) {
    const double* next = numbers.data();
    (take_for_flux<Ms>(k, next), ...);
  }

 private:
  template <class M>
  void give_for_flux([[maybe_unused]] std::size_t k, double*& to) const {
    if constexpr (numbers_for_flux<M> == 0)
      return;
    else if constexpr (reads_all<M>)
      std::memcpy(to, &of<M>()[k], sizeof(FieldsOf<M>));
    else if constexpr (Exchanges<M>)
      *to = of<M>()[k].*M::exchanged;
    to += numbers_for_flux<M>;
  }
  template <class M>
  void take_for_flux([[maybe_unused]] std::size_t k, const double*& from) {
    if constexpr (numbers_for_flux<M> == 0)
      return;
    else if constexpr (reads_all<M>)
      std::memcpy(static_cast<void*>(&of<M>()[k]), from, sizeof(FieldsOf<M>));
    else if constexpr (Exchanges<M>)
      of<M>()[k].*M::exchanged = *from;
    from += numbers_for_flux<M>;
  }
  template <class M, class Visit>
  void visit_fields(const Visit& visit) const {
    if constexpr (has_fields<M>) {
      using Names = FieldNames<M>;
      constexpr std::size_t components = Names::components;
      for (std::size_t n = 0; n < Names::count; ++n)
        visit.template operator()<components>(Names::at(n), [this, n](std::size_t k) {
          const auto* const numbers = reinterpret_cast<const double*>(&of<M>()[k]);
          if constexpr (components == 3)
            return std::array<double, 3>{numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]};
          else
            return numbers[n];
        });
    }
  }
};

/// Without modules: empty.
template <>
struct ModuleColumns<ModuleList<>> {
  using ForFlux = std::array<double, 0>;
  static const VectorRow* forces() { return nullptr; }
  static const VectorRow* torques() { return nullptr; }
  static constexpr std::tuple<> columns() { return {}; }
  template <class Visit>
  void for_each_field(const Visit&) const {}
};

}  // namespace silt::detail
