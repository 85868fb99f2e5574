// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <unistd.h>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>

#include <silt/core/error.hpp>
#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/contact/contact_events.hpp>
#include <silt/engine/contact/contact_log.hpp>
#include <silt/engine/contact/contact_record.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/parallel/agreed.hpp>

namespace silt::inline SILT_TARGET::detail {

// Observers: anything callable with the simulation; the members below are optional.
//
// Observers due at the same instant are called in the order in which they are given, but those that
// save (`saves`) come last, so that a checkpoint contains the changes of the others. An instant
// belongs to the run that reaches it: if a run begins at an instant at which observers were already
// called, only those that do nothing but read (`only_reads`) are called again. So a run in two
// parts, or one continued from a checkpoint, gives the same results as an uninterrupted one,
// whatever observers change. Those with `before_saving(sim)` are told before others save.

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
/// Calls observers with `started(sim)`, which may make collective calls: the forces of step 0 are
/// known.
template <class Sim, class... Observers>
void started(const Sim& sim, [[maybe_unused]] Observers&... observers) {
  [[maybe_unused]] const auto one = [&](auto& observer) {
    if constexpr (requires { observer.started(sim); }) observer.started(sim);
  };
  const auto all = [&] { (one(observers), ...); };
  if constexpr (Sim::has_ranks)
    sim.engine().ranks.together("the first step of observers", all);
  else
    all();
}
template <class O, class Sim>
bool is_due(O& observer, const Sim& sim) {
  if constexpr (requires { observer.is_due(sim); })
    return observer.is_due(sim);
  else
    return true;
}
/// With several ranks observers are due on all ranks or on none. `watch(sim)` is the part of an
/// observer that depends on the clock: it is called after each step, on its own rank only, and must
/// make no collective calls.
template <class Sim, class... Observers>
void watch([[maybe_unused]] const Sim& sim, [[maybe_unused]] Observers&... observers) {
  [[maybe_unused]] const auto one = [&](auto& observer) {
    if constexpr (requires { observer.watch(sim); }) observer.watch(sim);
  };
  if constexpr (Sim::has_ranks) sim.engine().ranks.until_later([&] { (one(observers), ...); });
}
constexpr ContactsKept all_contacts_if(bool wanted) {
  return wanted ? ContactsKept::All : ContactsKept::Nothing;
}
/// What the observer will read of contacts in this step. Observers that declare it read everything,
/// or forces only (`reads_forces_alone`); others are assumed to read contacts if `others` is set.
template <class O, class Sim>
ContactsKept read_contacts(O& observer, const Sim& sim, bool others) {
  bool reads = others;
  if constexpr (requires { O::reads_contacts; }) reads = O::reads_contacts;
  if (!reads || !is_due(observer, sim)) return ContactsKept::Nothing;
  constexpr bool forces = requires { requires O::reads_forces_alone; };
  return forces ? ContactsKept::Forces : ContactsKept::All;
}
/// Whether an error has exactly this type, not a derived one.
template <class E>
bool is_exactly([[maybe_unused]] const std::exception& e) {
#ifdef __GXX_RTTI
  return typeid(e) == typeid(E);
#else
  return false;
#endif
}
template <class... Types>
[[gnu::cold]] void throw_if_exactly(const std::exception& e, const std::string& words) {
  const auto one = [&]<class E>(std::type_identity<E>) {
    if (is_exactly<E>(e)) throw E(words);
  };
  (one(std::type_identity<Types>{}), ...);
}
/// The type of an observer in words, " 'MeanLoad'"; empty for lambdas and types that contain one.
template <class O>
[[gnu::cold]] std::string after_observer() {
  std::string name = name_of_module<O>();
  const bool lambda = std::string_view(__PRETTY_FUNCTION__).find("lambda") != std::string::npos;
  return lambda || name.find('(') != name.npos ? std::string() : text(" '", name, "'");
}
/// "observer 2 of 3 'Watch'".
template <class O>
[[gnu::cold]] std::string name_of_observer(std::size_t number, std::size_t of) {
  return text("observer ", number, " of ", of, after_observer<O>());
}
/// Rethrows what an observer has thrown, with the same type; the message says which observer and
/// when. Types unknown to silt and the standard library are rethrown unchanged.
[[noreturn, gnu::cold]] inline void throw_of_observer(const std::string& who, double time,
                                                      std::int64_t step) {
  const auto said = [&](const std::exception& e) {
    std::string words =
        text(e.what(), "; thrown by ", who, " at t = ", sentence(time), " s, step ", step);
    if (is_agreed() && last_agreed() == e.what()) {  // on all ranks, with the same message
      if (last_agreed().find("; thrown by observer ") != std::string::npos) return last_agreed();
      last_agreed() = words;
    }
    return words;
  };
  try {
    throw;
  } catch (const SimulationError& e) {
    if (is_exactly<SimulationError>(e))
      throw SimulationError(said(e), e.step, e.particles, e.position);
    throw;
  } catch (const FlowStepError& e) {
    if (is_exactly<FlowStepError>(e)) throw FlowStepError(said(e), e.longest);
    throw;
  } catch (const std::exception& e) {
    throw_if_exactly<InputError, FileError, Error, std::runtime_error, std::range_error,
                     std::overflow_error, std::underflow_error, std::logic_error,
                     std::invalid_argument, std::domain_error, std::length_error,
                     std::out_of_range>(e, said(e));
    throw;
  }
}
/// How observers are called at an instant.
struct Instant {
  bool again;   // they were called at it before
  bool saving;  // one that saves is due
  bool last;    // call those that save
};
template <class O, class Sim>
bool is_saving(O& observer, const Sim& sim, bool again) {
  const bool called = saves<O> && !(again && !only_reads<O>);
  return called && is_due(observer, sim);
}
template <class O, class Sim>
void observe(O& observer, Sim& sim, const Instant& now, std::size_t number, std::size_t of) {
  using Type = std::remove_cvref_t<O>;
  constexpr bool callable = std::invocable<O&, Sim&>;
  static_assert(callable || std::invocable<Type&, Sim&>,
                "Simulation::run: an observer must be callable with the simulation, f(sim); a "
                "schedule or a function of other arguments is none: at(every(0.1), f)");
  static_assert(callable || !std::invocable<Type&, Sim&>,
                "Simulation::run: an observer that is const cannot note when it was called last; "
                "declare it with `auto` in place of `const auto`");
  if (saves<Type> != now.last) return;
  const bool called = !(now.again && !only_reads<Type>);
  try {
    if constexpr (callable)
      if (called && is_due(observer, sim)) observer(sim);
    if constexpr (requires { observer.before_saving(sim); })
      if (now.saving) observer.before_saving(sim);
  } catch (...) {
    throw_of_observer(name_of_observer<Type>(number, of), sim.time(), sim.step());
  }
}
template <class Sim, class... Observers>
void observe_all([[maybe_unused]] Sim& sim, [[maybe_unused]] bool again, Observers&... observers) {
  [[maybe_unused]] const bool saving = (is_saving(observers, sim, again) || ...);
  for ([[maybe_unused]] const bool last : {false, true}) {
    [[maybe_unused]] std::size_t number = 0;
    (observe(observers, sim, Instant{again, saving, last}, ++number, sizeof...(Observers)), ...);
  }
}
/// A path from the root, without `.`, `..` and doubled slashes; links are not followed.
[[gnu::cold]] inline std::string plain_path(const std::string& path) {
  std::string all = path, out;
  if (path.empty() || path.front() != '/') {
    char folder[4096];
    if (::getcwd(folder, sizeof folder) != nullptr) all = folder + ('/' + path);
  }
  for (std::size_t from = 0; from < all.size();) {
    const std::size_t to = std::min(all.find('/', from), all.size());
    const std::string part = all.substr(from, to - from);
    if (part == "..")
      out.erase(std::min(out.rfind('/'), out.size()));
    else if (!part.empty() && part != ".")
      out += '/' + part;
    from = to + 1;
  }
  return out;
}
/// What the runs of a simulation leave to later ones: the files that observers have begun to write,
/// with the run in which, the step in which a run failed, and the gravity.
class PastRuns {
 public:
  std::int64_t failed_at = -1;  // [-] step; -1: none has failed
  Vec3d gravity{0, 0, 0};       // [m/s2] of the last one
  // The state is that of a checkpoint. It stays so in all later runs: the files that they write
  // first may be those of the runs before the checkpoint.
  bool restarted = false;

