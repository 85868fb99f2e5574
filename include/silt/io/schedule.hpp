// silt - BSD-3-Clause, see LICENSE
#pragma once

// When observers act: at multiples of an interval of simulated time, or of a number of steps.

#include <cmath>
#include <cstdint>
#include <utility>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Due at every multiple of `interval` [s] of simulated time, at the nearest step; or at every
/// multiple of a number of steps.
class Schedule {
 public:
  static Schedule of_steps(std::int64_t steps) {
    require(steps > 0, "every_steps: ", steps, " steps must be at least 1");
    Schedule schedule(1);
    schedule.steps_ = steps;
    return schedule;
  }
  explicit Schedule(double interval) : interval_(interval) {
    require_positive("every: interval", interval, "s");
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return number(sim) > last_;
  }
  template <class Sim>
  void mark(const Sim& sim) {
    last_ = number(sim);
  }
  /// Start of a run. The observer is due at once if its time has come and observers were not called
  /// at this instant yet. An observer that only reads is due even if they were, except in a run
  /// continued from a checkpoint. In several runs in turn the schedule continues. A run ends up to
  /// one step after its duration; for observers that only read this counts as the end.
  template <class Sim>
  void begin(const Sim& sim, bool only_reads = false) {
    const bool done = only_reads ? sim.continued() : sim.observed();
    if (!begun_) last_ = number(sim) - (on_time(sim, only_reads ? 1.0 : 0.5) && !done ? 1 : 0);
    begun_ = true;
  }

 private:
  template <class Sim>
  std::int64_t number(const Sim& sim) const {
    if (steps_ > 0) return sim.step() / steps_;
    return static_cast<std::int64_t>(
        std::floor((sim.time() + 0.5 * sim.step_length()) / interval_ * (1 + 1e-12)));
  }
  /// Whether the last instant is at most `steps` steps ago, or half a step ahead.
  template <class Sim>
  bool on_time(const Sim& sim, double steps) const {
    if (steps_ > 0) return sim.step() % steps_ == 0;
    const double since = sim.time() - static_cast<double>(number(sim)) * interval_;
    return since <= steps * (1 + 1e-9) * sim.step_length();
  }

  double interval_;         // [s]
  std::int64_t steps_ = 0;  // in place of it
  std::int64_t last_ = -1;
  bool begun_ = false;
};

inline Schedule every(double interval) { return Schedule(interval); }
/// Every so many steps of the simulation, counted from its start; every_steps(1): each step. The
/// times change with the time step.
inline Schedule every_steps(std::int64_t steps) { return Schedule::of_steps(steps); }

/// Effect of an action on the simulation: any; reads it only; saves it.
enum class ActionKind { Any, Reads, Saves };

/// Calls `action(simulation)` at the times of its schedule:
///   sim.run(1.0, silt::at(every(0.1), [&](const auto& s) { ... }));
template <class Action, ActionKind Kind = ActionKind::Any>
class TimedAction {
 public:
  static constexpr bool only_reads = Kind != ActionKind::Any, saves = Kind == ActionKind::Saves;

  TimedAction(Schedule schedule, Action action) : schedule_(schedule), action_(std::move(action)) {}
  template <class Sim>
  void begin(const Sim& sim, double) {
    schedule_.begin(sim, only_reads);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim);
  }
  template <class Sim>
  void operator()(Sim& sim) {
    action_(sim);
    schedule_.mark(sim);
  }

 private:
  Schedule schedule_;
  Action action_;
};

template <ActionKind Kind = ActionKind::Any, class Action>
TimedAction<Action, Kind> at(Schedule schedule, Action action) {
  return {schedule, std::move(action)};
}

}  // namespace silt
