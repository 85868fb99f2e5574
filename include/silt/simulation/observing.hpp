// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <string>
#include <type_traits>

#include <silt/core/error_types.hpp>
#include <silt/core/target.hpp>
#include <silt/engine/contact/contact_events.hpp>

namespace silt::inline SILT_TARGET::detail {

// Observers: anything callable with the simulation; the members below are optional.
//
// At one instant they are called in the order in which they are given, those that save it
// (`saves`) after all others, so that a checkpoint has what the others change. An instant belongs
// to the run that reaches it: where a run begins at an instant at which observers were called
// before, only those that do nothing but read (`only_reads`) are called again. So a run in two
// pieces, or one that goes on from a checkpoint, gives what it gives in one piece, whatever
// observers change.

template <class O>
inline constexpr bool only_reads = requires {
  requires O::only_reads;
};
template <class O>
inline constexpr bool saves = requires {
  requires O::saves;
};

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
/// Whether the observer will read contacts in this step: silt's own say it, of others it is taken
/// for granted if `others` read them at all.
template <class O, class Sim>
bool reads_contacts(O& observer, const Sim& sim, bool others) {
  if constexpr (requires { O::reads_contacts; })
    return O::reads_contacts && is_due(observer, sim);
  else
    return others && is_due(observer, sim);
}
/// `again`: observers were called at this instant before. `last`: it is the turn of those that
/// save.
template <class O, class Sim>
void observe(O& observer, Sim& sim, bool again, bool last) {
  using Type = std::remove_cvref_t<O>;
  constexpr bool callable = !std::is_const_v<O> || std::invocable<O&, Sim&>;
  static_assert(callable,
                "Simulation::run: an observer that is const cannot note when it was called last; "
                "declare it with `auto` in place of `const auto`");
  if (saves<Type> != last || (again && !only_reads<Type>)) return;
  if constexpr (callable)
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

template <class O, class Sim>
concept SeesFailures = requires(O& observer, const Sim& sim, const SimulationError& error) {
  { observer.failed(sim, error, 0.0) } -> std::convertible_to<std::string>;
};
template <class O, class Sim>
std::string failed(O& observer, const Sim& sim, const SimulationError& error, double back) {
  if constexpr (SeesFailures<O, Sim>) return observer.failed(sim, error, back);
  return {};
}
/// Calls `steps`; where that fails, observers see it, and what they say ends the error's sentence.
/// since_forces() [s]: for how long positions have gone on since the forces acted.
template <class Sim, class Steps, class Since, class... Observers>
void run_observed([[maybe_unused]] const Sim& sim, const Steps& steps,
                  [[maybe_unused]] const Since& since_forces,
                  [[maybe_unused]] Observers&... observers) {
  if constexpr ((SeesFailures<Observers, Sim> || ...)) {
    try {
      steps();
    } catch (const SimulationError& error) {
      std::string words = error.what();
      ((words += failed(observers, sim, error, since_forces())), ...);
      throw SimulationError(words, error.step, error.particles, error.position);
    }
  } else {
    steps();
  }
}

}  // namespace silt::detail
