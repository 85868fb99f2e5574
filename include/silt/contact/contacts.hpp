// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <silt/contact/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/names.hpp>

namespace silt::inline SILT_TARGET {

/// Option of Contacts: particles may have different materials. Each particle stores the index of
/// its material.
struct SeveralMaterials {};

/// No resistance to rolling.
struct NoRolling {
  struct Pair {
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {};
};

namespace detail {

template <class... Options>
struct RollingOf {
  using type = NoRolling;
};
template <class First, class... Rest>
struct RollingOf<First, Rest...> {
  using type = typename std::conditional_t<RollingModel<First>, std::type_identity<First>,
                                           RollingOf<Rest...>>::type;
};

template <class Other>
void refuse_material() {
  static_assert(
      std::is_void_v<Other>,
      "the material is of another law than that of Contacts<Law>: give a Law::Material; that of "
      "Cohesive<...> has two parts, {.body = ..., .cohesion = ...}, that of Softened<...> has "
      ".solid");
}

/// Values of the rolling models, to recognise them where there is no model.
struct RollingValues {
  double rolling_friction = 0, twisting_friction = 0, damping = 0, rolling_viscosity = 0;
};

}  // namespace detail

/// The contact axis of a Simulation: a law, its options, and the table of materials.
///
///   silt::Contacts<silt::HertzMindlin> contacts{glass};                       // one material
///   silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> rough{glass, {.rolling_friction = 0.1}};
///   silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> mixed{{glass, steel}};
///   mixed.set_pair(glass, steel, {.restitution = 0.6, .friction = 0.3});
///   mixed.add(steel, "steel");                              // a name, which stands in messages
///
/// Materials are distinguished by values and name. Equal values under two names are two materials,
/// which may have different values in modules. A material given by its values alone is the first
/// one that is equal. Without `SeveralMaterials` all particles have the first material; walls may
/// have others. If the law has values that belong to a pair, two materials with unlike values need
/// `set_pair`. The simulation refuses to start while a pair value is missing, and names the pair.
template <class LawType, class... Options>
class Contacts {
 public:
  using Law = LawType;
  using Rolling = typename detail::RollingOf<Options...>::type;
  static_assert(
      ContactLaw<Law>,
      "Contacts<Law>: Law is not a ContactLaw; its contract is in silt/contact/concept.hpp");
  static_assert(((std::is_same_v<Options, SeveralMaterials> || RollingModel<Options>)&&...),
                "Contacts<Law, Options...>: an option must be SeveralMaterials or a RollingModel; "
                "the contract is in silt/contact/concept.hpp");
  static_assert((0 + ... + RollingModel<Options>) <= 1,
                "Contacts<Law, Options...> takes one rolling model; combine two as Both<First, "
                "Second> (silt/contact/rolling/twisting.hpp)");

  static constexpr bool several_materials = (std::is_same_v<Options, SeveralMaterials> || ...);
  static constexpr bool has_rolling = !std::is_same_v<Rolling, NoRolling>;
  static constexpr bool rotates = is_frictional<Law> || has_rolling;
  static constexpr std::size_t law_history = detail::history_size<Law>();
  static constexpr std::size_t rolling_history = detail::history_size<Rolling>();
  static constexpr std::size_t history = law_history + rolling_history;

  using Material = typename Law::Material;
  using LawCoefficients = typename Law::template Coefficients<double>;
  using RollingPair = typename Rolling::Pair;
  using RollingCoefficients = typename Rolling::template Coefficients<double>;

  explicit Contacts(const Material& material) { add(material); }
  Contacts(const Material& material, const RollingPair& rolling) requires has_rolling
      : default_rolling_(rolling) {
    detail::check_rolling<Rolling>(rolling);
    add(material);
  }
  explicit Contacts(std::initializer_list<Material> materials,
                    const RollingPair& rolling = {}) requires several_materials
      : default_rolling_(rolling) {
    detail::check_rolling<Rolling>(rolling);
    require(materials.size() > 0, "Contacts: the list of materials is empty; give at least one");
    for (const auto& m : materials) add(m);
  }

