// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <silt/breakage/concept.hpp>
#include <silt/breakage/fatigue.hpp>
#include <silt/breakage/impact.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fill/size_distribution.hpp>

namespace silt::inline SILT_TARGET {

/// Particle size for which the automatic time step is chosen. A given step (Simulation::time_step)
/// does not change.
enum class BreakStep {
  SmallestPossible,  // a fragment of the diameter `dust_below`, from the start
  SmallestLiving     // the smallest present particles: changes during the run
};

/// Rules of breakage besides the comminution functions.
struct BreakageRules {
  double dust_below;                     // [m] diameter, > 0: smaller fragments become dust
  std::size_t most_fragments = 100;      // [-] per particle; the rest of its mass becomes dust
  double separation_speed = 0.1;         // [m/s] >= 0
  DynArray<std::size_t> materials = {};  // materials that break; empty: all
  std::uint64_t seed = 1;
  BreakStep step = BreakStep::SmallestPossible;

  bool breaks(std::size_t material) const {
    for (const std::size_t m : materials)
      if (m == material) return true;
    return materials.empty();
  }
};

/// Policy of a Simulation with breakage. Each particle has a strength. When the load of an impact
/// exceeds it, the particle is replaced by fragments; fragments smaller than `dust_below` become
/// mass in a table (dust).
///
///   silt::Simulation sim{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt},
///                        silt::Breakage{silt::LogLogisticStrength{...}, silt::HertzEquivalence{},
///                                       silt::GaudinSchuhmann{...}, {.dust_below = 20e-6}}};
///
/// The load of an impact is evaluated at its start, from the speed at first touch. With
/// ForceEquivalence it is evaluated in each step, from the normal force of the contact including
/// damping. A load below the strength weakens the particle by `fatigue`, once per contact.
///
/// Fragments are placed inside the parent and have its velocity and rotation; momentum and angular
/// momentum are conserved. Initial overlaps with each other, neighbours and walls are excluded from
/// the contact forces and shrink at `separation_speed`. Fragments cannot break until the parent
/// would have travelled its own diameter at the impact speed, because the breakage function
/// describes the result of the whole impact.
///
/// Strengths and fragments are drawn from the seed and the particle's id, and depend on nothing
/// else.
/// Source:  T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113: the system of functions and
///          the table of dust. The placement of fragments is silt's.
/// Errors:  InputError naming field, value, unit and allowed range.
/// Tests:   tests/breakage/.
/// Valid:   spheres and polyhedra, not in a DeformingBox.
/// Units:   SI; strengths and loads [N] or [J], as the equivalence gives.
template <Strength S, Equivalence E, BreakageFunction B, Fatigue F = NoFatigue>
struct Breakage {
  static constexpr bool is_breakage = true;
  static constexpr LoadUnit unit = E::unit;
  static constexpr bool by_force = requires { requires E::by_force; };
  static_assert(same_load_unit<S, E>(),
                "Breakage compares a strength in N with a load in J, or vice versa: use "
                "EnergyEquivalence with strengths in J, another one with those in N");

  S strength;
  E equivalence;
  B sizes;
  F fatigue;
  BreakageRules rules;

  Breakage(S s, E e, B b, F f, BreakageRules r)
      : strength(s), equivalence(e), sizes(b), fatigue(f), rules(std::move(r)) {}
  Breakage(S s, E e, B b, BreakageRules r) : Breakage(s, e, b, F{}, std::move(r)) {}

  /// Fields of each particle, as of a module.
  struct Fields {
    double strength = 0;     // [N] or [J]; 0: unbreakable
    double rests_until = 0;  // [s] cannot break before
    double generation = 0;   // [-] 0: not a fragment; fragments: that of the parent + 1
  };
  static constexpr std::array names{"strength", "rests_until", "generation"};