  void begin_run() { ++run_; }
  /// Whether a run of this simulation has begun to write the file, however its path is spelt.
  bool has_begun(const std::string& file) const { return written_.count(plain_path(file)) > 0; }
  /// Whether an observer adds to the file: one of an earlier run, or one of before a restart.
  /// InputError if this run writes it already.
  bool goes_on(const std::string& file) {
    const auto [at, is_new] = written_.try_emplace(plain_path(file), run_);
    require(is_new || at->second != run_, "two observers of this run write '", file,
            "'; give each a file of its own");
    at->second = run_;
    return !is_new || restarted;
  }

 private:
  std::map<std::string, std::uint64_t> written_;
  std::uint64_t run_ = 0;
};
template <class O>
bool wants_events([[maybe_unused]] const O& observer) {
  return requires(const ContactLog& log) { observer.tell(log); };
}
/// `log`: of contacts that began or ended, or of bonds that broke.
template <class Sim, class Log, class... Observers>
void tell_all([[maybe_unused]] const Sim& sim, const Log& log, const Observers&... observers) {
  [[maybe_unused]] std::size_t number = 0;
  [[maybe_unused]] const auto tell = [&](const auto& observer) {
    ++number;
    if constexpr (requires { observer.tell(log); }) try {
        observer.tell(log);
      } catch (...) {
        using Type = std::remove_cvref_t<decltype(observer)>;
        throw_of_observer(name_of_observer<Type>(number, sizeof...(Observers)), sim.time(),
                          sim.step());
      }
  };
  (tell(observers), ...);
}
/// The same for what each rank reports by itself: if an observer throws on one rank, all ranks
/// throw soon after.
template <class Sim, class Log, class... Observers>
void tell_of_rank(const Sim& sim, const Log& log, const Observers&... observers) {
  if constexpr (Sim::has_ranks)
    sim.engine().ranks.until_later([&] { tell_all(sim, log, observers...); });
  else
    tell_all(sim, log, observers...);
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
/// Rethrows the error of a failed run with what observers answer to it, and whether an earlier run
/// had failed. since_forces() [s]: how far positions have advanced since the forces acted.
template <class Sim, class Since, class... Observers>
[[noreturn, gnu::cold]] void throw_failure([[maybe_unused]] const Sim& sim, PastRuns& runs,
                                           const SimulationError& error,
                                           [[maybe_unused]] const Since& since_forces,
                                           [[maybe_unused]] Observers&... observers) {
  std::string words = error.what();
  if (runs.failed_at >= 0)
    words += text("; an earlier run of this simulation failed in step ", runs.failed_at,
                  " already, and what it left may be the cause: build the simulation anew, or "
                  "continue from a checkpoint");
  else
    runs.failed_at = sim.step();
  ((words += failed(observers, sim, error, since_forces())), ...);
  if (last_agreed() == error.what()) last_agreed() = words;  // the message common to all ranks
  throw SimulationError(words, error.step, error.particles, error.position);
}
/// Calls `steps`; the rest as throw_failure().
template <class Sim, class Steps, class Since, class... Observers>
void run_observed(const Sim& sim, PastRuns& runs, const Steps& steps, const Since& since_forces,
                  Observers&... observers) {
  try {
    steps();
  } catch (const SimulationError& error) {
    throw_failure(sim, runs, error, since_forces, observers...);
  }
}

}  // namespace silt::detail
