// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// A wall, material or form by number or name.
class NumberOrName {
 public:
  template <std::integral I>
  NumberOrName(I number) : number_(static_cast<std::size_t>(number)) {}  // NOLINT: converts
  NumberOrName(const char* name) : name_(name) {}                        // NOLINT
  NumberOrName(std::string_view name) : name_(name) {}                   // NOLINT
  NumberOrName(const std::string& name) : name_(name) {}                 // NOLINT
  bool by_name() const { return number_ == none; }
  std::size_t number() const { return number_; }
  std::string_view name() const { return name_; }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::size_t number_ = none;
  std::string_view name_;
};
/// A material, by number or name.
using WhichMaterial = NumberOrName;
/// A form, by number or name.
using WhichForm = NumberOrName;

namespace detail {

/// " 'lid'", or empty without a name.
[[gnu::cold]] inline std::string after_number(std::string_view name) {
  return name.empty() ? std::string() : text(" '", name, "'");
}
/// "wall 2 'lid'", or "wall 2" without a name.
[[gnu::cold]] inline std::string numbered(const char* what, std::size_t k, std::string_view name) {
  return text(what, ' ', k, after_number(name));
}

/// " (material 1 'steel')" after the entry of a list with one entry per material; empty without a
/// name.
template <class Contacts>
[[gnu::cold]] std::string after_entry(const Contacts& contacts, std::size_t material) {
  return contacts.given_name(material).empty() ? std::string()
                                               : text(" (", contacts.material_name(material), ")");
}

/// InputError if a list of `entries` values, for the contacts' materials from `first` on, is longer
/// than their number.
template <class Contacts>
[[gnu::cold]] void check_entries(const char* list, std::size_t entries, std::size_t first,
                                 const Contacts& contacts) {
  const std::size_t n = contacts.materials();
  require(
      first + entries <= n, list, " has ", entries, entries == 1 ? " entry" : " entries",
      first == 0 ? "" : ", from material 1 on", ", but the contacts and walls have ", n,
      n == 1 ? " material" : " materials",
      ": those of equal values are one unless they have names of their own "
      "(contacts.add(material, name)); leave out the rest, or name them. The material of a wall "
      "added later is registered by contacts.add(material, name) beforehand");
}

/// Names of all things of one kind: its word ("wall"), their number, name(k) of each (empty: none),
/// and the call that gives a name. Tests: tests/engine/names.cpp.
template <class NameOf>
struct Names {
  const char* what;
  std::size_t count;
  NameOf name;
  const char* given_by;

  /// Thing k as in messages.
  [[gnu::cold]] std::string words(std::size_t k) const {
    return numbered(what, k, k < count ? std::string_view(name(k)) : std::string_view());
  }
  /// InputError if it does not exist.
  [[gnu::cold]] std::size_t number_of(const NumberOrName& which) const {
    if (!which.by_name()) {
      require(which.number() < count, what, '(', which.number(), "): there ",
              count == 1 ? "is " : "are ", count, ' ', what, count == 1 ? "" : "s",
              ", counted from 0");
      return which.number();
    }
    std::string all;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view own = name(k);
      if (!own.empty() && own == which.name()) return k;
      if (!own.empty()) all += text(all.empty() ? "'" : ", '", own, "'");
    }
    throw InputError(text(what, ' ', in_quotes(which.name()), " is not there; ",
                          all.empty()
                              ? text("no ", what, " has a name: give it one with ", given_by)
                              : text("the named ", what, "s are ", all)));
  }
  /// Refuses a name that another thing than `own` has, or that is not suitable for messages and
  /// files.
  [[gnu::cold]] void check(std::string_view wanted, std::size_t own) const {
    require(!wanted.empty(), "a ", what, "'s name is empty; leave it out, or give a name");
    require(wanted.size() <= 80 && in_quotes(wanted).size() == wanted.size() + 2 &&
                wanted.find_first_of("'=:") == wanted.npos,
            "the ", what, " name ", in_quotes(wanted),
            " must have at most 80 printable characters without ', = and :");
    for (std::size_t k = 0; k < count; ++k)
      require(k == own || name(k) != wanted, what, ' ', k, " has the name '", wanted,
              "' already; names of ", what, "s are unique");
  }
};
template <class NameOf>
Names(const char*, std::size_t, NameOf, const char*) -> Names<NameOf>;

/// Names of things with a member `name`.
template <class All>
auto names_in(const char* what, const All& all, const char* given_by) {
  return Names{what, all.size(),
               [&all](std::size_t k) -> const std::string& { return all[k].name; }, given_by};
}

/// Calls check(); a refusal begins with words(), unless these are empty.
template <class Words, class Check>
void check_of(const Words& words, const Check& check) {
  try {
    check();
  } catch (const InputError& e) {
    const std::string of = words();
    throw InputError(of.empty() ? std::string(e.what()) : text(of, ": ", e.what()));
  }
}
/// Calls check(); a refusal mentions the thing with this name.
template <class Check>
void check_named(const char* what, const std::string& name, const Check& check) {
  check_of([&] { return name.empty() ? std::string() : text(what, " '", name, "'"); }, check);
}

}  // namespace detail
}  // namespace silt
