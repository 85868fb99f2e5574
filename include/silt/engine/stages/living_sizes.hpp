// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The particle sizes that set the time step where particles break (BreakStep::SmallestLiving): the
/// smallest present at the last look. They are looked at when a smaller particle is born, so that
/// the step becomes shorter before that particle acts, and every hundred steps, so that the step
/// can grow again.
/// Tests: tests/breakage/step.cpp, tests/parallel/break_steps.cpp.
class LivingSizes {
 public:
  static constexpr std::int64_t look_every = 100;  // [steps]
  /// The step is changed only if it is longer or shorter than the new choice by these factors.
  static constexpr double longer = 1.05, shorter = 0.8;  // [-]
  static constexpr double most_postponed = 10;           // [-]

  double coming_step = 0;        // [s] used from the next drift on; 0: no change
  double speed = 0;              // [m/s] that the step was chosen for
  double postponed = 0;          // [-] postponed changes in succession
  std::uint64_t safeguards = 0;  // [-] count before this step

  bool known() const { return !least_.empty(); }
  void forget() { least_.clear(); }

  /// Looks at all particles; their smallest radius is exact afterwards. Returns whether the
  /// smallest sizes have changed. With several ranks, of all (collective).
  template <class Engine>
  bool measure(Engine& e, std::size_t materials) {
    const auto before = std::exchange(least_, DynArray<Least>(materials));
    double smallest = std::numeric_limits<double>::infinity();  // [m]
    for (std::size_t k = 0; k < e.owners(); ++k) {
      const auto p = e.owner(k);
      if (!p.is_there()) continue;
      smallest = std::min(smallest, p.radius());
      if (p.inverse_mass() > 0) least_[p.material()].include(Least::of(p.mass(), p.radius()));
    }
    if constexpr (Engine::of_ranks) smallest = share(e, smallest);
    if constexpr (!Engine::of_bodies)
      if (std::isfinite(smallest)) e.particles.smallest_radius = smallest;
    return least_ != before;
  }
  /// Whether the particle at place k is smaller than all of its material at the last look.
  template <class Engine>
  bool is_less(const Engine& e, std::size_t k) const {
    const auto p = e.owner(k);
    return is_less(p.material(), p.mass(), p.radius());
  }
  bool is_less(std::size_t material, double mass, double radius) const {
    if (material >= least_.size()) return true;
    const Least &all = least_[material], one = Least::of(mass, radius);
    return one.mass < all.mass || one.hertz < all.hertz || one.radius < all.radius;
  }

  // As numbers, for a checkpoint; empty if nothing is known.
  DynArray<double> state() const {
    DynArray<double> all;
    if (known() || postponed > 0) all.insert(all.end(), {coming_step, speed, postponed});
    for (const Least& l : least_) all.insert(all.end(), {l.mass, l.hertz, l.radius});
    return all;
  }
  static bool can_be(const DynArray<double>& all) {
    return all.empty() || (all.size() % 3 == 0 && std::isfinite(all[0] + all[1] + all[2]) &&
                           std::all_of(all.begin(), all.end(), [](double x) { return x >= 0; }));
  }
  void restore(const DynArray<double>& all) {
    coming_step = speed = postponed = 0, least_.clear();
    if (!all.empty()) coming_step = all[0], speed = all[1], postponed = all[2];
    for (std::size_t at = 3; at + 3 <= all.size(); at += 3)
      least_.push_back({all[at], all[at + 1], all[at + 2]});
  }

 private:
  /// The smallest values of one material, which contact times and displacements per step depend on.
  struct Least {
    double mass = std::numeric_limits<double>::infinity();  // [kg]
    double hertz = mass, radius = mass;                     // m^2/R [kg2/m], [m]
    static Least of(double mass, double radius) { return {mass, mass * mass / radius, radius}; }
    bool operator==(const Least&) const = default;
    void include(const Least& one) {
      mass = std::min(mass, one.mass), hertz = std::min(hertz, one.hertz);
      radius = std::min(radius, one.radius);
    }
  };
  /// Makes the smallest sizes those of all ranks; returns the smallest `radius` [m] of any.
  template <class Engine>
  double share(const Engine& e, double radius) {
    DynArray<double> most{-radius};
    for (const Least& l : least_) most.insert(most.end(), {-l.mass, -l.hertz, -l.radius});
    e.ranks.max_of(most);
    for (std::size_t k = 0; k < least_.size(); ++k)
      least_[k] = {-most[3 * k + 1], -most[3 * k + 2], -most[3 * k + 3]};
    return -most[0];
  }

  DynArray<Least> least_;  // one per material
};

}  // namespace silt::detail