  /// Refused: the material of another law.
  template <class Other>
  requires(std::is_class_v<Other>&& std::is_aggregate_v<Other> &&
           !std::is_convertible_v<const Other&, Material>) explicit Contacts(const Other&) {
    detail::refuse_material<Other>();
  }
  /// Refused: rolling values without a rolling model.
  template <bool HasModel = has_rolling>
  Contacts(const Material&, const detail::RollingValues&) requires(!HasModel) {
    refuse_rolling<HasModel>();
  }
  template <bool HasModel = has_rolling>
  Contacts(std::initializer_list<Material>,
           const detail::RollingValues&) requires(several_materials && !HasModel) {
    refuse_rolling<HasModel>();
  }

  /// Returns the index of the first material with these values, and adds the material if there is
  /// none. With `name`: the equal material of this name; else the first equal one without a name,
  /// which then gets it; else a new one. InputError if a material of other values has this name.
  std::size_t add(const Material& material, std::string name = {}) {
    const std::size_t k = number_for(material, name);
    if (!name.empty()) names().check(name, k);
    if constexpr (requires { Law::check(material); })
      detail::check_of([&] { return words_of(k, name); }, [&] { Law::check(material); });
    if (k == materials_.size()) add_new(material);
    if (!name.empty()) names_[k] = std::move(name);
    return k;
  }
  /// Names a material of the table; replaces an earlier name.
  void name_material(const WhichMaterial& which, std::string name) {
    const std::size_t k = material_number(which);
    names().check(name, k);
    names_[k] = std::move(name);
  }

  /// Sets the values of a pair of materials, in either order. Applies to all materials with these
  /// values.
  template <class L = Law>
  Contacts& set_pair(const Material& a, const Material& b, const typename L::Pair& pair) {
    check_pair(number_for(a, {}), number_for(b, {}), pair);
    for_equal(a, b, [&](Entry& e) { e.pair = pair; });
    return *this;
  }
  /// The same for these two materials only, by number or name.
  template <class L = Law>
  Contacts& set_pair(const WhichMaterial& a, const WhichMaterial& b, const typename L::Pair& pair) {
    const std::size_t i = material_number(a), j = material_number(b);
    check_pair(i, j, pair);
    entry(i, j).pair = entry(j, i).pair = pair;
    return *this;
  }

  /// Sets the rolling resistance of a pair of materials, in either order. Applies to all materials
  /// with these values.
  Contacts& set_rolling(const Material& a, const Material& b,
                        const RollingPair& rolling) requires has_rolling {
    check_rolling(number_for(a, {}), number_for(b, {}), rolling);
    for_equal(a, b, [&](Entry& e) { e.rolling = rolling; });
    return *this;
  }
  /// The same for these two materials only, by number or name.
  Contacts& set_rolling(const WhichMaterial& a, const WhichMaterial& b,
                        const RollingPair& rolling) requires has_rolling {
    const std::size_t i = material_number(a), j = material_number(b);
    check_rolling(i, j, rolling);
    entry(i, j).rolling = entry(j, i).rolling = rolling;
    return *this;
  }

  std::size_t materials() const { return materials_.size(); }
  const Material& material(const WhichMaterial& which) const {
    return materials_[material_number(which)];
  }
  std::size_t material_number(const WhichMaterial& which) const { return names().number_of(which); }
  /// Index of the material with this name.
  std::size_t find_material(std::string_view name) const { return names().number_of(name); }
  /// The material as messages name it: "material 1 'steel'".
  std::string material_name(std::size_t k) const { return names().words(k); }
  /// Its name alone; empty: none.
  std::string_view given_name(std::size_t k) const {
    return k < names_.size() ? std::string_view(names_[k]) : std::string_view();
  }

  /// Whether the values for contacts of materials a and b are complete.
  bool has_pair(std::size_t a, std::size_t b) const {
    if constexpr (detail::HasPairValues<Law>)
      return pairs_[a * materials_.size() + b].pair || materials_[a] == materials_[b];
    else
      return true;
  }
  /// Message for two materials without pair values.
  [[gnu::cold]] std::string lacking_pair(std::size_t a, std::size_t b) const {
    return text("materials ", a, detail::after_number(names_[a]), " and ", b,
                detail::after_number(names_[b]),
                " have no pair value; call set_pair(material, material, values) on the contacts, "
                "or Simulation::set_pair. (Materials count from 0 in the order in which the "
                "contacts and the walls got them; a wall of other values than the particles' is "
                "another material)");
  }

