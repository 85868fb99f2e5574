// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/names.hpp>

namespace silt::inline SILT_TARGET {

/// Values of walls for a module, in one of two forms: for wall 0, 1, ... in order, or each with the
/// name or number of its wall.
///
///   {held_at(400), insulated()}
///   {{"drum", held_at(400)}, {2, insulated()}}
///
/// Names are resolved by resolve(), before a run.
/// Errors:  InputError for a list with both forms; in resolve() for a wall that does not exist
///          (with the names that do) or is given twice.
/// Tests:   tests/engine/wall_heat.cpp.
template <class T>
class WallValues {
 public:
  struct Entry {
    Entry() = default;
    template <std::same_as<T> U>                     // excludes a name that would become a bool
    Entry(U of_wall) : value(std::move(of_wall)) {}  // NOLINT: converts
    Entry(const NumberOrName& wall, T of_wall)
        : value(std::move(of_wall)),
          given(true),
          by_name(wall.by_name()),
          name(wall.name()),
          number(wall.number()) {}

    T value{};
    bool given = false, by_name = false;  // its wall
    bool changed = false;                 // by set()
    std::string name;
    std::size_t number = 0;
  };

  WallValues() = default;
  WallValues(std::initializer_list<Entry> all) : WallValues(DynArray<Entry>(all)) {}
  explicit WallValues(DynArray<Entry> all) : entries_(std::move(all)) {
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      require(entries_[k].given == entries_[0].given, "entry ", k, " of a list of walls' values ",
              entries_[k].given ? "has its wall's name or number, the first one does not"
                                : "has no wall's name or number, the first one does",
              "; give each entry one, as {\"drum\", ...}, or none of them");
      if (!entries_[k].given) entries_[k].number = k;
    }
    in_order_ = entries_.empty() || !entries_[0].given;
  }

  const DynArray<Entry>& entries() const { return entries_; }
  /// The value of a wall; null: none given.
  const T* of(std::size_t wall) const {
    if (in_order_) return wall < entries_.size() ? &entries_[wall].value : nullptr;
    require(resolved_,
            "values of walls were given to a module by name during a run; names are resolved "
            "when a run begins (Simulation::set_wall_heat changes a wall at any time)");
    return wall < entry_of_.size() && entry_of_[wall] > 0 ? &entries_[entry_of_[wall] - 1].value
                                                          : nullptr;
  }
  /// Calls visit(wall, value) for each value given by set().
  template <class Visit>
  void for_each_changed(const Visit& visit) const {
    for (std::size_t w = 0; w < entry_of_.size(); ++w)
      if (entry_of_[w] > 0 && entries_[entry_of_[w] - 1].changed) visit(w, *of(w));
  }
  /// Resolves names and checks numbers; `list`: its name in messages.
  template <class Sim>
  void resolve(const Sim& sim, const char* list) const {
    require(!in_order_ || entries_.size() <= sim.walls(), list, " has ", entries_.size(),
            " entries, but the simulation has ", sim.walls(), " walls; give one for each at most");
    entry_of_.assign(sim.walls(), 0);
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      std::size_t& entry = entry_of_[number_in(sim, entries_[k], list)];
      if (entry > 0)
        throw InputError(text(list, ": its entries ", entry - 1, " and ", k, " are both of ",
                              sim.wall_name(number_in(sim, entries_[k], list)),
                              "; leave one of them out"));
      entry = k + 1;
    }
    resolved_ = true;
  }
  /// Gives wall `number` another value.
  template <class Sim>
  void set(const Sim& sim, std::size_t number, T value, const char* list) {
    resolve(sim, list);
    std::size_t& entry = entry_of_[number];
    if (entry == 0) entries_.emplace_back(number, T{}), in_order_ = false, entry = entries_.size();
    entries_[entry - 1].value = std::move(value), entries_[entry - 1].changed = true;
  }

 private:
  template <class Sim>
  static std::size_t number_in(const Sim& sim, const Entry& one, const char* list) {
    try {
      return one.by_name ? sim.wall_number(one.name) : sim.wall_number(one.number);
    } catch (const InputError& error) {
      throw InputError(text(list, ": ", error.what()));
    }
  }

  DynArray<Entry> entries_;
  bool in_order_ = true;
  // Entry of each wall, counted from 1; 0: none. Set before a run.
  mutable DynArray<std::size_t> entry_of_;
  mutable bool resolved_ = false;
};

}  // namespace silt
