// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include <silt/core/error.hpp>
#include <silt/engine/contact/contact_energy.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A slice of the history values of a contact, and its owner.
struct MemorySlice {
  const char* name = "";
  std::size_t from = 0, count = 0;
};

/// The history values of a Contacts type, slice by slice, in storage order:
///   law, rolling, ledger   of law, rolling model and energy ledger
///   normal                 data of the narrow phase of convex parts from the last step
///   law at point 2, ...    of further points of a contact with an area
///   area                   positions of these points
///   radius                 R_eff of convex parts; minus their gap while they are apart
///   offset                 excluded overlap, for pairs that were bonded (WithOffset)
///   impact                 for breakage by force: the largest force (WithImpacts)
///   events                 values for on_contact_end()
/// All are 0 from the step on in which the contact ends, except "radius", and "offset", which is
/// kept until the partners have separated.
template <class ContactsType>
class ContactMemory {
 public:
  static constexpr std::size_t size = ContactsType::history;

  constexpr ContactMemory() {
    add_point(0, {"law", "rolling", "ledger"});
    if constexpr (requires { ContactsType::memory_radius; }) {
      using C = ContactsType;
      add("normal", C::memory_from, C::memory_to - C::memory_from);
      if constexpr (C::points > 1) {
        static_assert(C::points == 3);
        add_point(C::history_of(1), {"law at point 2", "rolling at point 2", "ledger at point 2"});
        add_point(C::history_of(2), {"law at point 3", "rolling at point 3", "ledger at point 3"});
        add("area", C::frame_from, C::memory_radius - C::frame_from);
      }
      add("radius", C::memory_radius, 1);
    }
    if constexpr (requires { ContactsType::offset_from; })
      add("offset", ContactsType::offset_from, 1);
    if constexpr (requires { ContactsType::impact_from; })
      add("impact", ContactsType::impact_from, 1);
    if constexpr (requires { ContactsType::events_from; })
      add("events", ContactsType::events_from, ContactsType::event_numbers);
  }
  constexpr std::span<const MemorySlice> slices() const { return {slices_.data(), count_}; }
  /// Whether the slices are contiguous and complete.
  constexpr bool is_whole() const {
    std::size_t next = 0;
    for (const MemorySlice& s : slices()) {
      if (s.from != next) return false;
      next += s.count;
    }
    return next == size;
  }

  /// The name of component h with its slice: "law[0]".
  std::string name_of(std::size_t h) const {
    for (const MemorySlice& s : slices())
      if (h < s.from + s.count) return text(s.name, '[', h - s.from, ']');
    return "";
  }
  /// "3 of law, 4 of ledger", or "nothing".
  std::string words() const {
    std::string all;
    for (const MemorySlice& s : slices())
      all += text(all.empty() ? "" : ", ", s.count, " of ", s.name);
    return all.empty() ? "nothing" : all;
  }

 private:
  constexpr void add(const char* name, std::size_t from, std::size_t count) {
    if (count > 0) slices_[count_++] = {name, from, count};
  }
  constexpr void add_point(std::size_t from, const std::array<const char*, 3>& names) {
    add(names[0], from, ContactsType::law_history);
    add(names[1], from + ContactsType::law_history, ContactsType::rolling_history);
    if constexpr (keeps_ledger<ContactsType>)
      add(names[2], from + ContactsType::kept_from,
          ContactsType::kept_couple + 3 * ContactsType::has_rolling);
  }

  std::array<MemorySlice, 16> slices_{};
  std::size_t count_ = 0;
};

}  // namespace silt::detail