  /// A function with a unit of its own, such as T10Sizes, must have that of the loads.
  template <class Function>
  static void check_unit(const char* what, const Function& function) {
    if constexpr (requires { function.unit; })
      require(function.unit == unit, "Breakage: the ", what,
              " has .unit = LoadUnit::", name_of(function.unit),
              ", which is Force if left out, but loads are of LoadUnit::", name_of(unit),
              " by the equivalence: set .unit = silt::LoadUnit::", name_of(unit));
  }
  static const char* name_of(LoadUnit one) { return one == LoadUnit::Force ? "Force" : "Energy"; }

  /// Checks before a run.
  template <class Sim>
  void check(const Sim& sim) const {
    strength.check(), equivalence.check(), sizes.check(), fatigue.check();
    check_unit("breakage function", sizes), check_unit("fatigue", fatigue);
    require_positive("BreakageRules.dust_below", rules.dust_below, "m");
    require_not_negative("BreakageRules.separation_speed", rules.separation_speed, "m/s");
    require(rules.most_fragments > 0,
            "BreakageRules.most_fragments = 0 [-] must be at least 1; to turn all that breaks into "
            "dust, raise dust_below");
    for (const std::size_t m : rules.materials)
      require(m < sim.contacts().materials(), "BreakageRules.materials names material ", m,
              ", but the contacts have ", sim.contacts().materials());
    double largest = 0;  // [m] diameter
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) largest = std::max(largest, 2 * sim.radius(k));
    for (std::size_t k = 0; k < sim.inlets(); ++k)
      largest = std::max(largest, 2 * sim.inlet(k).flow.largest_radius());
    require(largest == 0 || rules.dust_below < largest,
            "BreakageRules.dust_below = ", rules.dust_below,
            " [m] is not below the diameter of the largest particle, ", largest,
            " m: whatever broke would be dust; lower it");
    if (largest > 0) {
      const double mass = 2500 * sphere_volume(largest / 2),
                   middle = strength.strength(largest, mass, 0.5);
      check_sizes(sizes, {largest, mass, middle, 1.5 * middle, 10});
    }
  }
};
template <class S, class E, class B>
Breakage(S, E, B, BreakageRules) -> Breakage<S, E, B>;

/// Cause of a breakage.
enum class BreakCause {
  Pair,  // impact on another particle
  Wall,  // impact on a wall
  Asked  // break_particle()
};
/// Numbers of breakages, by BreakCause.
using BreakCounts = std::array<std::uint64_t, 3>;

/// A breakage, for on_break().
struct BreakEvent {
  ParticleId id = no_particle;    // that it had
  std::size_t material = 0;       // its name: Simulation::material_name()
  double time = 0;                // [s]
  Vec3d position{0, 0, 0};        // [m]
  Vec3d velocity{0, 0, 0};        // [m/s]
  double diameter = 0, mass = 0;  // [m], [kg]
  double strength = 0, load = 0;  // [N] or [J]
  double speed = 0;               // [m/s] of the impact; 0 for loads by force and requests
  BreakCause cause = BreakCause::Pair;
  ParticleId first = no_particle;  // id of the first fragment; the others follow
  std::size_t fragments = 0;
  std::size_t generation = 0;  // [-] of the particle: 0 is not a fragment
  double dust = 0;             // [kg]
};

/// The load closest to a strength, or farthest above it.
struct LargestLoad {
  std::uint64_t weighed = 0;       // [-] number of loads so far, each on one particle
  double share = 0;                // [-] over the strength
  double load = 0, strength = 0;   // [N] or [J]
  double diameter = 0, speed = 0;  // [m], [m/s]; speed 0 for loads by force
};

/// Mass balance of a simulation [kg]. `fed`: all that was added or came through inlets; `present`:
/// now in the simulation; `left`: through outlets, or removed.
struct MassBalance {
  double fed = 0, present = 0, left = 0, dust = 0;
  /// Closure error: rounding.
  double residual() const { return fed - present - left - dust; }
};

}  // namespace silt