  /// The law's coefficients for materials a and b. InputError if they have no pair value.
  LawCoefficients coefficients(std::size_t a, std::size_t b) const {
    if constexpr (detail::HasPairValues<Law>) {
      if (!has_pair(a, b)) throw InputError(lacking_pair(a, b));
      const auto& given = pairs_[a * materials_.size() + b].pair;
      return Law::mix(materials_[a], materials_[b], given ? *given : Law::like(materials_[a]));
    } else {
      return Law::mix(materials_[a], materials_[b]);
    }
  }
  RollingCoefficients rolling_coefficients(std::size_t a, std::size_t b) const {
    if constexpr (has_rolling)
      return Rolling::mix(pairs_[a * materials_.size() + b].rolling.value_or(default_rolling_));
    else
      return {};
  }

 private:
  template <bool HasModel>
  static void refuse_rolling() {
    static_assert(HasModel,
                  "rolling values need a rolling model: Contacts<Law, RollingEpsd> (others are in "
                  "silt/contact/rolling/)");
  }
  template <class L, bool = detail::HasPairValues<L>>
  struct PairValues {
    using type = typename L::Pair;
  };
  template <class L>
  struct PairValues<L, false> {
    struct type {};
  };
  struct Entry {
    std::optional<typename PairValues<Law>::type> pair;
    std::optional<RollingPair> rolling;
  };
  /// Material k in a refusal: "material 2 'steel'"; empty for the only one without a name.
  [[gnu::cold]] std::string words_of(std::size_t k, std::string_view name) const {
    const bool alone = !several_materials && k == 0 && materials_.size() <= 1;
    return alone && name.empty() ? std::string() : detail::numbered("material", k, name);
  }
  /// A pair in a refusal; a number beyond the table is that of a material that is not yet in it.
  [[gnu::cold]] std::string words_of_pair(std::size_t a, std::size_t b) const {
    const auto words = [this](std::size_t k) {
      return k < materials_.size() ? material_name(k) : std::string("a new material");
    };
    if (a == b && words_of(a, given_name(a)).empty()) return {};
    return text("the pair of ", words(a), " and ", words(b));
  }
  template <class Pair>
  void check_pair(std::size_t a, std::size_t b, const Pair& pair) const {
    if constexpr (requires { Law::check(pair); })
      detail::check_of([&] { return words_of_pair(a, b); }, [&] { Law::check(pair); });
  }
  void check_rolling(std::size_t a, std::size_t b, const RollingPair& rolling) const {
    detail::check_of([&] { return words_of_pair(a, b); },
                     [&] { detail::check_rolling<Rolling>(rolling); });
  }
  Entry& entry(std::size_t i, std::size_t j) { return pairs_[i * materials_.size() + j]; }
  /// Calls f(entry) for each pair of materials with these values; adds them if they are new.
  template <class F>
  void for_equal(const Material& a, const Material& b, const F& f) {
    add(a), add(b);
    for (std::size_t i = 0; i < materials_.size(); ++i)
      for (std::size_t j = 0; j < materials_.size(); ++j)
        if (materials_[i] == a && materials_[j] == b) f(entry(i, j)), f(entry(j, i));
  }
  std::size_t number_for(const Material& material, std::string_view name) const {
    const std::size_t n = materials_.size();
    std::size_t unnamed = n;
    for (std::size_t k = n; k-- > 0;) {
      if (!(materials_[k] == material)) continue;
      if (!name.empty() && names_[k] == name) return k;
      if (name.empty() || names_[k].empty()) unnamed = k;
    }
    return unnamed;
  }
  /// The new material takes the pair values of the first equal one.
  void add_new(const Material& material) {
    const std::size_t last = materials_.size(), n = last + 1, like = number_for(material, {});
    materials_.push_back(material), names_.emplace_back();
    DynArray<Entry> grown(n * n);
    const auto old = [&](std::size_t k) { return k < last ? k : like; };
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b)
        if (old(a) < last && old(b) < last) grown[a * n + b] = pairs_[old(a) * last + old(b)];
    pairs_ = std::move(grown);
  }
  auto names() const {
    return detail::Names{"material", materials_.size(),
                         [this](std::size_t k) -> const std::string& { return names_[k]; },
                         "contacts.add(material, name)"};
  }

  DynArray<Material> materials_;
  DynArray<std::string> names_;  // of each material; empty: none
  DynArray<Entry> pairs_;        // n x n
  RollingPair default_rolling_{};
};

/// True for Contacts<...>.
template <class T>
inline constexpr bool is_contacts = false;
template <class Law, class... Options>
inline constexpr bool is_contacts<Contacts<Law, Options...>> = true;

}  // namespace silt
