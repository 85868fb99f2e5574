// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/names.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Names of materials and of forms, as walls have them (simulation/wall_access.hpp); a Simulation
/// has these functions as its own. Names are unique among the materials, and among the forms; they
/// stand in messages, and are in no file. InputError: there is no such material or form, or a name
/// that cannot be. Tests: tests/engine/names.cpp.
template <class Sim>
class NameAccess {
 public:
  /// As messages call it: "material 1 'steel'".
  std::string material_name(std::size_t k) const { return sim().contacts_.material_name(k); }
  std::size_t material_number(const WhichMaterial& which) const {
    return sim().contacts_.material_number(which);
  }
  /// The number of the material with this name.
  std::size_t find_material(std::string_view name) const { return material_number(name); }
  void name_material(const WhichMaterial& which, std::string name) {
    sim().contacts_.name_material(which, std::move(name));
  }
  /// As messages call it: "form 2 'cube'".
  template <class S = Sim>
  std::string form_name(std::size_t k) const requires(S::of_bodies) {
    return names<S>().words(k);
  }
  template <class S = Sim>
  std::size_t form_number(const WhichForm& which) const requires(S::of_bodies) {
    return names<S>().number_of(which);
  }
  /// The number of the form with this name.
  template <class S = Sim>
  std::size_t find_form(std::string_view name) const requires(S::of_bodies) {
    return names<S>().number_of(name);
  }
  template <class S = Sim>
  void name_form(const WhichForm& which, std::string name) requires(S::of_bodies) {
    const std::size_t k = names<S>().number_of(which);
    names<S>().check(name, k);
    static_cast<S&>(*this).engine_.mover.forms[k].name = std::move(name);
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  template <class S>
  auto names() const {
    return names_in("form", static_cast<const S&>(*this).engine_.mover.forms,
                    "add_form(shape, name)");
  }
};

}  // namespace silt::detail
