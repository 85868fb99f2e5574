// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>
#include <vector>

#include <silt/breakage/breakage.hpp>
#include <silt/io/observers.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

template <class Action>
class BreakObserver {
 public:
  explicit BreakObserver(Action action) : action_(std::move(action)) {}

  template <class Sim>
  void begin(const Sim&, double) const {
    static_assert(Sim::has_breakage,
                  "on_break needs a simulation whose particles break: give it the policy "
                  "silt::Breakage{...} beside particles and contacts");
  }
  template <class Sim>
  bool is_due(const Sim&) const {
    return false;
  }
  template <class Sim>
  void operator()(const Sim&) const {}
  void tell(const std::vector<BreakEvent>& broken) const {
    for (const BreakEvent& one : broken) action_(one);
  }

 private:
  mutable Action action_;
};

}  // namespace detail

/// Calls `action(const BreakEvent&)` for each particle that breaks, in the step in which its
/// fragments take its place; within a step in the order of ids.
///
///   sim.run(1.0, silt::on_break([&](const silt::BreakEvent& b) { dust += b.dust; }));
template <class Action>
detail::BreakObserver<Action> on_break(Action action) {
  return detail::BreakObserver<Action>(std::move(action));
}

}  // namespace silt
