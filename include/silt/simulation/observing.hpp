// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>
#include <silt/engine/contact/contact_events.hpp>

namespace silt::inline SILT_TARGET::detail {

// Observers: anything callable with the simulation; the members below are optional.

template <class O, class Sim>
void begin(O& observer, Sim& sim, double end_time) {
  if constexpr (requires { observer.begin(sim, end_time); }) observer.begin(sim, end_time);
}
template <class O, class Sim>
bool is_due(O& observer, const Sim& sim) {
  if constexpr (requires { observer.is_due(sim); })
    return observer.is_due(sim);
  else
    return true;
}
template <class O, class Sim>
void observe(O& observer, Sim& sim) {
  if (is_due(observer, sim)) observer(sim);
}
template <class O>
bool wants_events([[maybe_unused]] const O& observer) {
  return requires(const ContactLog& log) { observer.tell(log); };
}
template <class O, class Log>
void tell(const O& observer, const Log& log) {
  if constexpr (requires { observer.tell(log); }) observer.tell(log);
}
template <class O, class Sim>
void end(O& observer, Sim& sim) {
  if constexpr (requires { observer.end(sim); }) observer.end(sim);
}

}  // namespace silt::detail
