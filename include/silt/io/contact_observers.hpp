// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>

#include <silt/simulation/observing.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

template <bool Ends, class Action>
class ContactObserver {
 public:
  static constexpr bool reads_contacts = false;
  explicit ContactObserver(Action action) : action_(std::move(action)) {}

  template <class Sim>
  void begin(const Sim&, double) const {
    static_assert(
        Sim::has_events,
        "on_contact_begin and on_contact_end need a simulation that watches its contacts: "
        "give it the policy silt::ContactEvents{} in addition to particles and contacts");
  }
  template <class Sim>
  bool is_due(const Sim&) const {
    return false;
  }
  template <class Sim>
  void operator()(const Sim&) const {}
  void tell(const ContactLog& log) const {
    for (const ContactEvent& event : Ends ? log.ended() : log.begun()) action_(event);
  }

 private:
  mutable Action action_;
};

}  // namespace detail

/// Calls `action(const ContactEvent&)` for each contact that begins, in the step in which it
/// begins; within a step in the order of ids. Values known only at the end of a contact are 0.
///
///   sim.run(1.0, silt::on_contact_begin([&](const silt::ContactEvent& c) { ++hits; }));
template <class Action>
detail::ContactObserver<false, Action> on_contact_begin(Action action) {
  return detail::ContactObserver<false, Action>(std::move(action));
}
/// Calls `action(const ContactEvent&)` for each contact that ends, with the data of the whole
/// contact. Not reported: contacts that last until the end of a run, and those that end because a
/// particle leaves through an outlet or a wall is removed.
template <class Action>
detail::ContactObserver<true, Action> on_contact_end(Action action) {
  return detail::ContactObserver<true, Action>(std::move(action));
}

}  // namespace silt
