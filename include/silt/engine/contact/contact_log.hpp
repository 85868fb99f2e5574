// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/contact/contact_events.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The events of a step, ordered by time, then by ids.
class ContactLog {
 public:
  bool wanted = false;  // an observer asks for events
  const DynArray<ContactEvent>& begun() const { return begun_; }
  const DynArray<ContactEvent>& ended() const { return ended_; }

  void clear() { begun_.clear(), ended_.clear(); }
  /// `id_of`: id of a row. Contacts of a particle that has left, which has no id, are not reported.
  template <class IdOf>
  void take(const ContactNotes& notes, const IdOf& id_of) {
    take(notes, id_of, [](std::uint32_t) { return true; });
  }
  /// Only contacts for which the row of the partner with the lower id `tells`: of two ranks that
  /// have a contact, one reports it.
  template <class IdOf, class Tells>
  void take(const ContactNotes& notes, const IdOf& id_of, const Tells& tells) {
    for (const NotedContact& one : notes.noted()) {
      ContactEvent e = one.event;
      e.a = id_of(one.first);
      if (e.a == no_particle) continue;
      if (e.wall == no_wall) {
        e.b = id_of(one.second);
        if (e.b == no_particle) continue;
        if (!tells(e.b < e.a ? one.second : one.first)) continue;
        if (e.b < e.a) std::swap(e.a, e.b), e.normal = -e.normal;
      }
      (one.ended ? ended_ : begun_).push_back(e);
    }
  }
  void sort() {
    const auto key = [](const ContactEvent& e) {
      return std::tuple(e.a, e.b, e.wall, e.begin, e.point.x, e.point.y, e.point.z);
    };
    for (auto* const events : {&begun_, &ended_})
      std::sort(
          events->begin(), events->end(),
          [&](const ContactEvent& one, const ContactEvent& two) { return key(one) < key(two); });
  }

 private:
  DynArray<ContactEvent> begun_, ended_;
};
struct NoContactLog {};

}  // namespace silt::detail
