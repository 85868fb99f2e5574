// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

#include <unistd.h>

#include <silt/core/dyn_array.hpp>
#include <silt/io/break_warnings.hpp>
#include <silt/io/progress_line.hpp>
#include <silt/io/run_warnings.hpp>
#include <silt/io/scene_warnings.hpp>
#include <silt/io/servo_warnings.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Warnings of a fluid that has some at the start: after its first step.
template <class Sim>
DynArray<std::string> fluid_start_warnings(const Sim& sim) {
  if constexpr (requires { requires Sim::Fluid::warns_at_start; })
    return fluid_warnings(sim);
  else
    return {};
}

/// Passes on each warning of a simulation once, also if an observer is used in several runs.
class ToldWarnings {
 public:
  template <class Tell>
  void tell(const DynArray<std::string>& warnings, Tell&& tell) {
    for (const auto& sentence : warnings) {
      if (std::find(told_.begin(), told_.end(), sentence) != told_.end()) continue;
      told_.push_back(sentence);
      tell(sentence);
    }
  }

 private:
  DynArray<std::string> told_;
};

}  // namespace detail

/// Options of progress().
struct ProgressOptions {
  std::FILE* out = stderr;
  bool warnings = true;  // of the scene at the start; of fluids there and at the end; at the end
                         // of inlets and servos
};

/// Prints the progress of the run on stderr: on a terminal one line that is updated once a second;
/// otherwise (a log file) a line every ten seconds. With a fluid, prints at the end how well the
/// balances between fluid and particles close. At the start and the end it prints the warnings of
/// io/scene_warnings.hpp and io/run_warnings.hpp, one line each that begins with "warning: ". On
/// many ranks rank 0 prints for all.
class Progress {
 public:
  explicit Progress(const ProgressOptions& options)
      : options_(options), terminal_(isatty(fileno(options.out)) != 0) {}
  explicit Progress(std::FILE* out) : Progress(ProgressOptions{.out = out}) {}

  template <class Sim>
  void begin(const Sim& sim, double end_time) {
    start_ = shown_ = Clock::now();
    start_time_ = sim.time(), end_time_ = end_time, first_step_ = sim.step();
    steps_ = 0;
    if constexpr (of_liquid<Sim>) first_of_liquid_ = sim.fluid().steps();
    first_rank_ = sim.rank() == 0;
    if (options_.warnings) warn(scene_warnings(sim));
  }
  template <class Sim>
  void started(const Sim& sim) {
    if (options_.warnings) warn(overlap_warnings(sim)), warn(detail::fluid_start_warnings(sim));
  }
  /// On many ranks no observer may depend on a clock: rank 0 prints between the steps.
  template <class Sim>
  void watch(const Sim& sim) {
    if (first_rank_ && is_time(sim)) show(sim, false);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return !Sim::has_ranks && is_time(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    show(sim, false);
  }
  template <class Sim>
  void end(const Sim& sim) {
    if (first_rank_) show(sim, true);
    if (!options_.warnings) return;
    warn(inlet_warnings(sim)), warn(servo_warnings(sim)), warn(break_warnings(sim, broken_));
    warn(fluid_warnings(sim));
  }
  void tell(const DynArray<BreakEvent>& broken) const { broken_.add(broken); }

 private:
  using Clock = std::chrono::steady_clock;
  /// The clock is read at intervals of at most 16 steps.
  template <class Sim>
  bool is_time(const Sim& sim) const {
    return sim.step() % 16 == 0 && seconds_since(shown_) >= (terminal_ ? 1 : 10);
  }
  static double seconds_since(Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  }
  void warn(const DynArray<std::string>& warnings) {
    if (!first_rank_) return;
    told_.tell(warnings, [this](const std::string& sentence) {
      std::fprintf(options_.out, "warning: %s\n", sentence.c_str());
    });
    std::fflush(options_.out);
  }
  template <class Sim>
  void show(const Sim& sim, bool last) {
    steps_ += static_cast<std::uint64_t>(sim.step() - first_step_) * sim.size();
    first_step_ = sim.step();
    std::size_t liquid = 0;
    if constexpr (of_liquid<Sim>) {
      liquid = sim.fluid().size();
      steps_ += static_cast<std::uint64_t>(sim.fluid().steps() - first_of_liquid_) * liquid;
      first_of_liquid_ = sim.fluid().steps();
    }
    const auto line = progress_line(sim.time(), end_time_, steps_, seconds_since(start_),
                                    sim.size(), sim.peak_overlap(), start_time_, liquid);
    if (terminal_)
      std::fprintf(options_.out, "\r%-120s%s", line.c_str(), last ? "\n" : "");
    else
      std::fprintf(options_.out, "%s\n", line.c_str());
    if constexpr (requires { sim.fluid().closure(); })
      if (last)
        std::fprintf(options_.out, "%s\n",
                     closure_line(sim.fluid().closure(), !of_liquid<Sim>).c_str());
    std::fflush(options_.out);
    shown_ = Clock::now();
  }

  /// The fluid consists of particles (Sph).
  template <class Sim>
  static constexpr bool of_liquid = requires(const Sim& sim) {
    sim.fluid().wall_particles();
    sim.fluid().steps();
  };

  ProgressOptions options_;
  bool terminal_;
  Clock::time_point start_, shown_;
  double start_time_ = 0, end_time_ = 0;
  std::int64_t first_step_ = 0, first_of_liquid_ = 0;
  std::uint64_t steps_ = 0;
  bool first_rank_ = true;
  detail::ToldWarnings told_;
  mutable BrokenLoads broken_;  // simulations pass events to const observers
};

/// progress(stdout), or progress({.warnings = false}).
inline Progress progress(const ProgressOptions& options) { return Progress(options); }
inline Progress progress(std::FILE* out = stderr) { return Progress(out); }

/// Passes the same warnings to `callback(sentence)` and prints nothing; on many ranks on rank 0.
/// The callback may throw: the run then ends before its first step.
///   sim.run(1.0, silt::on_warnings([&](const std::string& w) { log << w << '\n'; }),
///           silt::progress({.warnings = false}));
template <class Callback>
class WarningsObserver {
 public:
  explicit WarningsObserver(Callback callback) : callback_(std::move(callback)) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    tell(sim, scene_warnings(sim));
  }
  template <class Sim>
  void started(const Sim& sim) {
    tell(sim, overlap_warnings(sim)), tell(sim, detail::fluid_start_warnings(sim));
  }
  template <class Sim>
  bool is_due(const Sim&) const {
    return false;
  }
  template <class Sim>
  void operator()(const Sim&) {}
  template <class Sim>
  void end(const Sim& sim) {
    tell(sim, inlet_warnings(sim)), tell(sim, servo_warnings(sim));
    tell(sim, break_warnings(sim, broken_)), tell(sim, fluid_warnings(sim));
  }
  void tell(const DynArray<BreakEvent>& broken) const { broken_.add(broken); }

 private:
  template <class Sim>
  void tell(const Sim& sim, const DynArray<std::string>& warnings) {
    if (sim.rank() == 0) told_.tell(warnings, callback_);
  }

  Callback callback_;
  detail::ToldWarnings told_;
  mutable BrokenLoads broken_;
};

template <class Callback>
WarningsObserver<Callback> on_warnings(Callback callback) {
  return WarningsObserver<Callback>(std::move(callback));
}

}  // namespace silt
