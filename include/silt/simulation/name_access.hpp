// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>
#include <silt/engine/population/openings.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Names of materials and of forms, like those of walls (simulation/wall_access.hpp); member
/// functions of Simulation. Names are unique among materials and among forms; they appear in
/// messages, but in no file. InputError: no such material or form, or an invalid name. Tests:
/// tests/engine/names.cpp.
template <class Sim>
class NameAccess {
 public:
  /// The name used in messages: "material 1 'steel'".
  std::string material_name(std::size_t k) const { return sim().contacts_.material_name(k); }
  std::size_t material_number(const WhichMaterial& which) const {
    return sim().contacts_.material_number(which);
  }
  /// The number of the material with this name.
  std::size_t find_material(std::string_view name) const { return material_number(name); }
  void name_material(const WhichMaterial& which, std::string name) {
    sim().contacts_.name_material(which, std::move(name));
  }
  /// Sets pair values for contacts of these two materials, by number or name, from the next run on;
  /// for example for a wall added between two runs (its material: sim.wall("lid").material). Before
  /// the simulation exists: Contacts::set_pair.
  template <class S = Sim>
  void set_pair(const WhichMaterial& a, const WhichMaterial& b,
                const typename S::ContactsType::Law::Pair& pair) {
    auto& contacts = sim().contacts_;
    const std::size_t i = material_number(a), j = material_number(b);
    const bool lacked = !contacts.has_pair(i, j);
    contacts.set_pair(i, j, pair);
    contacts_changed();
    // Nothing has touched with this pair so far; in the middle of a run something soon may.
    if (lacked && std::max(i, j) < sim().engine_.coefficients.materials)
      sim().engine_.set_coefficients(contacts);
  }
  /// The same for rolling resistance.
  template <class S = Sim>
  void set_rolling(
      const WhichMaterial& a, const WhichMaterial& b,
      const typename S::ContactsType::RollingPair& rolling) requires(S::ContactsType::has_rolling) {
    sim().contacts_.set_rolling(a, b, rolling);
    contacts_changed();
  }
  /// Allows particles and walls of these two materials, by number or name, to overlap by up to
  /// `limit` [-] relative to the smaller radius, instead of guard.max_overlap: for example a heavy
  /// body that hits light grains.
  void set_max_overlap(const WhichMaterial& a, const WhichMaterial& b, double limit) {
    require_positive("Simulation::set_max_overlap: limit", limit, "-");
    sim().overlap_limits_.set(material_number(a), material_number(b), limit);
  }
  /// The same for all materials with these values.
  template <class S = Sim>
  void set_max_overlap(const typename S::ContactsType::Material& a,
                       const typename S::ContactsType::Material& b, double limit) {
    const auto& contacts = sim().contacts_;
    const auto equal = [&contacts](const auto& solid) {
      DynArray<std::size_t> all;
      for (std::size_t k = 0; k < contacts.materials(); ++k)
        if (contacts.material(k) == solid) all.push_back(k);
      require(!all.empty(), "Simulation::set_max_overlap: a material", leading_value(solid),
              " is none of the ", contacts.materials(),
              " of the contacts and the walls; give the same values, and add the wall before");
      return all;
    };
    for (const std::size_t i : equal(a))
      for (const std::size_t j : equal(b)) set_max_overlap(i, j, limit);
  }
  /// The name used in messages: "form 2 'cube'".
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
    auto& mover = static_cast<S&>(*this).engine_.mover;
    require(k < added_forms(mover), "Simulation::name_form: form ", k,
            " is that of a fragment, and goes with it; only forms that were added have names");
    names<S>().check(name, k);
    mover.forms[k].name = std::move(name);
  }

 protected:
  /// Checked before a run, and after an observer has changed the scene. InputError: two materials
  /// that may touch have no pair value. Materials of walls only never touch each other.
  void check_pairs() const;

 private:
  /// The time step is checked against its limit at the next run.
  void contacts_changed() { sim().scene_changed_ = true, sim().checked_speed_ = 0; }
  DynArray<bool> of_particles_to_come() const;
  /// "; material 1 'steel' is that of wall 0 'drum' and wall 2"; empty if no wall has it.
  [[gnu::cold]] std::string of_walls(std::size_t material) const;
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  template <class S>
  auto names() const {
    return names_in("form", static_cast<const S&>(*this).engine_.mover.forms,
                    "add_form(shape, name)");
  }
};

template <class Sim>
void NameAccess<Sim>::check_pairs() const {
  const auto& contacts = sim().contacts_;
  const std::size_t n = contacts.materials();
  const std::size_t of_particles = Sim::ContactsType::several_materials ? n : 1;
  DynArray<bool> moves;  // per material: whether particles have it, or will
  for (std::size_t a = 0; a < of_particles; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      if (contacts.has_pair(a, b)) continue;
      if (moves.empty()) moves = of_particles_to_come();
      if (moves[a] || moves[b])
        throw InputError(contacts.lacking_pair(a, b) + of_walls(a) + of_walls(b));
    }
}

template <class Sim>
DynArray<bool> NameAccess<Sim>::of_particles_to_come() const {
  DynArray<bool> has(sim().contacts_.materials(), false);
  if constexpr (!Sim::ContactsType::several_materials) has[0] = true;
  for (std::size_t k = 0; k < sim().rows(); ++k)
    if (sim().is_present(k)) has[sim().material(k)] = true;
  for (std::size_t k = 0; k < sim().inlets(); ++k) {
    const InletFlow& flow = sim().inlet(k).flow;
    for (std::size_t kind = 0; kind < flow.kinds(); ++kind)
      if (flow.kind(kind).material < has.size()) has[flow.kind(kind).material] = true;
  }
  return has;
}

template <class Sim>
std::string NameAccess<Sim>::of_walls(std::size_t material) const {
  std::string words;
  for (std::size_t w = 0; w < sim().walls(); ++w)
    if (sim().wall(w).material == material)
      words += text(words.empty() ? text("; ", material_name(material), " is that of ") : " and ",
                    sim().wall_name(w));
  return words;
}

}  // namespace silt::detail
